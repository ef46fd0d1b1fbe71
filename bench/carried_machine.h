// A rig's machine carried along the first closed track of its scene at constant speed, its links
// fixed as at the start: its own body is in view of its sensors, and nothing has to be driven.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "hil/rig/rig_configuration.h"
#include "hil/world/simulated_world.h"
#include "sim/link_motion.h"
#include "sim/scene/track.h"

namespace rigwire::bench {

/// Throws std::invalid_argument when the scene has none.
[[nodiscard]] const sim::Track& closed_track(const hil::RigConfiguration& rig);

class CarriedMachine {
 public:
  /// Throws std::invalid_argument without a closed track, or when the speed is not above 0.
  CarriedMachine(const hil::RigConfiguration& rig, double speed_mps);

  [[nodiscard]] double length_m() const { return line_.length_m; }
  /// Moves the machine to that place of the track, at `time`; the scene is ready then. Times rise.
  void place(SimTime time, double along_m);
  [[nodiscard]] const sim::Scene& scene() const { return *built_.scene; }
  [[nodiscard]] sim::LinkMotion motion(const hil::SensorMount& mount) const;

 private:
  [[nodiscard]] Eigen::Vector2d point(double along_m) const;

  sim::TrackLine line_;
  double speed_mps_;
  hil::MachineInScene built_;
  Eigen::Isometry3d X_start_;
  double height_m_;  ///< Height of the first link above the ground.
  Eigen::Isometry3d moved_ = Eigen::Isometry3d::Identity();
  Eigen::Vector3d ahead_W_ = Eigen::Vector3d::UnitX();
  std::vector<sim::BodyMotion> bodies_;
};

}  // namespace rigwire::bench
