// The devices of a rig: wire, mount, what the device does (its emulator's settings) and how well it
// measures (its sensor's parameters). The `type` key chooses which.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>

#include "fields/visitor.h"
#include "hil/configuration/vehicle_sensors.h"
#include "hil/devices/iso_valves.h"
#include "hil/devices/openimu.h"
#include "hil/devices/rotary_encoder.h"
#include "hil/devices/starfire.h"
#include "hil/devices/ublox.h"
#include "hil/devices/usb_joystick.h"
#include "hil/devices/usb_passthrough_configuration.h"
#include "hil/devices/valve_driver.h"
#include "hil/devices/vehicle_gateway.h"
#include "hil/devices/velodyne.h"
#include "hil/devices/xsens.h"
#include "hil/wires/can_bus_configuration.h"
#include "hil/world/mount.h"
#include "hil/world/shapes.h"

namespace rigwire::hil {

/// Vehicle gateway on a J1939 bus, with the sensors and the odometry that it reports.
struct VehicleGatewayDeviceConfiguration : VehicleGatewayConfiguration {
  static constexpr fields::Named kNamed{
      "vehicle-gateway",
      "Drive train, steering and brakes of a machine that drives, on CAN (J1939)."};

  sim::VehicleSensorParameters sensor;
  sim::OdometryParameters odometry;
};

using DeviceSettings =
    std::variant<UbloxConfiguration, UbloxM8Configuration, UbloxM8tConfiguration,
                 UbloxF9pConfiguration, StarFireConfiguration, VelodyneConfiguration,
                 VelodyneVlp16Configuration, VelodynePuckHiResConfiguration,
                 VelodyneVlp32cConfiguration, VelodyneHdl64eConfiguration,
                 VelodyneVls128Configuration, OpenImuDeviceConfiguration, ValveDriverConfiguration,
                 VehicleGatewayDeviceConfiguration, OpenImu300riDeviceConfiguration,
                 XsensMtiConfiguration, EncoderDeviceConfiguration, IsoValvesConfiguration,
                 UsbJoystickConfiguration, UsbPassThroughConfiguration>;

/// The device, if its type is `Base` or derived from it; else null.
template <class Base>
[[nodiscard]] const Base* as_kind(const DeviceSettings& settings) {
  return std::visit(
      [](const auto& device) -> const Base* {
        if constexpr (std::derived_from<std::decay_t<decltype(device)>, Base>) {
          return &device;
        } else {
          return nullptr;
        }
      },
      settings);
}
/// The u-blox receiver that the device is, whatever its type; else null.
[[nodiscard]] inline const UbloxConfiguration* as_ublox(const DeviceSettings& settings) {
  return as_kind<UbloxConfiguration>(settings);
}
/// The Velodyne lidar that the device is, whatever its model; else null.
[[nodiscard]] inline const VelodyneConfiguration* as_velodyne(const DeviceSettings& settings) {
  return as_kind<VelodyneConfiguration>(settings);
}
/// Whether it receives satellites and can tell a lidar the time.
[[nodiscard]] inline bool is_receiver(const DeviceSettings& settings) {
  return as_ublox(settings) != nullptr || std::holds_alternative<StarFireConfiguration>(settings);
}

struct DeviceConfiguration {
  DeviceSettings settings;

  [[nodiscard]] std::string_view type() const { return fields::chosen_name(settings); }
};

inline void visit(fields::Visitor& v, VehicleGatewayDeviceConfiguration& p) {
  visit(v, static_cast<VehicleGatewayConfiguration&>(p));
  v.section("sensor", p.sensor, "How well the machine's own sensors measure.");
  v.section("odometry", p.odometry, "Speed and curvature from wheels and steering.");
}

inline void visit(fields::Visitor& v, DeviceConfiguration& p) {
  v.required("type");
  v.variant("type", p.settings, "Which device it is.");
}

}  // namespace rigwire::hil
