// Digging, section `digging` of an excavator: the bucket as a tool and the ground's limits.
// sim/excavator/bucket_soil_parameters.h has the words; every default is an estimate.
#pragma once

#include "fields/visitor.h"
#include "sim/excavator/bucket_soil_parameters.h"

namespace rigwire::sim {

inline void visit(fields::Visitor& v, sim::BucketSoilParameters& p) {
  v.number("width", p.width_m, fields::in("m").above(0).at_most(20), "Of the cutting edge.");
  v.number("rear_lip", p.rear_lip_m, fields::in("m").at_least(0),
           "From the bucket pin to where the opening begins.");
  v.number("struck_capacity", p.struck_capacity_m3, fields::in("m3").above(0).at_most(100),
           "Level with the opening.");
  v.number("heap_repose", p.heap_repose_rad, fields::in("deg").between(0, 68),
           "Steepest slope of the soil heaped on it.");
  v.number("lip_angle", p.lip_angle_rad, fields::in("deg").between(0, 89),
           "Between the floor at the teeth and the line from pin to teeth.");
  v.number("edge_resistance", p.edge_resistance_pa, fields::in("kPa").between(0, 1e6),
           "Of the teeth, force over width times depth.");
  v.number("ramp_speed", p.ramp_speed_mps, fields::in("mm/s").between(0.01, 1000),
           "Of the edge, at which the soil's full resistance acts.");
  v.number("outflow_time", p.outflow_time_s, fields::in("ms").above(0).at_most(100000),
           "In which all but 1/e of the soil that cannot stay runs out.");
  v.number("pour_radius", p.pour_radius_m, fields::in("m").between(0, 10),
           "In which falling soil lands.");
  v.number("hard_stiffness", p.hard_stiffness_npm, fields::in("MN/m").between(0.01, 10000),
           "Of the teeth on rock.");
  v.number("hard_damping", p.hard_damping_nspm, fields::in("N s/m").between(0, 1e9),
           "Of the teeth on rock.");
  v.number("hard_friction", p.hard_friction, fields::plain().between(0, 2),
           "Of the teeth on rock.");
}

inline void visit(fields::Visitor& v, sim::DiggableTerrainParameters& p) {
  v.number("depth_max", p.depth_max_m, fields::in("m").between(0, 1000),
           "Below the ground as it was; rock from there on.");
  v.number("loose_initial", p.loose_initial_m, fields::in("m").between(0, 1000),
           "Loose soil on top at the start.");
  v.number("bank", p.bank_rad, fields::in("deg").above(0).at_most(89),
           "Steepest bank of firm soil near where is dug.");
  v.integer("slide_visits", p.slide_visits, fields::IntegerRule{1, 1000000},
            "Nodes looked at for slides in each inner step.");
}

inline void visit(fields::Visitor& v, sim::DiggingParameters& p) {
  v.section("bucket", p.bucket, "What it holds and how the ground resists it.");
  v.section("terrain", p.terrain, "How deep, and how the soil lies.");
}

}  // namespace rigwire::sim
