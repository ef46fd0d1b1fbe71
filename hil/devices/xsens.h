// Xsens MTi-600: bus, mount, messages with their rates, and sensor.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "emulators/xsens/mti_600.h"
#include "fields/visitor.h"
#include "hil/configuration/supply.h"
#include "hil/world/mount.h"
#include "sim/imu/imu_sensor.h"
#include "sim/imu/magnetometer.h"

namespace rigwire::hil {

/// Xsens MTi-600 on a CAN bus.
struct XsensMtiConfiguration {
  static constexpr fields::Named kNamed{"xsens-mti-600", "Xsens MTi-600 inertial unit on CAN."};

  std::string bus = "can";  ///< One of the rig's buses.
  MountConfiguration mount;
  emulators::MtiSettings mti;
  sim::ImuParameters sensor;
  sim::MagnetometerConfiguration magnetometer;
};

/// Rates that the unit's 400 samples a second give.
inline constexpr std::array<fields::Choice<std::uint16_t>, 14> kMtiRates{{{0, "off", "Not sent."},
                                                                          {400, "1 Hz", ""},
                                                                          {200, "2 Hz", ""},
                                                                          {100, "4 Hz", ""},
                                                                          {80, "5 Hz", ""},
                                                                          {40, "10 Hz", ""},
                                                                          {20, "20 Hz", ""},
                                                                          {16, "25 Hz", ""},
                                                                          {10, "40 Hz", ""},
                                                                          {8, "50 Hz", ""},
                                                                          {5, "80 Hz", ""},
                                                                          {4, "100 Hz", ""},
                                                                          {2, "200 Hz", ""},
                                                                          {1, "400 Hz", ""}}};

/// The unit's outputs as keys.
struct MtiOutputs {
  std::array<emulators::MtiOutput, emulators::kMtiOutputs.size()>* outputs;
};

inline void visit(fields::Visitor& v, MtiOutputs& p) {
  for (emulators::MtiOutput& output : *p.outputs) {
    v.choice(protocols::xsens::message(output.id).name, output.divider, kMtiRates,
             "How often this message is sent.");
  }
}

inline void visit(fields::Visitor& v, XsensMtiConfiguration& p) {
  v.text("bus", p.bus, "One of the rig's buses.");
  MtiOutputs outputs{&p.mti.outputs};
  v.section("outputs", outputs, "Messages and their rates.");
  v.boolean("extended", p.mti.extended, "29-bit identifiers instead of 11-bit ones.");
  v.number("heading", p.mti.heading_rad, fields::in("deg").between(-360, 360),
           "Of the unit's filter at power-on, from east, left positive; nothing corrects it.");
  v.number("rate_range", p.mti.rate_range_radps, fields::in("deg/s").above(0).at_most(4000),
           "Beyond it the rate is clamped and marked.");
  v.number("acceleration_range", p.mti.acceleration_range_mps2,
           fields::in("m/s2").above(0).at_most(1000),
           "Beyond it the acceleration is clamped and marked.");
  visit_supply(v, p.mti.supply);
  v.duration("start_up", p.mti.start_up, {0, 60'000'000'000}, "From power-on to the first sample.");
  v.duration("processing_delay", p.mti.processing_delay, {0, 100'000'000},
             "From a sample to its messages.");
  v.section("mount", p.mount, "Of the sensor's axes.");
  v.section("sensor", p.sensor, "How well it measures.");
  v.section("magnetometer", p.magnetometer, "The Earth's field as it reads it.");
}

inline void validate(const XsensMtiConfiguration& p) {
  validate(p.mti);
}

}  // namespace rigwire::hil
