// The machine of a rig: which kind, its parameters, where it stands, what it looks like.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "hil/configuration/excavator.h"
#include "hil/configuration/fields.h"
#include "hil/configuration/shapes.h"
#include "hil/configuration/units.h"
#include "sim/samples/vector3.h"

namespace rigwire::hil {

enum class MachineType { excavator };
inline constexpr std::array<Choice<MachineType>, 1> kMachineTypes{
    {{MachineType::excavator, "excavator", "Swing, boom, stick and bucket."}}};

/// Links that shapes and sensors can be fixed to.
inline constexpr std::array<std::string_view, 5> kExcavatorLinks{"undercarriage", "upper", "boom",
                                                                 "stick", "bucket"};

/// A shape fixed to a link.
struct LinkShape {
  std::string link = "upper";
  PlacedShape placed;
};

struct MachineConfiguration {
  std::string name = "machine";
  std::string text;  ///< One line for `rigwire list machines`.
  MachineType type = MachineType::excavator;
  Vector3 position_m;     ///< [east, north, up] of the undercarriage's origin.
  double yaw_rad = 0.0;   ///< Of its x from east, left positive.
  bool on_ground = true;  ///< position z counts from the terrain under it.
  sim::ExcavatorParameters excavator;
  std::vector<LinkShape> shapes;
};

template <class Visitor>
void visit(Visitor& v, LinkShape& p) {
  v.text("link", p.link, "undercarriage, upper, boom, stick or bucket.");
  visit(v, p.placed);
}

template <class Visitor>
void visit(Visitor& v, MachineConfiguration& p) {
  v.text("name", p.name, "For people.");
  v.text("text", p.text, "One line for `rigwire list machines`.");
  v.required("type");
  v.choice("type", p.type, kMachineTypes, "Kind of machine.");
  v.vector3("position", p.position_m, in("m"), "[east, north, up] of the undercarriage.");
  v.number("yaw", p.yaw_rad, in("deg").between(-360, 360), "Of its x from east, left positive.");
  v.boolean("on_ground", p.on_ground, "Whether `up` counts from the terrain under it.");
  v.section("excavator", p.excavator, "Masses, pins, cylinders, hydraulics, drives.");
  v.list("shapes", p.shapes, "What the lidar sees of it, by link.");
}

}  // namespace rigwire::hil
