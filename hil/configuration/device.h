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

#include "emulators/can_bus.h"
#include "emulators/openimu/openimu335ri.h"
#include "emulators/valve_driver/valve_driver.h"
#include "hil/configuration/fields.h"
#include "hil/configuration/mount.h"
#include "hil/configuration/shapes.h"
#include "hil/configuration/starfire_device.h"
#include "hil/configuration/ublox.h"
#include "hil/configuration/vehicle_gateway.h"
#include "hil/configuration/vehicle_sensors.h"
#include "hil/configuration/velodyne.h"
#include "sim/imu/imu_sensor.h"
#include "sim/samples/vector3.h"

namespace rigwire::hil {

/// ACEINNA OpenIMU on a J1939 bus.
struct OpenImuDeviceConfiguration {
  std::string bus = "can";  ///< One of the rig's buses.
  MountConfiguration mount;
  emulators::OpenImuSettings imu;
  sim::ImuParameters sensor;
};

/// Hydraulic valve driver as a Modbus TCP server.
struct ValveDriverConfiguration {
  std::string address = "127.0.0.1";  ///< Where it listens.
  std::uint16_t port = 1502;
  bool allow_remote = false;  ///< Needed to listen where other machines reach it.
  emulators::ValveDriverSettings driver;
};

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
                 VehicleGatewayDeviceConfiguration>;

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
inline constexpr std::array<Alternative, 14> kDeviceTypes{
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
      "Drive train, steering and brakes of a machine that drives, on CAN (J1939)."}}};

struct DeviceConfiguration {
  DeviceSettings settings;

  [[nodiscard]] std::string_view type() const { return kDeviceTypes[settings.index()].name; }
};

enum class CanWire { automatic, socketcan, slcan };
inline constexpr std::array<Choice<CanWire>, 3> kCanWires{
    {{CanWire::automatic, "auto", "SocketCAN where the interface exists, else slcan."},
     {CanWire::socketcan, "socketcan", "The kernel's CAN interface."},
     {CanWire::slcan, "slcan", "The slcan text protocol on a pty."}}};

/// One CAN bus that devices share.
struct BusConfiguration {
  CanWire wire = CanWire::automatic;
  std::string interface = "vcan0";        ///< SocketCAN.
  std::string path = "/tmp/rigwire/can";  ///< slcan: symbolic link to the pty.
  emulators::CanBusSettings bus;
};

inline constexpr std::array<Choice<emulators::OpenImuVariant>, 2> kOpenImuVariants{
    {{emulators::OpenImuVariant::openimu335ri, "openimu335ri", "Figures of merit by state."},
     {emulators::OpenImuVariant::openimu300ri, "openimu300ri", "Figures of merit not available."}}};

/// The same parameters in the units of a gyroscope and of an accelerometer.
struct GyroscopeParameters {
  sim::InertialTriadParameters* triad;
};
struct AccelerometerParameters {
  sim::InertialTriadParameters* triad;
};

template <class Visitor>
void visit_errors(Visitor& v, sim::InertialTriadParameters& p) {
  v.number("scale_error", p.scale_error, in("%").at_least(0), "Standard deviation, per axis.");
  v.number("misalignment", p.misalignment_rad, in("deg").at_least(0), "Standard deviation.");
  v.number("scale_temperature", p.scale_temperature, plain(), "Per kelvin from 25 degC.");
}

template <class Visitor>
void visit(Visitor& v, GyroscopeParameters& gyroscope) {
  sim::InertialTriadParameters& p = *gyroscope.triad;
  v.number("range", p.range, in("deg/s").at_least(0), "Clamped beyond; 0 = unlimited.");
  v.number("resolution", p.resolution, in("deg/s").at_least(0), "One count; 0 = continuous.");
  v.number("noise_density", p.random.noise_density, in("deg/s/sqrt(Hz)").at_least(0), "White.");
  v.number("bias_instability", p.random.bias_instability, in("deg/h").at_least(0),
           "Floor of the Allan deviation.");
  v.number("random_walk", p.random.random_walk, plain().at_least(0), "Of the bias, rad/s/sqrt(s).");
  v.number("turn_on_bias", p.turn_on_bias, in("deg/s").at_least(0), "Standard deviation.");
  v.number("bias_temperature", p.bias_temperature, in("deg/s"), "Per kelvin from 25 degC.");
  visit_errors(v, p);
}

