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

#include "hil/configuration/fields.h"
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

/// The names of the `type` key, in the order of DeviceSettings.
inline constexpr std::array<Alternative, 20> kDeviceTypes{
    {{"ublox-neo-7p", "u-blox NEO-7P satellite receiver on a serial line (NMEA, UBX)."},
     {"ublox-neo-m8", "u-blox NEO-M8 satellite receiver of several systems (NMEA, UBX)."},
     {"ublox-neo-m8t", "u-blox NEO-M8T, the same with raw measurements (NMEA, UBX)."},
     {"ublox-zed-f9p", "u-blox ZED-F9P satellite receiver with carrier solution (NMEA, UBX)."},
     {"starfire-3000", "John Deere StarFire 3000 satellite receiver (NMEA, J1939)."},
     {"velodyne-hdl-32e", "Velodyne HDL-32E spinning lidar on UDP."},
     {"velodyne-vlp-16", "Velodyne VLP-16 (Puck) spinning lidar on UDP, web interface."},
     {"velodyne-puck-hi-res", "Velodyne Puck Hi-Res spinning lidar on UDP, web interface."},
     {"velodyne-vlp-32c", "Velodyne VLP-32C (Ultra Puck) spinning lidar on UDP, web interface."},
     {"velodyne-hdl-64e", "Velodyne HDL-64E S2 spinning lidar on UDP."},
     {"velodyne-vls-128", "Velodyne VLS-128 (Alpha Prime) spinning lidar on UDP, web interface."},
     {"openimu335ri", "ACEINNA OpenIMU335RI inertial unit on CAN (J1939)."},
     {"valve-driver", "Eight-section hydraulic valve driver, Modbus TCP server."},
     {"vehicle-gateway",
      "Drive train, steering and brakes of a machine that drives, on CAN (J1939)."},
     {"openimu300ri", "ACEINNA OpenIMU300RI inertial unit on CAN (J1939), with magnetometer."},
     {"xsens-mti-600", "Xsens MTi-600 inertial unit on CAN."},
     {"cia406-encoder", "Absolute rotary encoder on CANopen (CiA 406), at a joint."},
     {"iso-valves", "Block of auxiliary valves with joysticks, on CAN (ISO 11783)."},
     {"usb-joystick", "Levers, pedals and buttons of an excavator's operator, a USB joystick."},
     {"usb-passthrough", "A real USB device of this machine, passed on by the rig's USB bus."}}};

struct DeviceConfiguration {
  DeviceSettings settings;

  [[nodiscard]] std::string_view type() const { return kDeviceTypes[settings.index()].name; }
};

template <class Visitor>
void visit(Visitor& v, VehicleGatewayDeviceConfiguration& p) {
  visit(v, static_cast<VehicleGatewayConfiguration&>(p));
  v.section("sensor", p.sensor, "How well the machine's own sensors measure.");
  v.section("odometry", p.odometry, "Speed and curvature from wheels and steering.");
}

template <class Visitor>
void visit(Visitor& v, DeviceConfiguration& p) {
  v.required("type");
  v.variant("type", p.settings, kDeviceTypes, "Which device it is.");
}

}  // namespace rigwire::hil
