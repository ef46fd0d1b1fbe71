#include "sim/roller/steering.h"

#include <algorithm>
#include <cmath>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;

void visit(fields::Visitor& v, PivotSteeringParameters& p) {
  v.number("angle_max", p.angle_max_rad, in("deg").between(0.01, 85.9),
           "Angle of the stops on both sides.");
  v.number("rate_max", p.rate_max_radps, in("deg/s").between(0.01, 10'000),
           "Greatest rate of each pivot.");
  v.number("time_constant", p.time_constant_s, in("ms").between(0, 1e6),
           "Lag of a pivot near its set point; 0 = none.");
}

void validate(const PivotSteeringParameters& p) {
  fields::check(p);
}

void PivotSteering::command(double angle_rad) {
  if (std::isfinite(angle_rad)) {
    set_point_rad_ = std::clamp(angle_rad, -parameters_.angle_max_rad, parameters_.angle_max_rad);
  }
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
