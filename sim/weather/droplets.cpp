#include "sim/weather/droplets.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace rigwire::sim {
DropletOptics fog_optics(const FogParameters& parameters, double inverse_mor_pm) {
  // Rasshofer et al. 2011: alpha = ln 20 / MOR, beta in proportion to 1 / MOR.
  return {std::log(20.0) * inverse_mor_pm, parameters.backscatter * inverse_mor_pm};
}

DropletOptics haze_optics(const HazeParameters& parameters, double inverse_visibility_pm) {
  if (inverse_visibility_pm <= 0.0) {
    return {};
  }
  const double visibility_km = 1e-3 / inverse_visibility_pm;
  // Kruse et al. 1962: alpha = (3.912 / V) (wavelength / 550 nm)^-q.
  const double exponent =
      visibility_km > 50.0 ? 1.6 : (visibility_km > 6.0 ? 1.3 : 0.585 * std::cbrt(visibility_km));
  const double extinction_pm =
      3.912 * inverse_visibility_pm * std::pow(parameters.wavelength_m / 550e-9, -exponent);
  return {extinction_pm, extinction_pm / parameters.lidar_ratio_sr};
}

double fog_density(const FogParameters& parameters, double z_m) {
  if (parameters.scale_height_m <= 0.0 || z_m <= parameters.base_height_m) {
    return 1.0;
  }
  return std::exp(-(z_m - parameters.base_height_m) / parameters.scale_height_m);
}

double fog_path_m(const FogParameters& parameters, double z0_m, double climb, double length_m) {
  if (parameters.scale_height_m <= 0.0) {
    return length_m;
  }
  const double low_m = std::min(z0_m, z0_m + climb * length_m) - parameters.base_height_m;
  const double high_m = std::max(z0_m, z0_m + climb * length_m) - parameters.base_height_m;
  const double slope = std::abs(climb);
  if (high_m <= 0.0) {
    return length_m;
  }
  const double scale_m = parameters.scale_height_m;
  // Full below the base; above it the integral of exp(-z / H): (1 - exp(-f)) / f of the rest.
  const double below_m = low_m < 0.0 ? std::min(-low_m / slope, length_m) : 0.0;
  const double above_m = length_m - below_m;
  const double start = std::exp(-std::max(low_m, 0.0) / scale_m);
  const double fall = slope * above_m / scale_m;
  return below_m + start * above_m * (fall > 1e-9 ? -std::expm1(-fall) / fall : 1.0);
}

double ClutterCount::quantile_m(double share) const {
  const double count = share * expected();
  const auto after = std::ranges::upper_bound(up_to_, count);
  const auto i = static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(after - up_to_.begin(), 1, static_cast<std::ptrdiff_t>(kSteps)));
  const double step = up_to_[i] - up_to_[i - 1];
  const double part = step > 0.0 ? (count - up_to_[i - 1]) / step : 0.5;
  return range_m(i - 1) + std::clamp(part, 0.0, 1.0) * (range_m(i) - range_m(i - 1));
}

int poisson_quantile(double u, double expected) {
  int number = 0;
  double probability = std::exp(-expected);
  for (double sum = probability; u > sum && number < kMostClutter; sum += probability) {
    ++number;
    probability *= expected / number;
  }
  return number;
}

}  // namespace rigwire::sim
