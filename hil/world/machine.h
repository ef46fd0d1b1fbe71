// The machine of a rig: its topology and parameters, its pose, its looks. machine_types.h has the
// topologies; no code here depends on one of them.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "fields/chosen.h"
#include "hil/files/motion_file.h"
#include "hil/world/shapes.h"
#include "sim/samples/vector3.h"

namespace rigwire::sim {
class FallObstacle;
class Ground;
class Machine;
}  // namespace rigwire::sim

namespace rigwire::hil {

/// Where a machine is placed. Ground and obstacles must outlive it; it may dig in the ground.
struct MachineSite {
  sim::Ground& ground;
  const sim::FallObstacle& obstacles;
  Eigen::Isometry3d X_WB;  ///< Pose of the first link; a machine on wheels settles from there.
};

/// A topology with its numbers.
class MachineModel {
 public:
  virtual ~MachineModel() = default;

  /// Its keys. `type` is not among them.
  virtual void visit(fields::Visitor& v) = 0;
  /// Links that shapes and sensors can be fixed to, in the machine's order.
  [[nodiscard]] virtual std::span<const std::string_view> links() const = 0;
  /// Returns those links that stand on the ground.
  [[nodiscard]] virtual std::span<const std::string_view> standing_links() const = 0;
  /// Returns what its valve block moves, from section 0 on; empty without one.
  [[nodiscard]] virtual std::vector<std::string_view> actuators() const { return {}; }
  /// Returns whether it has a drive train.
  [[nodiscard]] virtual bool drives() const = 0;
  /// Returns whether it has pumps that an engine drives.
  [[nodiscard]] virtual bool has_power_unit() const = 0;
  /// Returns whether it has an engine whose torque moves it, or its pumps.
  [[nodiscard]] virtual bool has_engine() const = 0;
  /// Returns whether it digs, so that the terrain must be kept in a form that can change.
  [[nodiscard]] virtual bool changes_ground() const = 0;
  /// Returns gravity along world -z, for the inertial units.
  [[nodiscard]] virtual double gravity_mps2() const = 0;
  /// Throws std::invalid_argument for parameters that make no machine.
  [[nodiscard]] virtual std::unique_ptr<sim::Machine> make(const MachineSite& site) const = 0;

  [[nodiscard]] virtual std::unique_ptr<MachineModel> copy() const = 0;
};
void visit(fields::Visitor& v, MachineModel& p);

using MachineType = fields::TypeRow<MachineModel>;

/// Returns all topologies.
[[nodiscard]] std::span<const MachineType> machine_types();

/// A shape fixed to a link.
struct LinkShape {
  std::string link = "upper";
  PlacedShape placed;
};
void visit(fields::Visitor& v, LinkShape& p);

struct MachineConfiguration {
  std::string name = "machine";
  std::string text;  ///< One line for `rigwire list machines`.
  fields::Chosen<MachineModel> model{machine_types()};
  Vector3 position_m;     ///< [east, north, up] of the origin of its first link.
  double yaw_rad = 0.0;   ///< Angle of its x axis from east, left positive.
  bool on_ground = true;  ///< position z counts from the terrain under it.
  std::vector<LinkShape> shapes;
  MotionSettings motion;  ///< Recorded motion that the machine replays.
};
void visit(fields::Visitor& v, MachineConfiguration& p);

}  // namespace rigwire::hil
