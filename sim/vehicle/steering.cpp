#include "sim/vehicle/steering.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {

SteeringActuator::SteeringActuator(const SteeringParameters& parameters)
    : parameters_(parameters) {}

void SteeringActuator::command(double angle_rad) {
  if (!std::isnan(angle_rad)) {
    set_point_rad_ = std::clamp(angle_rad, -parameters_.angle_max_rad, parameters_.angle_max_rad);
  }
}

void SteeringActuator::step(double span_s) {
  const double error = set_point_rad_ - angle_rad_;
  // At full rate while |error| > rate x time constant, then exp(-t / time constant): exact.
  const double knee = parameters_.rate_max_radps * parameters_.time_constant_s;
  double left_s = span_s;
  double rest = std::abs(error);
  if (rest > knee) {
    const double ramp_s = std::min(left_s, (rest - knee) / parameters_.rate_max_radps);
    rest -= parameters_.rate_max_radps * ramp_s;
    left_s -= ramp_s;
  }
  if (left_s > 0.0) {
    rest *=
        parameters_.time_constant_s > 0.0 ? std::exp(-left_s / parameters_.time_constant_s) : 0.0;
  }
  angle_rad_ = set_point_rad_ - std::copysign(rest, error);
}

std::array<double, 2> ackermann_rad(double angle_rad, double track_m, double curvature_1pm) {
  // Ackermann: tan(wheel) = tan(angle) / (1 -+ curvature track / 2).
  const double tangent = std::tan(angle_rad);
  const double part = 0.5 * track_m * curvature_1pm;
  return {std::atan(tangent / (1.0 - part)), std::atan(tangent / (1.0 + part))};
}

}  // namespace rigwire::sim
