#include "sim/scene/open_ground.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "fields/check.h"
#include "fields/visitor.h"
#include "sim/random.h"
#include "sim/scene/noise_field.h"
#include "sim/scene/range_checks.h"

namespace rigwire::sim {

using fields::in;
using fields::plain;

namespace {

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

void visit(fields::Visitor& v, MeanSlope& p) {
  v.number("rise", p.rise, plain().between(-1, 1), "Rise over run of the mean slope.");
  v.number("uphill", p.uphill_rad, in("deg").between(-360, 360),
           "Direction in which it rises, left from east.");
  v.number("height_at_0", p.height_at_0_m, in("m").between(-10'000, 10'000), "Height at (0, 0).");
}

void visit(fields::Visitor& v, HillsTerrain& p) {
  v.number("size", p.size_m, in("m").between(10, 4000), "Edge of the square area around (0, 0).");
  v.number("cell", p.cell_m, in("m").between(0.05, 400), "Distance between two heights.");
  v.section("slope", p.slope, "Mean slope of the ground.");
  v.number("roughness", p.roughness_m, in("m").between(0, 100),
           "Standard deviation of the heights.");
  v.number("longest_wave", p.longest_wave_m, in("m").between(0.1, 10'000),
           "Wave length of the coarsest layer of noise, two cells or more.");
  v.section("material", p.material, "Surface of the ground.");
}

void visit(fields::Visitor& v, LevelTerrain& p) {
  v.number("size", p.size_m, in("m").between(10, 4000), "Edge of the square area around (0, 0).");
  v.number("cell", p.cell_m, in("m").between(0.05, 400), "Distance between two heights.");
  v.section("slope", p.slope, "Crossfall of the site.");
  v.number("roughness", p.roughness_m, in("mm").between(0, 1000),
           "Standard deviation of the heights.");
  v.section("material", p.material, "Surface of the ground.");
}

void validate(const HillsTerrain& terrain) {
  fields::check(terrain);
  require_grid(terrain.size_m, terrain.cell_m);
  require_within(terrain.longest_wave_m, 2.0 * terrain.cell_m, 10'000.0, "m", "longest_wave",
                 "two cells or more");
}

void validate(const LevelTerrain& terrain) {
  fields::check(terrain);
  require_grid(terrain.size_m, terrain.cell_m);
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
