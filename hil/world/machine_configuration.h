// The machine of a rig: which kind, its parameters, where it stands, what it looks like.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "fields/rules.h"
#include "hil/world/shapes.h"
#include "sim/driveline/parameters.h"
#include "sim/excavator/bucket_soil_parameters.h"
#include "sim/excavator/parameters.h"
#include "sim/roller/parameters.h"
#include "sim/samples/vector3.h"
#include "sim/vehicle/parameters.h"

namespace rigwire::hil {

/// Topologies, one alternative each; numbers alone make a machine of one.
struct ExcavatorMachine {
  static constexpr fields::Named kNamed{"excavator", "Swing, boom, stick and bucket."};

  sim::ExcavatorParameters excavator;
  bool digs = true;  ///< Else the bucket passes through the ground.
  sim::DiggingParameters digging;
};
void visit(fields::Visitor& v, ExcavatorMachine& p);

struct WheeledMachine {
  static constexpr fields::Named kNamed{
      "wheeled", "Two axles, beams or independent wheels, and a drive line."};

  sim::WheeledVehicleParameters wheeled;
  sim::DrivelineParameters driveline;
};
void visit(fields::Visitor& v, WheeledMachine& p);

struct RollerMachine {
  static constexpr fields::Named kNamed{"tandem_roller", "Two drums, each on a pivot that steers."};

  sim::RollerParameters roller;
};
void visit(fields::Visitor& v, RollerMachine& p);

using MachineSettings = std::variant<ExcavatorMachine, WheeledMachine, RollerMachine>;

/// A shape fixed to a link.
struct LinkShape {
  std::string link = "upper";
  PlacedShape placed;
};
void visit(fields::Visitor& v, LinkShape& p);

struct MachineConfiguration {
  std::string name = "machine";
  std::string text;  ///< One line for `rigwire list machines`.
  MachineSettings settings;
  Vector3 position_m;     ///< [east, north, up] of the origin of its first link.
  double yaw_rad = 0.0;   ///< Of its x from east, left positive.
  bool on_ground = true;  ///< position z counts from the terrain under it.
  std::vector<LinkShape> shapes;
};
void visit(fields::Visitor& v, MachineConfiguration& p);

/// Links that shapes and sensors can be fixed to, in the machine's order.
[[nodiscard]] std::span<const std::string_view> link_names(const MachineSettings& settings);

}  // namespace rigwire::hil
