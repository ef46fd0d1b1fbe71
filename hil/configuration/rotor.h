// The motor of a spinning lidar's head.
#pragma once

#include "fields/visitor.h"
#include "sim/lidar/rotor.h"

namespace rigwire::sim {

inline void visit(fields::Visitor& v, sim::RotorParameters& p) {
  v.boolean("starts_at_rest", p.starts_at_rest, "Else it turns as commanded from the start.");
  v.number("time_constant", p.time_constant_s, fields::in("s").between(0.001, 60),
           "Of the speed controller.");
  v.number("acceleration", p.acceleration_radps2, fields::in("rad/s2").between(0.1, 10000),
           "By the motor's torque, at most.");
  v.number("wander", p.wander_radps, fields::in("rpm").between(0, 95),
           "Spread of the speed; real: 1 to 2.");
  v.number("wander_correlation", p.wander_correlation_s, fields::in("s").between(0.01, 1000),
           "Time in which the wander changes.");
  v.number("phase_time", p.phase_time_s, fields::in("s").between(0.01, 60),
           "In which the phase lock's error falls to 1/e.");
  v.number("phase_speed", p.phase_speed_share, fields::in("%").between(0.01, 20),
           "Change of speed for the phase lock, at most.");
}

}  // namespace rigwire::sim
