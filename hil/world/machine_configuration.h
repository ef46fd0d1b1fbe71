// The machine of a rig: which kind, its parameters, where it stands, what it looks like.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "fields/visitor.h"
#include "hil/configuration/digging.h"
#include "hil/configuration/driveline.h"
#include "hil/configuration/excavator.h"
#include "hil/configuration/roller.h"
#include "hil/configuration/wheeled_vehicle.h"
#include "hil/world/shapes.h"
#include "sim/samples/vector3.h"

namespace rigwire::hil {

/// Topologies, one alternative each; numbers alone make a machine of one.
struct ExcavatorMachine {
  static constexpr fields::Named kNamed{"excavator", "Swing, boom, stick and bucket."};

  sim::ExcavatorParameters excavator;
  bool digs = true;  ///< Else the bucket passes through the ground.
  sim::DiggingParameters digging;
};
struct WheeledMachine {
  static constexpr fields::Named kNamed{
      "wheeled", "Two axles, beams or independent wheels, and a drive line."};

  sim::WheeledVehicleParameters wheeled;
  sim::DrivelineParameters driveline;
};
struct RollerMachine {
  static constexpr fields::Named kNamed{"tandem_roller", "Two drums, each on a pivot that steers."};

  sim::RollerParameters roller;
};

using MachineSettings = std::variant<ExcavatorMachine, WheeledMachine, RollerMachine>;

/// A shape fixed to a link.
struct LinkShape {
  std::string link = "upper";
  PlacedShape placed;
};

struct MachineConfiguration {
  std::string name = "machine";
  std::string text;  ///< One line for `rigwire list machines`.
  MachineSettings settings;
  Vector3 position_m;     ///< [east, north, up] of the origin of its first link.
  double yaw_rad = 0.0;   ///< Of its x from east, left positive.
  bool on_ground = true;  ///< position z counts from the terrain under it.
  std::vector<LinkShape> shapes;
};

/// Links that shapes and sensors can be fixed to, in the machine's order.
[[nodiscard]] std::span<const std::string_view> link_names(const MachineSettings& settings);

inline void visit(fields::Visitor& v, ExcavatorMachine& p) {
  v.section("excavator", p.excavator, "Masses, pins, cylinders, hydraulics, drives.");
  v.boolean("digs", p.digs, "Else the bucket passes through the ground.");
  v.section("digging", p.digging, "The bucket as a tool, and the ground's limits.");
}

inline void visit(fields::Visitor& v, WheeledMachine& p) {
  v.section("wheeled", p.wheeled, "Body, axles, tyres, steering, brakes.");
  v.section("driveline", p.driveline, "Engine to wheels.");
}

inline void visit(fields::Visitor& v, RollerMachine& p) {
  v.section("roller", p.roller, "Masses, drums, steering, drive, supplements.");
}

inline void visit(fields::Visitor& v, LinkShape& p) {
  v.text("link", p.link, "One of the machine's links.");
  visit(v, p.placed);
}

inline void visit(fields::Visitor& v, MachineConfiguration& p) {
  v.text("name", p.name, "For people.");
  v.text("text", p.text, "One line for `rigwire list machines`.");
  v.required("type");
  v.variant("type", p.settings, "Topology of the machine.");
  v.vector3("position", p.position_m, fields::in("m"), "[east, north, up] of its first link.");
  v.number("yaw", p.yaw_rad, fields::in("deg").between(-360, 360),
           "Of its x from east, left positive.");
  v.boolean("on_ground", p.on_ground, "Whether `up` counts from the terrain under it.");
  v.list("shapes", p.shapes, "What the lidar sees of it, by link.");
}

}  // namespace rigwire::hil
