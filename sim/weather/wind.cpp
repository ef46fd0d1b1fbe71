#include "sim/weather/wind.h"

#include <cmath>

namespace rigwire::sim {

Eigen::Vector2d wind_from(double speed_mps, double from_rad) {
  // Blows from there: minus the direction, clockwise from north.
  return {-speed_mps * std::sin(from_rad), -speed_mps * std::cos(from_rad)};
}

Wind::Wind(const WindParameters& parameters, std::uint64_t seed)
    : parameters_(parameters), stream_(seed, "weather/gusts") {
  gust_.x() = stream_.gaussian();
  gust_.y() = stream_.gaussian();
}

void Wind::advance(double step_s, const Eigen::Vector2d& mean_mps) {
  // Gauss-Markov, exact: e g + sqrt(1 - e^2) w, e = exp(-h / tau).
  const double keep = std::exp(-step_s / parameters_.gust_time_s);
  const double fresh = std::sqrt(1.0 - keep * keep);
  for (Eigen::Index i = 0; i < 2; ++i) {
    gust_(i) = keep * gust_(i) + fresh * stream_.gaussian();
  }
  velocity_mps_ = mean_mps + parameters_.gust_intensity * mean_mps.norm() * gust_;
}

}  // namespace rigwire::sim