template <class Visitor>
void visit(Visitor& v, AccelerometerParameters& accelerometer) {
  sim::InertialTriadParameters& p = *accelerometer.triad;
  v.number("range", p.range, in("m/s2").at_least(0), "Clamped beyond; 0 = unlimited.");
  v.number("resolution", p.resolution, in("m/s2").at_least(0), "One count; 0 = continuous.");
  v.number("noise_density", p.random.noise_density, in("ug/sqrt(Hz)").at_least(0), "White.");
  v.number("bias_instability", p.random.bias_instability, in("ug").at_least(0),
           "Floor of the Allan deviation.");
  v.number("random_walk", p.random.random_walk, plain().at_least(0), "Of the bias, m/s2/sqrt(s).");
  v.number("turn_on_bias", p.turn_on_bias, in("mg").at_least(0), "Standard deviation.");
  v.number("bias_temperature", p.bias_temperature, in("mg"), "Per kelvin from 25 degC.");
  visit_errors(v, p);
}

inline constexpr std::array<Choice<sim::ImuPart>, 5> kImuParts{
    {{sim::ImuPart::perfect, "perfect", "No error at all."},
     {sim::ImuPart::openimu300, "openimu300", "Class of the ACEINNA OpenIMU300."},
     {sim::ImuPart::adis16470, "adis16470", "Analog Devices ADIS16470."},
     {sim::ImuPart::mti300, "mti300", "Xsens MTi-300."},
     {sim::ImuPart::mti30, "mti30", "Xsens MTi-30."}}};
inline constexpr std::array<Choice<sim::ImuAcceleration>, 2> kImuAccelerations{
    {{sim::ImuAcceleration::solver, "solver", "That of the machine's equations."},
     {sim::ImuAcceleration::velocity_difference, "velocity_difference",
      "The paper's: change of velocity between two samples."}}};

template <class Visitor>
void visit(Visitor& v, sim::ImuParameters& p) {
  // A part sets all the others; keys beside it are read after it and count more. Printing visits
  // with the part already chosen and changes nothing.
  const sim::ImuPart before = p.part;
  v.choice("part", p.part, kImuParts, "Set of parameters that the other keys change.");
  if (p.part != before) {
    p = sim::parameters_of(p.part);
  }
  v.choice("acceleration", p.acceleration, kImuAccelerations, "Where accelerations come from.");
  GyroscopeParameters gyroscope{&p.gyroscope};
  AccelerometerParameters accelerometer{&p.accelerometer};
  v.section("gyroscope", gyroscope, "Errors of the angular rates.");
  v.section("accelerometer", accelerometer, "Errors of the specific forces.");
  v.number("g_sensitivity", p.g_sensitivity_radps_per_mps2, plain(), "rad/s per m/s2, same axis.");
  v.number("ambient_temperature", p.ambient_temperature_c, in("degC").between(-60, 150),
           "Around the device.");
  v.number("self_heating", p.self_heating_k, plain().between(0, 100), "K, when warm.");
  v.number("warm_up", p.warm_up_s, in("s").above(0), "Time constant of the case.");
  v.boolean("earth_rate", p.earth_rate, "Whether it feels the Earth turn.");
}

/// Rates that the device's divider can give.
inline constexpr std::array<Choice<std::uint8_t>, 9> kOpenImuRates{{{0, "0 Hz", "Silent."},
                                                                    {50, "2 Hz", ""},
                                                                    {25, "4 Hz", ""},
                                                                    {20, "5 Hz", ""},
                                                                    {10, "10 Hz", ""},
                                                                    {5, "20 Hz", ""},
                                                                    {4, "25 Hz", ""},
                                                                    {2, "50 Hz", ""},
                                                                    {1, "100 Hz", ""}}};

/// Low-pass filters of the device.
inline constexpr std::array<Choice<std::uint8_t>, 7> kOpenImuCutOffs{{{0, "off", "No filter."},
                                                                      {2, "2 Hz", ""},
                                                                      {5, "5 Hz", ""},
                                                                      {10, "10 Hz", ""},
                                                                      {25, "25 Hz", ""},
                                                                      {40, "40 Hz", ""},
                                                                      {50, "50 Hz", ""}}};

