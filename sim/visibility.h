// Whether the sky can be seen: the one question that satellite visibility asks of a scene.
#pragma once

#include <Eigen/Core>

namespace rigwire::sim {

class Visibility {
 public:
  virtual ~Visibility() = default;
  /// True when anything of the scene stands on the ray from `p_W` (m, world) along the unit vector
  /// `direction_W`, farther than `clearance_m` away.
  [[nodiscard]] virtual bool blocked(const Eigen::Vector3d& p_W, const Eigen::Vector3d& direction_W,
                                     double clearance_m) const = 0;
};

}  // namespace rigwire::sim
