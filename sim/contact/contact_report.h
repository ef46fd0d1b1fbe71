// A machine's report of its contacts with solid things, for truth tap, status and report.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace rigwire::sim {

/// An obstacle that has given way: it leans about its foot, falls, lies, and is solid again where
/// it lies as soon as nothing of the machine is where it fell.
struct LeaningObstacle {
  std::size_t obstacle = 0;
  double angle_rad = 0.0;
  Eigen::Vector3d axis_W = Eigen::Vector3d::UnitX();  ///< About which it leans, level.
  double rate_radps = 0.0;
  bool down = false;  ///< No strength left: it falls without contact ...
  bool lies = false;
  bool solid = false;  ///< ... until it lies clear of the machine (Ground::lay()).

  /// Motion from its pose at the start to its pose now.
  [[nodiscard]] Eigen::Isometry3d motion_W(const Eigen::Vector3d& foot_W) const {
    return Eigen::Translation3d(foot_W) * Eigen::AngleAxisd(angle_rad, axis_W) *
           Eigen::Translation3d(-foot_W);
  }
};

/// Contacts of a machine with solid things, in the last step and since the start.
struct ContactReport {
  std::size_t points = 0;               ///< Number of contact points that push.
  double force_n = 0.0;                 ///< Magnitude of the sum on the machine.
  std::string_view body;                ///< Body of the point that pushes most; empty: none.
  std::optional<std::size_t> obstacle;  ///< Obstacle at that point; empty: mover or terrain.
  std::optional<std::size_t> mover;
  bool terrain = false;
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();      ///< Position of that point.
  Eigen::Vector3d force_W = Eigen::Vector3d::Zero();  ///< Sum on the machine.
  double deepest_m = 0.0;  ///< Overlap of rigid bodies, without dents and the bending of trees.
  double pressed_m = 0.0;  ///< Compression of the tyre that is pressed in most.
  double dent_m = 0.0;     ///< Depth of the machine's deepest permanent dent.
  /// Maximum depth to which a body that pushes the terrain has pressed it in.
  double sunk_m = 0.0;
  double lost_j = 0.0;  ///< Energy lost since the start as heat and in broken wood.
  double deepest_ever_m = 0.0;
  std::uint64_t touches = 0;  ///< Number of times that a pair began to push, since the start.
  std::uint32_t felled = 0;   ///< Obstacles that have been felled.
};

}  // namespace rigwire::sim
