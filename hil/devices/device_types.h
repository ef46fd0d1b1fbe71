// The types of devices that there are. A new one is a class in this folder, a function here or a
// header of its own, and a row of the list in device_types.cpp.
#pragma once

#include <memory>
#include <span>

#include "emulators/openimu/settings.h"
#include "fields/chosen.h"
#include "hil/devices/device_configuration.h"

namespace rigwire::hil {

// The types that nothing but a rig's file sets up, each with its defaults; of the others the class
// is in their header.
[[nodiscard]] std::unique_ptr<DeviceConfiguration> fresh_engine_controller();
[[nodiscard]] std::unique_ptr<DeviceConfiguration> fresh_gnss_base();
[[nodiscard]] std::unique_ptr<DeviceConfiguration> fresh_inclinometer();
[[nodiscard]] std::unique_ptr<DeviceConfiguration> fresh_iso_valves();
[[nodiscard]] std::unique_ptr<DeviceConfiguration> fresh_ntrip_caster();
[[nodiscard]] std::unique_ptr<DeviceConfiguration> fresh_openimu(emulators::OpenImuVariant variant);
[[nodiscard]] std::unique_ptr<DeviceConfiguration> fresh_usb_passthrough();
[[nodiscard]] std::unique_ptr<DeviceConfiguration> fresh_vehicle_gateway();
[[nodiscard]] std::unique_ptr<DeviceConfiguration> fresh_xsens();

using DeviceType = fields::TypeRow<DeviceConfiguration>;

/// In the order in which `rigwire list devices` shows them.
[[nodiscard]] std::span<const DeviceType> device_types();

/// A device of the rig: its type and the settings of that type.
struct ConfiguredDevice : fields::Chosen<DeviceConfiguration> {
  explicit ConfiguredDevice(std::size_t type = 0) : Chosen(device_types(), type) {}
};
void visit(fields::Visitor& v, ConfiguredDevice& p);

}  // namespace rigwire::hil
