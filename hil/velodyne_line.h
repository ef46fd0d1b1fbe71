// A Velodyne lidar of the rig: its two UDP ports and its web interface.
#pragma once

#include <memory>

#include "hil/configuration/velodyne.h"
#include "hil/device_line.h"

namespace rigwire::hil {

/// Opens the ports. Throws drivers::EndpointError when that fails, std::runtime_error for a
/// calibration file that cannot be used.
[[nodiscard]] std::unique_ptr<LidarLine> make_line(const VelodyneConfiguration& configuration,
                                                   const LineContext& context);

}  // namespace rigwire::hil
