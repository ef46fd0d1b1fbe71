// An emulated CANopen inclinometer under test.
#pragma once

#include <cmath>
#include <cstdint>

#include "canopen_rig.h"
#include "emulators/canopen/inclinometer.h"
#include "fields/constants.h"

namespace rigwire::emulators {

inline constexpr double kGravity_mps2 = 9.81;

struct InclinometerRig final : CanopenRig<Inclinometer> {
  /// Without the filter, so that a sample is a reading.
  static InclinometerSettings settings() {
    InclinometerSettings settings;
    settings.node.node_id = kNode;
    settings.filter_step = 0;
    return settings;
  }
  explicit InclinometerRig(const InclinometerSettings& of = settings()) : CanopenRig(of) {}

  void feed(SimTime instant) override {
    ImuSample sample;
    sample.time = instant;
    sample.specific_force_mps2 = force;
    device.update(sample);
  }
  /// At rest, turned by `pitch` (nose up) about y and then by `roll` (left side up) about x.
  void tilt(double pitch_rad, double roll_rad) {
    force = {kGravity_mps2 * std::sin(pitch_rad),
             kGravity_mps2 * std::cos(pitch_rad) * std::sin(roll_rad),
             kGravity_mps2 * std::cos(pitch_rad) * std::cos(roll_rad)};
  }
  /// One reading later.
  void measure() { run(device.sample_plan().period); }
  int slope16(std::uint16_t index) { return static_cast<std::int16_t>(read(index)); }
  int slope32(std::uint16_t index) { return static_cast<std::int32_t>(read(index)); }

  Vector3 force{0.0, 0.0, kGravity_mps2};
};

}  // namespace rigwire::emulators
