// Keys of a tandem roller: section `roller` of a machine file.
#pragma once

#include <array>

#include "fields/visitor.h"
#include "hil/configuration/integration_scheme.h"
#include "sim/roller/parameters.h"

namespace rigwire::sim {

inline constexpr std::array<fields::Choice<sim::RollerLevel>, 2> kRollerLevels{
    {{sim::RollerLevel::kinematic, "kinematic", "Drums roll without slip."},
     {sim::RollerLevel::dynamic, "dynamic", "Slip, scrub, drive and brakes."}}};

inline void visit(fields::Visitor& v, sim::DrumParameters& p) {
  v.number("width", p.width_m, fields::in("mm").above(0), "Of each drum.");
  v.number("radius", p.radius_m, fields::in("mm").above(0), "Of each drum.");
  v.number("spin_inertia", p.spin_inertia_kgm2, fields::in("kg m2").above(0), "About the axle.");
  v.integer("strips", p.strips, fields::IntegerRule{1, sim::kDrumStripsMax},
            "Contact strips along the width; an even number has the whole scrub moment.");
  v.number("slip_stiffness", p.slip_stiffness_n, fields::in("kN").above(0),
           "Force per slip, at none.");
  v.number("cornering_stiffness", p.cornering_stiffness_nprad, fields::plain().above(0),
           "N per rad of slip angle, at none.");
  v.number("relaxation_length", p.relaxation_length_m, fields::in("mm").above(0),
           "Way on which slip forces build up.");
  v.number("contact_length", p.contact_length_m, fields::in("mm").above(0), "On soft soil.");
  v.number("damping_ratio", p.damping_ratio, fields::plain().between(0, 10),
           "Of the contact's bristles.");
  v.number("friction_factor", p.friction_factor, fields::plain().at_least(0),
           "Steel on the ground, against rubber on it.");
  v.number("rolling_resistance", p.rolling_resistance, fields::plain().at_least(0).at_most(0.99),
           "Coefficient on hard ground.");
}

inline void visit(fields::Visitor& v, sim::PivotSteeringParameters& p) {
  v.number("angle_max", p.angle_max_rad, fields::in("deg").above(0).at_most(85),
           "Stop on both sides.");
  v.number("rate_max", p.rate_max_radps, fields::in("deg/s").above(0), "Of each pivot.");
  v.number("time_constant", p.time_constant_s, fields::in("ms").at_least(0),
           "Lag near the set point.");
}

inline void visit(fields::Visitor& v, sim::HydrostaticDriveParameters& p) {
  v.number("motor_displacement", p.motor_displacement_m3prad, fields::plain().above(0),
           "m3 per rad of a drum, each motor.");
  v.number("pump_displacement", p.pump_displacement_m3prad, fields::plain().above(0),
           "m3 per rad of the engine, at full swash.");
  v.number("oil_volume", p.oil_volume_m3, fields::in("l").above(0), "Under pressure.");
  v.number("bulk_modulus", p.bulk_modulus_pa, fields::in("MPa").above(0), "Of oil and hoses.");
  v.number("leakage", p.leakage_m3pspa, fields::plain().at_least(0),
           "m3/s per Pa, pump and motors.");
  v.number("relief_pressure", p.relief_pressure_pa, fields::in("MPa").above(0),
           "Between the lines.");
  v.number("charge_pressure", p.charge_pressure_pa, fields::in("MPa").at_least(0),
           "Of the low side.");
  v.number("motor_friction", p.motor_friction_nmsprad, fields::in("N m s/rad").at_least(0),
           "Viscous, of each motor.");
  v.number("ramp", p.ramp_mps2, fields::in("m/s2").above(0), "Of the travel set point.");
  v.number("swash_time_constant", p.swash_time_constant_s, fields::in("ms").at_least(0),
           "Lag of the pump.");
  v.number("speed_max", p.speed_max_mps, fields::in("km/h").above(0), "Both ways.");
  v.number("engine_idle", p.engine_idle_radps, fields::in("rpm").above(0),
           "Governor's least speed.");
  v.number("engine_rated", p.engine_rated_radps, fields::in("rpm").above(0),
           "Governor's greatest speed.");
  v.number("engine_torque", p.engine_torque_nm, fields::in("N m").above(0), "Greatest.");
  v.number("engine_droop", p.engine_droop, fields::plain().between(0, 0.5),
           "Share of speed lost at greatest torque.");
  v.number("engine_time_constant", p.engine_time_constant_s, fields::in("ms").at_least(0),
           "Lag of the governor.");
  v.boolean("flow_divider", p.flow_divider, "Always closed: both drums get half of the flow.");
  v.boolean("bypass", p.bypass, "Towing valves open: drums turn freely.");
}

inline void visit(fields::Visitor& v, sim::VibrationParameters& p) {
  v.number("frequency", p.frequency_hz, fields::in("Hz").above(0), "Of the exciter at full speed.");
  v.number("amplitude", p.amplitude_m, fields::in("mm").at_least(0), "Of the drum, zero to peak.");
  v.number("ramp", p.ramp_s, fields::in("s").at_least(0),
           "From standstill to full speed and back.");
  v.number("frame_share", p.frame_share, fields::plain().between(0, 1),
           "Let through by the mounts.");
  v.number("frame_phase", p.frame_phase_rad, fields::in("deg").between(-360, 360),
           "By which the frame lags the drum.");
}

inline void visit(fields::Visitor& v, sim::SprinklerParameters& p) {
  v.number("capacity", p.capacity_kg, fields::in("kg").at_least(0), "Of the water tank.");
  v.number("initial", p.initial_kg, fields::in("kg").at_least(0), "Water at the start.");
  v.number("flow", p.flow_kgps, fields::plain().at_least(0), "kg/s while moving.");
  v.number("x", p.x_m, fields::in("m"), "Of the tank's centre, in the frame.");
  v.number("height", p.height_m, fields::in("m").at_least(0), "Of the tank's centre above ground.");
}

inline void visit(fields::Visitor& v, sim::SpreaderParameters& p) {
  v.number("capacity", p.capacity_kg, fields::in("kg").at_least(0), "Of the hopper.");
  v.number("initial", p.initial_kg, fields::in("kg").at_least(0), "Chips at the start.");
  v.number("width", p.width_m, fields::in("mm").at_least(0), "That is spread.");
  v.number("rate_max", p.rate_max_kgpm2, fields::plain().at_least(0), "kg/m2.");
  v.number("x", p.x_m, fields::in("m"), "Of the hopper's centre, in the frame.");
  v.number("height", p.height_m, fields::in("m").at_least(0),
           "Of the hopper's centre above ground.");
}

inline void visit(fields::Visitor& v, sim::EdgeCutterParameters& p) {
  v.number("lift", p.lift_m, fields::in("mm").at_least(0), "Of the wheel when raised.");
  v.number("lift_time", p.lift_time_s, fields::in("s").above(0), "Over the whole lift.");
  v.number("press_share", p.press_share, fields::plain().between(0, 0.99),
           "Share of the lift at which the wheel meets the mat.");
  v.number("lateral", p.lateral_n, fields::in("kN").at_least(0),
           "Reaction, pressed down and moving.");
  v.number("moving", p.moving_mps, fields::in("m/s").above(0),
           "Speed from which the reaction is full.");
  v.number("x", p.x_m, fields::in("m"), "Of the wheel, in the frame.");
  v.number("y", p.y_m, fields::in("m"), "Of the wheel; the reaction points away from its side.");
}

inline void visit(fields::Visitor& v, sim::RollerParameters& p) {
  v.choice("level", p.level, kRollerLevels, "What is modelled.");
  v.number("mass", p.mass_kg, fields::in("kg").above(0), "With drums, without water and chips.");
  v.number("yaw_inertia", p.yaw_inertia_kgm2, fields::in("kg m2").above(0),
           "About the centre of mass.");
  v.number("center_of_mass_x", p.center_of_mass_x_m, fields::in("m"), "Forward of half way.");
  v.number("center_of_mass_height", p.center_of_mass_height_m, fields::in("m").at_least(0),
           "Above ground.");
  v.number("pivot_x", p.pivot_x_m, fields::in("m").above(0),
           "Half the distance of the drums' axles.");
  v.section("drum", p.drum, "Both drums.");
  v.section("steering", p.steering, "Both pivots.");
  v.section("drive", p.drive, "Engine, pump and motors.");
  v.number("brake_torque", p.brake_torque_nm, fields::in("kN m").at_least(0), "Of each drum.");
  v.number("parking_brake_torque", p.parking_brake_torque_nm, fields::in("kN m").at_least(0),
           "Of each drum.");
  v.number("brake_stiffness", p.brake_stiffness_nmprad, fields::plain().above(0),
           "N m per rad of a held drum.");
  v.section("front_vibration", p.front_vibration, "Exciter of the front drum.");
  v.section("rear_vibration", p.rear_vibration, "Exciter of the rear drum.");
  v.section("sprinkler", p.sprinkler, "Water for the drums.");
  v.section("spreader", p.spreader, "Chip hopper.");
  v.section("edge_cutter", p.edge_cutter, "Cutting wheel on an arm.");
  v.number("rest_frequency", p.rest_frequency_hz, fields::in("Hz").above(0),
           "Of heave, pitch and roll on mat and mounts.");
  v.number("rest_damping_ratio", p.rest_damping_ratio, fields::plain().between(0, 10),
           "Of the same.");
  v.choice("scheme", p.scheme, kIntegrationSchemes, "How level dynamic steps its equations.");
  v.number("step", p.step_s, fields::in("ms").above(0).at_most(50), "Longest inner step.");
  v.number("gravity", p.gravity_mps2, fields::in("m/s2").at_least(0), "Downwards.");
}

}  // namespace rigwire::sim
