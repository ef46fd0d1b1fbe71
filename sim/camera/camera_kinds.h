// All kinds of camera, for code that selects one from a file: parameters, what a device must know
// of the kind before it creates a sensor, and the sensor itself.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "sim/camera/all_round_camera.h"
#include "sim/camera/depth_camera.h"
#include "sim/camera/plain_camera.h"
#include "sim/camera/shot_parts.h"
#include "sim/camera/stereo_camera.h"

namespace rigwire::sim {

/// For fields::Visitor::variant(): "camera", "stereo", "depth", "all_round".
using CameraKind = std::variant<CameraParameters, StereoCameraParameters, DepthCameraParameters,
                                AllRoundCameraParameters>;

/// Optics, sensor and automatic exposure; of a kind of several heads each of them.
[[nodiscard]] const CameraParameters& optics_of(const CameraKind& kind);

/// What pictures of a kind can be.
struct CameraAbilities {
  int width_px = 0;
  int height_px = 0;
  std::vector<PixelFormat> formats;  ///< Pixel formats of the image, the usual one first.
  bool binning = false;              ///< By 2 x 2; without it only 1 x 1 is taken.
  Duration row_time{0};              ///< 0: global shutter.
  PictureParts parts;
  std::optional<ReportedGeometry> geometry;  ///< Empty for kinds without a third coordinate.
};
/// Throws std::invalid_argument as the kind's validate() does.
[[nodiscard]] CameraAbilities abilities_of(const CameraKind& kind);

/// Throws std::invalid_argument as the kind's own function does.
[[nodiscard]] std::unique_ptr<CameraSensor> make_camera(const CameraKind& kind, std::uint64_t seed,
                                                        std::string_view name);

}  // namespace rigwire::sim
