// Keys of a vehicle's own sensors and of its odometry.
#pragma once

#include <array>

#include "fields/visitor.h"
#include "sim/odometry/odometry.h"
#include "sim/vehicle_sensors/vehicle_sensors.h"

namespace rigwire::sim {

inline constexpr std::array<fields::Choice<sim::OdometryWheels>, 3> kOdometryWheels{
    {{sim::OdometryWheels::all, "all", "Mean of all wheels."},
     {sim::OdometryWheels::front, "front", "Front wheels or drum."},
     {sim::OdometryWheels::rear, "rear", "Rear wheels or drum."}}};

inline void visit(fields::Visitor& v, sim::OdometryParameters& p) {
  v.number("front_distance", p.front_distance_m, fields::in("m"),
           "Reference point to the front axle.");
  v.number("rear_distance", p.rear_distance_m, fields::in("m"),
           "Rear axle to the reference point.");
  v.number("track", p.track_m, fields::in("m").at_least(0), "Left to right wheel; 0 for drums.");
  v.choice("wheels", p.wheels, kOdometryWheels, "Whose rates give the speed.");
}

inline void visit(fields::Visitor& v, sim::VehicleSensorParameters& p) {
  v.boolean("perfect", p.perfect, "No error at all, whatever the other keys say.");
  v.integer("ticks_per_revolution", p.ticks_per_revolution, fields::IntegerRule{0, 1000000},
            "Of a wheel's encoder; 0 = continuous.");
  v.number("gate", p.gate_s, fields::in("ms").above(0), "Time over which ticks are counted.");
  v.number("dead_rate", p.dead_rate_radps, fields::in("rad/s").at_least(0), "No ticks below.");
  v.number("known_radius", p.known_radius_m, fields::in("m").at_least(0),
           "The controller's wheel radius at every pressure; 0 = the true one.");
  v.number("radius_error", p.radius_error, fields::in("%").between(0, 20),
           "Standard deviation of the radius that the controller knows.");
  v.number("steer_offset", p.steer_offset_rad, fields::in("deg").at_least(0),
           "Standard deviation.");
  v.number("steer_quantum", p.steer_quantum_rad, fields::in("deg").at_least(0), "0 = continuous.");
  v.number("steer_play", p.steer_play_rad, fields::in("deg").at_least(0), "Width of the backlash.");
  v.number("pressure_offset", p.pressure_offset_pa, fields::in("kPa").at_least(0),
           "Standard deviation.");
  v.number("pressure_quantum", p.pressure_quantum_pa, fields::in("kPa").at_least(0),
           "0 = continuous.");
}

}  // namespace rigwire::sim
