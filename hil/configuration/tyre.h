// Keys of a tyre.
#pragma once

#include "fields/visitor.h"
#include "sim/tyre/tyre.h"

namespace rigwire::sim {

inline void visit(fields::Visitor& v, sim::TyreParameters& p) {
  v.number("unloaded_radius", p.unloaded_radius_m, fields::in("m").above(0), "Without load.");
  v.number("width", p.width_m, fields::in("m").above(0), "Of the tread.");
  v.number("rim_radius", p.rim_radius_m, fields::in("m").above(0), "Where the tyre bottoms.");
  v.number("carcass_stiffness", p.carcass_stiffness_npm, fields::in("kN/m").at_least(0),
           "Vertical, without pressure.");
  v.number("stiffness_per_pressure", p.stiffness_per_pressure_m, fields::plain().at_least(0),
           "N/m per Pa: what each pascal adds to it.");
  v.number("vertical_damping", p.vertical_damping_nspm, fields::in("N s/m").at_least(0),
           "On the ground.");
  v.number("bottoming_factor", p.bottoming_factor, fields::plain().at_least(0),
           "Stiffness on the rim, times that of the tyre.");
  v.number("reference_load", p.reference_load_n, fields::in("kN").above(0),
           "At which the slip stiffnesses hold; they go with the load.");
  v.number("reference_pressure", p.reference_pressure_pa, fields::in("bar").at_least(0.1),
           "At which the rolling resistance holds.");
  v.number("slip_stiffness", p.slip_stiffness_n, fields::in("kN").above(0),
           "Force per slip of 1, along.");
  v.number("cornering_stiffness", p.cornering_stiffness_nprad, fields::plain().above(0),
           "N per rad of slip angle.");
  v.number("longitudinal_stiffness", p.longitudinal_stiffness_npm, fields::in("kN/m").above(0),
           "Of the standing tyre, along.");
  v.number("lateral_stiffness", p.lateral_stiffness_npm, fields::in("kN/m").above(0),
           "Of the standing tyre, across.");
  v.number("damping_ratio", p.damping_ratio, fields::plain().at_least(0),
           "Of both, with the mass that the wheel carries.");
  v.number("friction_factor", p.friction_factor, fields::plain().at_least(0),
           "On the ground's coefficient of friction.");
  v.number("rolling_resistance", p.rolling_resistance, fields::plain().at_least(0).at_most(0.9),
           "Coefficient on hard ground at the reference pressure.");
  v.number("rolling_pressure_share", p.rolling_pressure_share, fields::plain().between(0, 1),
           "Share of it that goes with 1 / pressure.");
}

}  // namespace rigwire::sim
