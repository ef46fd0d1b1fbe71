#include "sim/scene/noise_field.h"

#include <cmath>
#include <numbers>

namespace rigwire::sim {
namespace {

constexpr double kHurst = 0.8;
/// Standard deviation of one layer of unit-gradient noise in two dimensions, found numerically.
constexpr double kLayerDeviation = 0.25;

/// Gradient of a lattice corner, its angle by a hash of seed and place, times the way to it.
double corner(std::uint64_t seed, std::int64_t x, std::int64_t y, double dx, double dy) {
  std::uint64_t z = seed ^ (static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15ULL) ^
                    (static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4FULL);
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
  z ^= z >> 31U;
  const double angle = static_cast<double>(z >> 11U) * 0x1.0p-53 * 2.0 * std::numbers::pi;
  return dx * std::cos(angle) + dy * std::sin(angle);
}

/// Perlin 2002: 6 t^5 - 15 t^4 + 10 t^3, no second derivative at the corners.
double fade(double t) {
  return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

/// One layer of gradient noise: four corners, blended by fade.
double layer(std::uint64_t seed, double x, double y) {
  const double cell_x = std::floor(x);
  const double cell_y = std::floor(y);
  const auto i = static_cast<std::int64_t>(cell_x);
  const auto j = static_cast<std::int64_t>(cell_y);
  const double u = x - cell_x;
  const double v = y - cell_y;
  const double south =
      std::lerp(corner(seed, i, j, u, v), corner(seed, i + 1, j, u - 1.0, v), fade(u));
  const double north = std::lerp(corner(seed, i, j + 1, u, v - 1.0),
                                 corner(seed, i + 1, j + 1, u - 1.0, v - 1.0), fade(u));
  return std::lerp(south, north, fade(v));
}

}  // namespace

NoiseField::NoiseField(std::uint64_t seed, double longest_m, int octaves)
    : seed_(seed), frequency_(1.0 / longest_m), octaves_(octaves), scale_(0.0) {
  double variance = 0.0;
  for (int octave = 0; octave < octaves; ++octave) {
    // Layers are independent, their variances add; each has 2^-H of the last one's height.
    variance += std::pow(2.0, -2.0 * kHurst * octave);
  }
  scale_ = 1.0 / (kLayerDeviation * std::sqrt(variance));
}

double NoiseField::at(double x_m, double y_m) const {
  double sum = 0.0;
  double height = 1.0;
  double frequency = frequency_;
  for (int octave = 0; octave < octaves_; ++octave) {
    sum += height *
           layer(seed_ + static_cast<std::uint64_t>(octave), x_m * frequency, y_m * frequency);
    height *= std::exp2(-kHurst);
    frequency *= 2.0;
  }
  return sum * scale_;
}

}  // namespace rigwire::sim
