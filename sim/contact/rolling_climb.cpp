#include "sim/contact/rolling_climb.h"

namespace rigwire::sim {

bool climbs(const RollingClimb& climb, const Ground& ground, std::size_t obstacle,
            const Eigen::Vector3d& middle_W, const Eigen::Vector3d& up_W) {
  if (climb.radius_m <= 0.0) {
    return !ground.too_high(obstacle, middle_W);
  }
  const double height_m = climb.height_m(ground.obstacles()[obstacle].friction);
  return !ground.rises_above(obstacle, middle_W - (climb.radius_m - height_m) * up_W);
}

}  // namespace rigwire::sim
