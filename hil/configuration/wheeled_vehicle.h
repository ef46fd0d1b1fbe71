// Keys of a wheeled vehicle's parameters (sim/vehicle/parameters.h).
#pragma once

#include <array>

#include "fields/visitor.h"
#include "hil/configuration/integration_scheme.h"
#include "hil/configuration/tyre.h"
#include "sim/vehicle/parameters.h"

namespace rigwire::sim {

inline constexpr std::array<fields::Choice<sim::VehicleLevel>, 3> kVehicleLevels{
    {{sim::VehicleLevel::kinematic, "kinematic", "Bicycle without slip along the terrain."},
     {sim::VehicleLevel::planar, "planar", "Slip and locks, no suspension: road and odometry."},
     {sim::VehicleLevel::full, "full", "14 degrees of freedom: off the road."}}};

inline constexpr std::array<fields::Choice<sim::AxleType>, 2> kAxleTypes{
    {{sim::AxleType::beam, "beam", "Rigid axle on a push tube: heave and roll."},
     {sim::AxleType::independent, "independent", "Each wheel has its own travel."}}};

inline void visit(fields::Visitor& v, sim::SprungBodyParameters& p) {
  v.number("mass", p.mass_kg, fields::in("kg").above(0), "All that the springs carry.");
  v.vector3("center_of_mass", p.center_of_mass_m, fields::in("m"),
            "From the ground below the rear axle's middle.");
  v.vector3("principal_inertia", p.principal_inertia_kgm2, fields::in("kg m2").above(0),
            "About the centre of mass, along the body's axes.");
}

inline void visit(fields::Visitor& v, sim::StopParameters& p) {
  v.number("stiffness", p.stiffness, fields::plain().above(0), "N per m, or N m per rad.");
  v.number("ramp", p.ramp, fields::plain().above(0), "m, or rad, over which it grows to that.");
}

inline void visit(fields::Visitor& v, sim::BeamAxleParameters& p) {
  v.number("mass", p.mass_kg, fields::in("kg").above(0), "With its wheels.");
  v.number("roll_inertia", p.roll_inertia_kgm2, fields::in("kg m2").above(0), "With its wheels.");
  v.number("pitch_inertia", p.pitch_inertia_kgm2, fields::in("kg m2").above(0),
           "Without the wheels' spin.");
  v.number("tube_length", p.tube_length_m, fields::in("m").at_least(0),
           "Axle to the push tube's pivot; 0 guides it straight up and down.");
  v.number("tube_rise", p.tube_rise_m, fields::in("m"), "Pivot above the axle's centre.");
  v.number("roll_centre_rise", p.roll_centre_rise_m, fields::in("m"),
           "Panhard rod above the axle's centre.");
  v.number("spring", p.spring_npm, fields::in("N/m").above(0), "Of each side.");
  v.number("damper", p.damper_nspm, fields::in("N s/m").at_least(0), "Of each side.");
  v.number("spring_base", p.spring_base_m, fields::in("m").above(0), "Left to right spring.");
  v.number("roll_bar", p.roll_bar_nmprad, fields::plain().at_least(0), "N m per rad.");
  v.number("bump_travel", p.bump_travel_m, fields::in("mm").above(0), "Up to the bump stop.");
  v.number("rebound_travel", p.rebound_travel_m, fields::in("mm").above(0),
           "Down to the rebound stop.");
  v.section("bump_stop", p.bump_stop, "Spring at both ends of the travel.");
  v.number("articulation", p.articulation_rad, fields::in("deg").above(0).at_most(60),
           "Roll against the body, to each side, up to the limiter.");
  v.section("articulation_stop", p.articulation_stop, "Spring of the limiter.");
}

inline void visit(fields::Visitor& v, sim::IndependentAxleParameters& p) {
  v.number("corner_mass", p.corner_mass_kg, fields::in("kg").above(0),
           "Wheel, carrier, half the arms.");
  v.number("corner_inertia", p.corner_inertia_kgm2, fields::in("kg m2").above(0),
           "About a diameter of the wheel.");
  v.number("spring", p.spring_npm, fields::in("N/m").above(0), "At the wheel, per side.");
  v.number("damper", p.damper_nspm, fields::in("N s/m").at_least(0), "At the wheel, per side.");
  v.number("roll_bar", p.roll_bar_npm, fields::in("N/m").at_least(0), "Per difference of travels.");
  v.number("bump_travel", p.bump_travel_m, fields::in("mm").above(0), "Up to the bump stop.");
  v.number("rebound_travel", p.rebound_travel_m, fields::in("mm").above(0),
           "Down to the rebound stop.");
  v.section("bump_stop", p.bump_stop, "Spring at both ends of the travel.");
  v.number("camber_gain", p.camber_gain_radpm, fields::plain().between(-5, 5),
           "rad per m of bump, top outward positive.");
  v.number("toe_gain", p.toe_gain_radpm, fields::plain().between(-5, 5),
           "rad per m of bump, toe-in positive.");
}

inline void visit(fields::Visitor& v, sim::SteeringParameters& p) {
  v.number("angle_max", p.angle_max_rad, fields::in("deg").between(0, 60),
           "Of the equivalent single wheel; 0: the axle does not steer.");
  v.number("rate_max", p.rate_max_radps, fields::in("deg/s").above(0), "Of the same.");
  v.number("time_constant", p.time_constant_s, fields::in("ms").at_least(0),
           "Lag below that rate.");
}

inline void visit(fields::Visitor& v, sim::VehicleAxleParameters& p) {
  v.choice("type", p.type, kAxleTypes, "Beam or independent wheels.");
  v.number("position", p.position_x_m, fields::in("m"), "x in the body's frame.");
  v.number("track", p.track_m, fields::in("m").above(0), "Between the wheels' centres.");
  v.number("portal_offset", p.portal_offset_m, fields::in("mm"),
           "Wheel's centre below the beam's.");
  v.number("wheel_spin_inertia", p.wheel_spin_inertia_kgm2, fields::in("kg m2").above(0),
           "Of one wheel with tyre and hub.");
  v.section("beam", p.beam, "With type beam.");
  v.section("independent", p.independent, "With type independent.");
  v.section("tyre", p.tyre, "Both tyres.");
  v.section("steering", p.steering, "Actuator and linkage.");
  v.number("brake_torque", p.brake_torque_nm, fields::in("N m").at_least(0),
           "Of both wheels, pedal down.");
  v.number("parking_brake", p.parking_brake_nm, fields::in("N m").at_least(0), "Of both wheels.");
  v.number("initial_pressure", p.initial_pressure_pa, fields::in("bar").above(0), "Of its tyres.");
}

inline void visit(fields::Visitor& v, sim::TyrePressureParameters& p) {
  v.boolean("adjustable", p.adjustable, "Whether set points are followed.");
  v.number("inflate_time_constant", p.inflate_time_constant_s, fields::in("s").above(0),
           "Lag, up.");
  v.number("deflate_time_constant", p.deflate_time_constant_s, fields::in("s").above(0),
           "Lag, down.");
  v.number("pressure_min", p.pressure_min_pa, fields::in("bar").above(0), "Least set point.");
  v.number("pressure_max", p.pressure_max_pa, fields::in("bar").above(0), "Greatest set point.");
}

inline void visit(fields::Visitor& v, sim::ChassisPoint& p) {
  v.vector3("position", p.position_m, fields::in("m"), "In the body's frame.");
}

inline void visit(fields::Visitor& v, sim::ChassisContactParameters& p) {
  v.list("points", p.points, "Corners that may hit something, at most 16.");
  v.number("stiffness", p.stiffness_npm, fields::in("N/m").above(0), "Of each.");
  v.number("damping", p.damping_nspm, fields::in("N s/m").at_least(0), "Of each.");
}

inline void visit(fields::Visitor& v, sim::WheeledVehicleParameters& p) {
  v.choice("level", p.level, kVehicleLevels, "How much of the vehicle is computed.");
  v.section("body", p.body, "What the springs carry.");
  v.section("front", p.front, "Front axle.");
  v.section("rear", p.rear, "Rear axle.");
  v.number("brake_stiffness", p.brake_stiffness_nmprad, fields::plain().above(0),
           "N m per rad of a brake that holds.");
  v.section("tyre_pressure", p.tyre_pressure, "Central tyre inflation.");
  v.section("chassis", p.chassis, "Corners that may hit something.");
  v.number("air_drag", p.air_drag_ns2pm2, fields::plain().at_least(0), "N per (m/s)^2.");
  v.choice("scheme", p.scheme, kIntegrationSchemes, "How level full steps its equations.");
  v.number("step", p.step_s, fields::in("ms").above(0).at_most(20), "Longest inner step.");
  v.number("gravity", p.gravity_mps2, fields::in("m/s2").at_least(0), "Downwards.");
}

}  // namespace rigwire::sim
