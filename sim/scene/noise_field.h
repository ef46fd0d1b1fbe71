// Fractal roughness of natural ground.
#pragma once

#include <cstdint>

namespace rigwire::sim {

/// Fractional Brownian motion: `octaves` layers of gradient noise (Perlin, "Improving noise",
/// SIGGRAPH 2002), each twice as fine and 2^-H as high as the last, H = 0.8 (weathered rock and
/// soil). Standard deviation about 1, mean 0, no repetition within 2^31 cells.
class NoiseField {
 public:
  /// `longest_m` is the wave length of the coarsest layer.
  NoiseField(std::uint64_t seed, double longest_m, int octaves);
  [[nodiscard]] double at(double x_m, double y_m) const;

 private:
  std::uint64_t seed_;
  double frequency_;
  int octaves_;
  double scale_;
};

}  // namespace rigwire::sim
