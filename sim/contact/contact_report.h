// What a machine tells of its contacts with solid things, for truth tap, status and report.
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
  bool down = false;  ///< Beyond what it bears: falls, and is met no more ...
  bool lies = false;
  bool solid = false;  ///< ... until it lies clear of the machine (Ground::lay()).

  /// From where it stood to where it is.
  [[nodiscard]] Eigen::Isometry3d motion_W(const Eigen::Vector3d& foot_W) const {
    return Eigen::Translation3d(foot_W) * Eigen::AngleAxisd(angle_rad, axis_W) *
           Eigen::Translation3d(-foot_W);
  }
};

/// What a machine feels of solid things: of the last step, and since the start.
struct ContactReport {
  std::size_t points = 0;               ///< That push.
  double force_n = 0.0;                 ///< Magnitude of the sum on the machine.
  std::string_view body;                ///< Of the point that pushes most; empty: none.
  std::optional<std::size_t> obstacle;  ///< That it meets; nothing: one of the next two.
  std::optional<std::size_t> mover;
  bool terrain = false;
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();      ///< Of that point.
  Eigen::Vector3d force_W = Eigen::Vector3d::Zero();  ///< Sum, on the machine.
  double deepest_m = 0.0;  ///< Overlap, beyond dents and what a tree bends; of no tyre.
  double pressed_m = 0.0;  ///< The most that a tyre is pressed in.
  double dent_m = 0.0;     ///< The deepest that anything of the machine is bent in for good.
  double sunk_m = 0.0;     ///< The deepest that a body which pushes the terrain has pressed it in.
  double lost_j = 0.0;     ///< Since the start, turned into heat and broken wood.
  double deepest_ever_m = 0.0;
  std::uint64_t touches = 0;  ///< Pairs that began to push, since the start.
  std::uint32_t felled = 0;   ///< Obstacles that gave way altogether.
};

}  // namespace rigwire::sim
