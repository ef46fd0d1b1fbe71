#include "sim/odometry/dead_reckoning.h"

#include <cmath>

namespace rigwire::sim {

void DeadReckoning::advance(const OdometryReading& reading, double span_s) {
  const double cosine = std::cos(reading.slip_angle_rad);
  const double path_m = reading.speed_mps / cosine * span_s;
  const double turn_rad = reading.curvature_1pm * path_m;
  if (!(span_s > 0.0) || !std::isfinite(turn_rad) || !std::isfinite(path_m)) {
    return;
  }
  // Chord of an arc: length sin(x) / x of the path, x half the turn, along the mean direction.
  const double half = 0.5 * turn_rad;
  const double chord_m =
      path_m * (std::abs(half) > 1e-4 ? std::sin(half) / half : 1.0 - half * half / 6.0);
  const double direction = pose_.yaw_rad + reading.slip_angle_rad + half;
  pose_.x_m += chord_m * std::cos(direction);
  pose_.y_m += chord_m * std::sin(direction);
  pose_.yaw_rad += turn_rad;
  distance_m_ += std::abs(path_m);
}

}  // namespace rigwire::sim
