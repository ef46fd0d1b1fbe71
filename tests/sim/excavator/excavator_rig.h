// The excavator of the tests on firm ground: commands by name, and comparison bit by bit.
#pragma once

#include "sim/excavator/excavator.h"

namespace rigwire::sim::test {

inline ValveCommand openings(double swing, double boom, double stick, double bucket) {
  ValveCommand command;
  command.opening = {swing, boom, stick, bucket};
  return command;
}

inline Excavator level_machine(const ExcavatorParameters& parameters = {}) {
  return Excavator(parameters, Eigen::Isometry3d::Identity());
}

/// Bits, not values: a difference of one rounding must show.
inline bool same_bits(const Excavator& a, const Excavator& b) {
  return a.joint_angles_rad() == b.joint_angles_rad() &&
         a.joint_rates_radps() == b.joint_rates_radps() && a.drive_targets() == b.drive_targets() &&
         a.drive_forces() == b.drive_forces() &&
         a.joint_accelerations_radps2() == b.joint_accelerations_radps2();
}

}  // namespace rigwire::sim::test
