#include "sim/roller/steering.h"

#include <algorithm>
#include <cmath>

#include "sim/roller/require.h"

namespace rigwire::sim {

void validate(const PivotSteeringParameters& p, const char* where) {
  require_number(p.angle_max_rad > 0.0 && p.angle_max_rad < 1.5, where, "angle_max_rad",
                 p.angle_max_rad, "> 0 and < 1.5 rad");
  require_positive(where, "rate_max_radps", p.rate_max_radps);
  require_not_negative(where, "time_constant_s", p.time_constant_s);
}

void PivotSteering::command(double angle_rad) {
  if (std::isfinite(angle_rad)) {
    set_point_rad_ = std::clamp(angle_rad, -parameters_.angle_max_rad, parameters_.angle_max_rad);
  }
}

double PivotSteering::present_rate_radps() const {
  const double error = set_point_rad_ - angle_rad_;
  if (error == 0.0) {
    return 0.0;
  }
  const double limit = parameters_.rate_max_radps;
  return parameters_.time_constant_s > 0.0
             ? std::clamp(error / parameters_.time_constant_s, -limit, limit)
             : std::copysign(limit, error);
}

void PivotSteering::step(double h) {
  const double before = angle_rad_;
  const double error = set_point_rad_ - angle_rad_;
  if (error == 0.0 && rate_radps_ == 0.0) {
    acceleration_radps2_ = 0.0;
    mean_rate_radps_ = 0.0;
    return;
  }
  const double side = error < 0.0 ? -1.0 : 1.0;
  // At the rate limit until |error| = rate x time constant, exponentially from there: exact.
  const double near = parameters_.rate_max_radps * parameters_.time_constant_s;
  const double linear_s = std::max(0.0, (std::abs(error) - near) / parameters_.rate_max_radps);
  if (linear_s >= h) {
    angle_rad_ += side * parameters_.rate_max_radps * h;
    rate_radps_ = side * parameters_.rate_max_radps;
    acceleration_radps2_ = 0.0;
  } else if (parameters_.time_constant_s > 0.0) {
    const double left =
        std::min(std::abs(error), near) * std::exp(-(h - linear_s) / parameters_.time_constant_s);
    angle_rad_ = set_point_rad_ - side * left;
    rate_radps_ = side * left / parameters_.time_constant_s;
    acceleration_radps2_ = -rate_radps_ / parameters_.time_constant_s;
    if (left < 1e-12) {
      angle_rad_ = set_point_rad_;
      rate_radps_ = 0.0;
      acceleration_radps2_ = 0.0;
    }
  } else {
    angle_rad_ = set_point_rad_;
    rate_radps_ = 0.0;
    acceleration_radps2_ = 0.0;
  }
  mean_rate_radps_ = (angle_rad_ - before) / h;
}

}  // namespace rigwire::sim
