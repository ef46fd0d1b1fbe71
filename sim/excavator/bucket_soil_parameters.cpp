#include "sim/excavator/bucket_soil_parameters.h"

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;
using fields::plain;

void visit(fields::Visitor& v, BucketSoilParameters& p) {
  v.number("width", p.width_m, in("m").between(0.001, 20), "Width of the cutting edge.");
  v.number("rear_lip", p.rear_lip_m, in("m").at_least(0).at_most(100),
           "From the bucket pin to where the opening begins.");
  v.number("struck_capacity", p.struck_capacity_m3, in("m3").between(1e-9, 100),
           "Soil that the bucket holds level with its opening.");
  v.number("heap_repose", p.heap_repose_rad, in("deg").between(0, 68.75),
           "Steepest slope of the soil heaped on the opening.");
  v.number("lip_angle", p.lip_angle_rad, in("deg").between(0, 89.9),
           "Between the floor at the teeth and the line from pin to teeth.");
  v.number("edge_resistance", p.edge_resistance_pa, in("kPa").between(0, 1e6),
           "Resistance of the teeth, force over width times depth.");
  v.number("ramp_speed", p.ramp_speed_mps, in("mm/s").between(0.01, 1000),
           "Speed of the edge at which the soil's full resistance acts.");
  v.number("outflow_time", p.outflow_time_s, in("ms").between(0.001, 100000),
           "Time in which all but 1/e of the soil that cannot stay runs out.");
  v.number("pour_radius", p.pour_radius_m, in("m").between(0, 10),
           "Radius in which falling soil lands.");
  v.number("hard_stiffness", p.hard_stiffness_npm, in("MN/m").between(0.01, 10000),
           "Stiffness of the teeth on rock.");
  v.number("hard_damping", p.hard_damping_nspm, in("N s/m").between(0, 1e9),
           "Damping of the teeth on rock.");
  v.number("hard_friction", p.hard_friction, plain().between(0, 2),
           "Coefficient of friction of the teeth on rock.");
}

void visit(fields::Visitor& v, DiggingParameters& p) {
  v.section("bucket", p.bucket, "What the bucket holds and how the ground resists it.");
  v.section("terrain", p.terrain, "How deep, and how the soil lies.");
}

void validate(const BucketSoilParameters& p, double bucket_tip_m) {
  fields::check(p);
  fields::require(
      p.rear_lip_m <= 0.9 * bucket_tip_m, "rear_lip", in("m").print(p.rear_lip_m),
      "at most nine tenths of the distance from pin to tip, " + in("m").print(bucket_tip_m));
}

}  // namespace rigwire::sim
