// Queries of a scene by a satellite signal: obstacles on its path to an antenna.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace rigwire::sim {

/// The way from the antenna to the sky.
struct SkyPath {
  bool blocked = false;    ///< Something solid is in it.
  double foliage_m = 0.0;  ///< Length within tree crowns, up to what blocks.
};

/// A solid surface that may mirror a signal.
struct ReflectingSurface {
  double range_m = 0.0;
  Eigen::Vector3d normal_W = Eigen::Vector3d::UnitZ();  ///< Unit, towards the ray's start.
};

class Visibility {
 public:
  virtual ~Visibility() = default;
  /// Returns whether anything of the scene intersects the ray from `p_W` (m, world) along the unit
  /// vector `direction_W`, farther than `clearance_m` away.
  [[nodiscard]] virtual bool blocked(const Eigen::Vector3d& p_W, const Eigen::Vector3d& direction_W,
                                     double clearance_m) const = 0;
  /// Returns whether the ray is blocked, and measures the tree crowns on it, which do not block. A
  /// scene without foliage gives the result of blocked().
  [[nodiscard]] virtual SkyPath sky_path(const Eigen::Vector3d& p_W,
                                         const Eigen::Vector3d& direction_W,
                                         double clearance_m) const {
    return {blocked(p_W, direction_W, clearance_m), 0.0};
  }
  /// The first solid surface (no foliage) on the ray between clearance and `reach_m`.
  [[nodiscard]] virtual std::optional<ReflectingSurface> surface(
      const Eigen::Vector3d& /*p_W*/, const Eigen::Vector3d& /*direction_W*/,
      double /*clearance_m*/, double /*reach_m*/) const {
    return std::nullopt;
  }
};

}  // namespace rigwire::sim
