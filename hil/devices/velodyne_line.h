// A Velodyne lidar of the rig: its two UDP ports and its web interface.
#pragma once

#include <memory>

#include "hil/devices/device_line.h"
#include "hil/devices/velodyne.h"

namespace rigwire::hil {

/// Opens the ports. Throws drivers::EndpointError when that fails, std::runtime_error for a
/// calibration file that cannot be used.
[[nodiscard]] std::unique_ptr<LidarLine> make_line(const VelodyneConfiguration& configuration,
                                                   const LineContext& context);

}  // namespace rigwire::hil
