#include "sim/scene/open_ground.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "sim/random.h"
#include "sim/scene/noise_field.h"

namespace rigwire::sim {
namespace {

void require_within(double value, double lower, double upper, const std::string& member) {
  if (!(value >= lower && value <= upper)) {
    throw std::invalid_argument(member + " is " + std::to_string(value) + ", allowed: " +
                                std::to_string(lower) + " to " + std::to_string(upper));
  }
}

void require_grid(double size_m, double cell_m) {
  require_within(size_m, 10.0, 4000.0, "terrain.size_m");
  require_within(cell_m, 0.05, 0.1 * size_m, "terrain.cell_m");
  require_within(size_m / cell_m, 1.0, 8192.0, "terrain.size_m / terrain.cell_m");
}

void require_slope(const MeanSlope& slope) {
  require_within(slope.rise, -1.0, 1.0, "terrain.slope.rise");
  require_within(slope.uphill_rad, -2.0 * std::numbers::pi, 2.0 * std::numbers::pi,
                 "terrain.slope.uphill_rad");
  require_within(slope.height_at_0_m, -10000.0, 10000.0, "terrain.slope.height_at_0_m");
}

template <class Height>
HeightField make_field(double size_m, double cell_m, const Height& height) {
  HeightField field;
  field.cell_m = cell_m;
  field.columns = static_cast<std::size_t>(std::lround(size_m / cell_m)) + 1;
  field.rows = field.columns;
  const double half = 0.5 * cell_m * static_cast<double>(field.columns - 1);
  field.origin_m = {-half, -half};
  field.heights_m.reserve(field.columns * field.rows);
  for (std::size_t r = 0; r < field.rows; ++r) {
    for (std::size_t c = 0; c < field.columns; ++c) {
      field.heights_m.push_back(height(field.origin_m.x() + cell_m * static_cast<double>(c),
                                       field.origin_m.y() + cell_m * static_cast<double>(r)));
    }
  }
  return field;
}

/// Layers from the longest wave down to waves of two cells.
int octaves(double longest_m, double cell_m) {
  return std::clamp(1 + static_cast<int>(std::floor(std::log2(longest_m / (2.0 * cell_m)))), 1, 12);
}

}  // namespace

double MeanSlope::height_m(double x_m, double y_m) const {
  return height_at_0_m + rise * (std::cos(uphill_rad) * x_m + std::sin(uphill_rad) * y_m);
}

void validate(const HillsTerrain& terrain) {
  require_grid(terrain.size_m, terrain.cell_m);
  require_slope(terrain.slope);
  require_within(terrain.roughness_m, 0.0, 100.0, "terrain.roughness_m");
  require_within(terrain.longest_wave_m, 2.0 * terrain.cell_m, 10000.0, "terrain.longest_wave_m");
}

void validate(const LevelTerrain& terrain) {
  require_grid(terrain.size_m, terrain.cell_m);
  require_slope(terrain.slope);
  require_within(terrain.roughness_m, 0.0, 1.0, "terrain.roughness_m");
}

HeightField make_hills(const HillsTerrain& terrain, std::uint64_t seed) {
  validate(terrain);
  // Mean slope plus fractal roughness (noise_field.h).
  const NoiseField noise(RandomStream(seed, "scene/terrain").bits(), terrain.longest_wave_m,
                         octaves(terrain.longest_wave_m, terrain.cell_m));
  return make_field(terrain.size_m, terrain.cell_m, [&](double x, double y) {
    return terrain.slope.height_m(x, y) + terrain.roughness_m * noise.at(x, y);
  });
}

HeightField make_level(const LevelTerrain& terrain, std::uint64_t seed) {
  validate(terrain);
  const double longest_m = std::max(3.0, 2.0 * terrain.cell_m);
  const NoiseField noise(RandomStream(seed, "scene/terrain").bits(), longest_m,
                         octaves(longest_m, terrain.cell_m));
  return make_field(terrain.size_m, terrain.cell_m, [&](double x, double y) {
    return terrain.slope.height_m(x, y) + terrain.roughness_m * noise.at(x, y);
  });
}

}  // namespace rigwire::sim
