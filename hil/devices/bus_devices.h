// Who is on a CAN bus of a rig.
#pragma once

#include <string>
#include <vector>

#include "hil/rig/rig_configuration.h"

namespace rigwire::hil {

/// Empty for devices without one.
[[nodiscard]] std::string bus_of(const DeviceConfiguration& device);

/// Names of the devices on the bus.
[[nodiscard]] std::vector<std::string> devices_on(const RigConfiguration& rig,
                                                  const std::string& bus);

/// Frames per second that the device sends on the bus by itself; 0 when it is not there. Throws
/// std::invalid_argument for settings that make no device.
[[nodiscard]] double frame_rate_on(const std::string& bus, const DeviceConfiguration& device);

}  // namespace rigwire::hil
