// The motor of a spinning lidar's head.
#pragma once

#include "hil/configuration/fields.h"
#include "hil/configuration/units.h"
#include "sim/lidar/rotor.h"

namespace rigwire::hil {

template <class Visitor>
void visit(Visitor& v, sim::RotorParameters& p) {
  v.boolean("starts_at_rest", p.starts_at_rest, "Else it turns as commanded from the start.");
  v.number("time_constant", p.time_constant_s, in("s").between(0.001, 60),
           "Of the speed controller.");
  v.number("acceleration", p.acceleration_radps2, in("rad/s2").between(0.1, 10000),
           "By the motor's torque, at most.");
  v.number("wander", p.wander_radps, in("rpm").between(0, 95),
           "Spread of the speed; real: 1 to 2.");
  v.number("wander_correlation", p.wander_correlation_s, in("s").between(0.01, 1000),
           "Time in which the wander changes.");
  v.number("phase_time", p.phase_time_s, in("s").between(0.01, 60),
           "In which the phase lock's error falls to 1/e.");
  v.number("phase_speed", p.phase_speed_share, in("%").between(0.01, 20),
           "Change of speed for the phase lock, at most.");
  v.duration("stall_at", p.stall_at, {0, 1'000'000'000'000'000}, "When the rotor jams.");
  v.duration("stall_for", p.stall_for, {0, 1'000'000'000'000'000}, "How long; 0: it does not.");
}

}  // namespace rigwire::hil
