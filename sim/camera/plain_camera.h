// A camera of one image.
//
// A grey sensor gives Mono8, 10 and 12, one behind a Bayer mosaic BayerRG8, 10 and 12, as its
// numbers are: no white balance, no colour matrix, no gamma. Region and binning are the sensor's
// own (a colour sensor does not bin); a smaller region costs less.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "sim/camera/camera_sensor.h"

namespace rigwire::sim {

/// Throws std::invalid_argument as CameraRenderer does.
[[nodiscard]] std::unique_ptr<CameraSensor> make_plain_camera(const CameraParameters& parameters,
                                                              std::uint64_t seed,
                                                              std::string_view name);

}  // namespace rigwire::sim
