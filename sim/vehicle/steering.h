// From a commanded steering angle to two wheels: rate-limited lag, and Ackermann's geometry.
#pragma once

#include <array>

#include "sim/vehicle/parameters.h"

namespace rigwire::sim {

/// The angle follows its set point by angle' = (set point - angle) / time_constant, |angle'| at
/// most the rate. step() is the exact solution, so that dividing a step changes nothing beyond
/// rounding.
class SteeringActuator {
 public:
  explicit SteeringActuator(const SteeringParameters& parameters);

  /// Clamped to the greatest angle; not-a-number keeps the old set point.
  void command(double angle_rad);
  void step(double span_s);
  [[nodiscard]] double angle_rad() const { return angle_rad_; }

 private:
  SteeringParameters parameters_;
  double set_point_rad_ = 0.0;
  double angle_rad_ = 0.0;
};

/// Angles of the left and the right wheel of an axle so that all wheels turn about one centre:
/// tan(wheel) = tan(angle) / (1 -+ curvature track / 2). `curvature_1pm`: of the path of the point
/// where the turning centre's foot stands on the vehicle's long axis, (tan front - tan rear) over
/// wheelbase, left positive.
[[nodiscard]] std::array<double, 2> ackermann_rad(double angle_rad, double track_m,
                                                  double curvature_1pm);

}  // namespace rigwire::sim