template <class Visitor>
void visit(Visitor& v, OpenImuDeviceConfiguration& p) {
  v.text("bus", p.bus, "One of the rig's buses.");
  v.integer("source_address", p.imu.source_address, IntegerRule{128, 247},
            "Preferred J1939 address; another one is claimed when it is lost.");
  v.integer("serial", p.imu.serial, IntegerRule{0, (1 << 21) - 1}, "In the NAME; unique on a bus.");
  v.choice("rate", p.imu.configuration.rate_divider, kOpenImuRates,
           "Of the data messages at power-on.");
  v.integer("packets", p.imu.configuration.packet_mask, IntegerRule{0, 7},
            "Messages sent: 1 slope, 2 angular rate, 4 acceleration, summed.");
  v.choice("rate_filter", p.imu.configuration.rate_cut_off_hz, kOpenImuCutOffs,
           "Low pass of the angular rates.");
  v.choice("acceleration_filter", p.imu.configuration.acceleration_cut_off_hz, kOpenImuCutOffs,
           "Low pass of the accelerations.");
  v.integer("orientation", p.imu.configuration.orientation, IntegerRule{0, 65535},
            "Axes code of the device, one of 24.");
  v.choice("variant", p.imu.variant, kOpenImuVariants, "Which firmware it follows.");
  v.number("rate_range", p.imu.rate_range_radps, in("deg/s").above(0).at_most(2000),
           "Beyond it the rate is clamped and marked.");
  v.number("acceleration_range", p.imu.acceleration_range_mps2, in("m/s2").above(0).at_most(1000),
           "Beyond it the acceleration is clamped and marked.");
  v.duration("power_on", p.imu.power_on, {0, 3'600'000'000'000}, "From the start of the run.");
  v.duration("processing_delay", p.imu.processing_delay, {0, 4'000'000},
             "From a sample or request to the frame.");
  v.section("mount", p.mount, "Of the sensor's axes.");
  v.section("sensor", p.sensor, "How well it measures.");
}

inline constexpr std::array<Choice<emulators::valve_registers::Reaction>, 3> kValveReactions{
    {{emulators::valve_registers::Reaction::neutral, "neutral", "Spools to neutral."},
     {emulators::valve_registers::Reaction::hold, "hold", "Spools stay where they are."},
     {emulators::valve_registers::Reaction::floating, "floating", "Ports to tank."}}};

template <class Visitor>
void visit(Visitor& v, ValveDriverConfiguration& p) {
  v.text("address", p.address, "Where it listens.");
  v.integer("port", p.port, IntegerRule{1, 65535}, "TCP; the standard port 502 needs privileges.");
  v.boolean("allow_remote", p.allow_remote, "Permits listening where other machines reach it.");
  v.texts("sections", p.driver.sections, "Functions of the valve sections, from section 1.");
  v.integer("unit", p.driver.unit, IntegerRule{1, 247}, "Modbus unit.");
  v.duration("processing_delay", p.driver.processing_delay, {0, 1'000'000'000},
             "From a request to its answer.");
  v.duration("watchdog", p.driver.watchdog, {0, 5'000'000'000},
             "Without a request for this long the reaction follows; 0 = off.");
  v.choice("reaction", p.driver.reaction, kValveReactions, "When the watchdog runs out.");
  v.rate("rate", p.driver.sample_period, in("Hz").between(1, 1000), "Of the transducers.");
  v.duration("ramp_cycle", p.driver.ramp_cycle, {100'000, 100'000'000}, "Of the output steps.");
  v.number("coil_current_start", p.driver.coil_current_start_ma, plain().between(0, 65535),
           "mA at the least opening.");
  v.number("coil_current_full", p.driver.coil_current_full_ma, plain().above(0).at_most(65535),
           "mA at full opening.");
  v.number("supply_voltage", p.driver.supply_voltage_v, plain().between(9, 32), "V, reported.");
  v.number("driver_temperature", p.driver.driver_temperature_c, in("degC").between(-40, 150),
           "Reported.");
  v.number("spool_tolerance", p.driver.spool_tolerance, plain().between(0.01, 2),
           "Set point to measured position.");
  v.duration("spool_fault_delay", p.driver.spool_fault_delay, {0, 3'600'000'000'000},
             "Outside the tolerance for this long is a fault; 0 = never.");
  v.text("vendor", p.driver.vendor, "Identification.");
  v.text("product_code", p.driver.product_code, "Identification.");
  v.text("revision", p.driver.revision, "Identification.");
  v.text("product_name", p.driver.product_name, "Identification.");
}

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

template <class Visitor>
void visit(Visitor& v, BusConfiguration& p) {
  v.choice("wire", p.wire, kCanWires, "What carries the frames.");
  v.text("interface", p.interface, "SocketCAN interface.");
  v.text("path", p.path, "slcan: symbolic link to the pty.");
  v.integer("bitrate", p.bus.bit_rate_bps, IntegerRule{10'000, 1'000'000}, "bit/s.");
  v.integer("queue", p.bus.queue_frames, IntegerRule{1, 65536}, "Frames that a node may hold.");
}

// Settings of the emulators and sensors validate themselves; these pass the wish on.
inline void validate(const OpenImuDeviceConfiguration& p) {
  validate(p.imu);
}
inline void validate(const ValveDriverConfiguration& p) {
  validate(p.driver);
}
inline void validate(const BusConfiguration& p) {
  validate(p.bus);
}

}  // namespace rigwire::hil
