// The types of devices that there are. A new one is a class in this folder and a row of the list in
// device_types.cpp.
#pragma once

#include <span>

#include "fields/chosen.h"
#include "hil/devices/device_configuration.h"

namespace rigwire::hil {

using DeviceType = fields::TypeRow<DeviceConfiguration>;

/// In the order in which `rigwire list devices` shows them.
[[nodiscard]] std::span<const DeviceType> device_types();

/// A device of the rig: its type and the settings of that type.
struct ConfiguredDevice : fields::Chosen<DeviceConfiguration> {
  explicit ConfiguredDevice(std::size_t type = 0) : Chosen(device_types(), type) {}
};
void visit(fields::Visitor& v, ConfiguredDevice& p);

}  // namespace rigwire::hil
