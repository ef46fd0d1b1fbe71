#include "sim/excavator/undercarriage_parameters.h"

#include <algorithm>
#include <numbers>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;
using fields::IntegerRule;
using fields::plain;

void visit(fields::Visitor& v, CarrierParameters& p) {
  v.number("wheelbase", p.wheelbase_m, in("m").between(0.001, 100),
           "Front to rear wheels, half before and half behind the swing axis.");
  v.number("track", p.track_m, in("m").between(0.001, 100),
           "Left to right tyre, between their middles.");
  v.number("tyre_pressure", p.tyre_pressure_pa, in("MPa").between(0.001, 1000),
           "Pressure of all tyres.");
  v.section("tyre", p.tyre, "One tyre; twins count as one.");
}

void visit(fields::Visitor& v, TrackParameters& p) {
  v.number("gauge", p.gauge_m, in("m").between(0.1, 20), "Left to right track, middle to middle.");
  v.number("length", p.length_m, in("m").between(0.2, 20),
           "What of a track lies on hard ground, half before and half behind the swing axis.");
  v.number("shoe_width", p.shoe_width_m, in("m").between(0.05, 5), "Width of the shoes.");
  v.number("end_radius", p.end_radius_m, in("m").between(0.05, 3),
           "Radius of sprocket and idler over the shoes: what a track climbs.");
  v.integer("stations", p.stations, IntegerRule{3, 21},
            "Places along each track at which it feels the ground; odd.");
  v.number("stiffness", p.stiffness_npm, in("MN/m").between(0.1, 1000),
           "Stiffness of a whole track on hard ground.");
  v.number("damping_ratio", p.damping_ratio, plain().between(0, 2),
           "Damping of a track that carries half of the machine.");
  v.number("grip", p.grip, plain().between(0, 3),
           "Friction of the shoes over the ground's coefficient.");
  v.number("shear_way", p.shear_way_m, in("mm").between(2, 200),
           "Slide at which 63 % of the grip on hard ground is reached.");
  v.number("resistance", p.resistance, plain().between(0, 0.5),
           "Resistance of rollers and links over the load.");
  v.number("moving_mass", p.moving_mass_kg, in("kg").between(10, 1e5),
           "What the travel motor has to speed up, reduced to the shoes; of one track.");
  v.number("displacement", p.displacement_m3prad, in("m3/rad").between(1e-7, 1),
           "Oil that motor and gear take per angle of the sprocket.");
  v.number("sprocket_radius", p.sprocket_radius_m, in("m").between(0.05, 3),
           "Pitch radius of the sprocket.");
  v.number("brake", p.brake_nm, in("N m").between(0, 1e7),
           "Torque of the parking brake at the sprocket.");
  v.section("spool", p.spool, "Valve sections left_track and right_track.");
}

void visit(fields::Visitor& v, SupportParameters& p) {
  v.text("name", p.name, "Name of its valve section: lower-case letters, digits, underscores.");
  v.number("position", p.x_m, in("m").between(-20, 20),
           "Middle of the pads before the swing axis.");
  v.number("spread", p.spread_m, in("m").between(0, 20), "Left to right pad, middle to middle.");
  v.number("pad_length", p.pad_length_m, in("m").between(0.01, 5), "Length of a pad, along x.");
  v.number("pad_width", p.pad_width_m, in("m").between(0.01, 5), "Width of a pad, along y.");
  v.number("raised", p.raised_m, in("m").between(0, 5),
           "Pads over the ground with the cylinders retracted.");
  v.number("travel", p.travel_m, in("m").between(0.01, 10),
           "Way of the pads, downwards, over the cylinders' stroke.");
  v.number("mass", p.mass_kg, in("kg").between(1, 1e5),
           "What moves with the pads; part of the undercarriage's mass.");
  v.number("friction", p.friction, plain().between(0, 3),
           "Friction of the pads over the ground's coefficient.");
  v.integer("cylinders", p.cylinders, IntegerRule{1, 8}, "Cylinders side by side.");
  v.number("bore", p.bore_m, in("mm").between(1, 1000), "Bore of one cylinder.");
  v.number("rod", p.rod_m, in("mm").between(0, 1000), "Rod of one cylinder.");
  v.number("stroke", p.stroke_m, in("mm").between(1, 10'000), "Stroke of the cylinders.");
  v.section("spool", p.spool, "Its valve section.");
}

double SupportParameters::lowering_area_m2() const {
  // Oil per way of the pads: area times stroke over travel.
  return cylinders * std::numbers::pi / 4.0 * bore_m * bore_m * stroke_m / travel_m;
}

double SupportParameters::raising_area_m2() const {
  return cylinders * std::numbers::pi / 4.0 * (bore_m * bore_m - rod_m * rod_m) * stroke_m /
         travel_m;
}

void validate(const TrackParameters& p) {
  fields::check(p);
  fields::require(p.stations % 2 == 1, "stations", std::to_string(p.stations), "3, 5 .. 21, odd");
  fields::require(
      p.shoe_width_m < p.gauge_m, "shoe_width", in("m").print(p.shoe_width_m),
      "less than the gauge of " + in("m").print(p.gauge_m) + ": the tracks would overlap");
}

void validate(const SupportParameters& p) {
  fields::check(p);
  const bool word = !p.name.empty() && std::ranges::all_of(p.name, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
  fields::require(word, "name", "\"" + p.name + "\"", "lower-case letters, digits and underscores");
  fields::require(p.rod_m < p.bore_m, "rod", in("mm").print(p.rod_m),
                  "less than the bore of " + in("mm").print(p.bore_m));
}

}  // namespace rigwire::sim
