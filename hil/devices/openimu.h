// ACEINNA OpenIMU: wire, mount, device and sensor.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "emulators/openimu/openimu335ri.h"
#include "fields/visitor.h"
#include "hil/configuration/supply.h"
#include "hil/world/mount.h"
#include "sim/imu/imu_sensor.h"
#include "sim/imu/magnetometer.h"

namespace rigwire::hil {

/// ACEINNA OpenIMU335RI on a J1939 bus.
struct OpenImuDeviceConfiguration {
  static constexpr fields::Named kNamed{"openimu335ri",
                                        "ACEINNA OpenIMU335RI inertial unit on CAN (J1939)."};

  std::string bus = "can";  ///< One of the rig's buses.
  MountConfiguration mount;
  emulators::OpenImuSettings imu;
  std::string settings_file;  ///< What "save" writes; empty: kept for the run.
  sim::ImuParameters sensor;
  sim::MagnetometerConfiguration magnetometer;  ///< OpenIMU300RI.
};

/// ACEINNA OpenIMU300RI, the same with older firmware and a magnetometer.
struct OpenImu300riDeviceConfiguration : OpenImuDeviceConfiguration {
  static constexpr fields::Named kNamed{
      "openimu300ri", "ACEINNA OpenIMU300RI inertial unit on CAN (J1939), with magnetometer."};

  OpenImu300riDeviceConfiguration() { imu.variant = emulators::OpenImuVariant::openimu300ri; }
};

/// Rates that the device's divider can give.
inline constexpr std::array<fields::Choice<std::uint8_t>, 9> kOpenImuRates{{{0, "0 Hz", "Silent."},
                                                                            {50, "2 Hz", ""},
                                                                            {25, "4 Hz", ""},
                                                                            {20, "5 Hz", ""},
                                                                            {10, "10 Hz", ""},
                                                                            {5, "20 Hz", ""},
                                                                            {4, "25 Hz", ""},
                                                                            {2, "50 Hz", ""},
                                                                            {1, "100 Hz", ""}}};

/// Low-pass filters of the device.
inline constexpr std::array<fields::Choice<std::uint8_t>, 7> kOpenImuCutOffs{
    {{0, "off", "No filter."},
     {2, "2 Hz", ""},
     {5, "5 Hz", ""},
     {10, "10 Hz", ""},
     {25, "25 Hz", ""},
     {40, "40 Hz", ""},
     {50, "50 Hz", ""}}};

inline void visit(fields::Visitor& v, OpenImuDeviceConfiguration& p) {
  v.text("bus", p.bus, "One of the rig's buses.");
  v.integer("source_address", p.imu.source_address, fields::IntegerRule{128, 247},
            "Preferred J1939 address; another one is claimed when it is lost.");
  v.integer("serial", p.imu.serial, fields::IntegerRule{0, (1 << 21) - 1},
            "In the NAME; unique on a bus.");
  v.choice("rate", p.imu.configuration.rate_divider, kOpenImuRates,
           "Of the data messages at power-on.");
  v.integer("packets", p.imu.configuration.packet_mask, fields::IntegerRule{0, 47},
            "Messages sent, summed: 1 slope, 2 angular rate, 4 acceleration; 8 magnetic field "
            "(300RI) or fine angular rate, 32 older slope (335RI).");
  v.choice("rate_filter", p.imu.configuration.rate_cut_off_hz, kOpenImuCutOffs,
           "Low pass of the angular rates.");
  v.choice("acceleration_filter", p.imu.configuration.acceleration_cut_off_hz, kOpenImuCutOffs,
           "Low pass of the accelerations.");
  v.integer("orientation", p.imu.configuration.orientation, fields::IntegerRule{0, 65535},
            "Axes code of the device, one of 24.");
  v.number("rate_range", p.imu.rate_range_radps, fields::in("deg/s").above(0).at_most(2000),
           "Beyond it the rate is clamped and marked.");
  v.number("acceleration_range", p.imu.acceleration_range_mps2,
           fields::in("m/s2").above(0).at_most(1000),
           "Beyond it the acceleration is clamped and marked.");
  visit_supply(v, p.imu.supply);
  v.text("settings_file", p.settings_file,
         "What a client saved, for the next run; empty: as long as the run.");
  v.duration("processing_delay", p.imu.processing_delay, {0, 4'000'000},
             "From a sample or request to the frame.");
  v.section("mount", p.mount, "Of the sensor's axes.");
  v.section("sensor", p.sensor, "How well it measures.");
  if (p.imu.variant == emulators::OpenImuVariant::openimu300ri) {
    v.section("magnetometer", p.magnetometer, "The Earth's field as it reads it.");
  }
}

inline void validate(const OpenImuDeviceConfiguration& p) {
  validate(p.imu);
}

}  // namespace rigwire::hil
