#include <algorithm>
#include <cmath>

#include "fields/constants.h"
#include "sim/scene/noise_field.h"
#include "sim/scene/scene_description.h"

namespace rigwire::sim {
namespace {

/// Side slope of the cut through which the ramp runs.
constexpr double kCutSlope = 1.7;
/// Half width of a windrow's foot.
constexpr double kWindrowHalfWidth_m = 1.2;

struct Shape {
  double height_m = 0.0;
  double roughness_m = 0.0;
};

/// Distance outside the floor's rounded rectangle; negative inside.
double outside_floor(const PitTerrain& pit, double x, double y) {
  constexpr double kCorner_m = 8.0;
  // Signed distance of a rectangle with rounded corners.
  const double dx = std::abs(x - pit.floor_centre_m.x()) - pit.floor_half_lengths_m.x() + kCorner_m;
  const double dy = std::abs(y - pit.floor_centre_m.y()) - pit.floor_half_lengths_m.y() + kCorner_m;
  return std::hypot(std::max(dx, 0.0), std::max(dy, 0.0)) + std::min(std::max(dx, dy), 0.0) -
         kCorner_m;
}

/// Faces and berms as a function of the distance from the floor.
Shape benches(const PitTerrain& pit, double distance) {
  if (distance <= 0.0) {
    return {0.0, pit.floor_roughness_m};
  }
  const double run = pit.bench_height_m / std::tan(pit.face_angle_deg * kDegree);
  const double pitch = run + pit.berm_width_m;
  const double level = std::floor(distance / pitch);
  if (level >= pit.benches) {
    return {pit.benches * pit.bench_height_m, pit.face_roughness_m};
  }
  const double within = distance - level * pitch;
  Shape shape{level * pit.bench_height_m + std::min(within / run, 1.0) * pit.bench_height_m,
              pit.face_roughness_m * std::min(1.0, distance)};
  // Windrow on the berm's edge, a triangle across.
  const double from_ridge = std::abs(within - run - kWindrowHalfWidth_m);
  shape.height_m += pit.windrow_height_m * std::max(0.0, 1.0 - from_ridge / kWindrowHalfWidth_m);
  return shape;
}

Shape pit_shape(const PitTerrain& pit, double x, double y) {
  Shape shape = benches(pit, outside_floor(pit, x, y));
  const double beside = std::abs(y - pit.ramp_y_m) - 0.5 * pit.ramp_width_m;
  const double ramp =
      pit.ramp_slope * std::max(0.0, pit.ramp_start_x_m - x) + kCutSlope * std::max(0.0, beside);
  if (x < pit.ramp_start_x_m && ramp < shape.height_m) {
    shape = {ramp, beside > 0.0 ? pit.face_roughness_m : pit.floor_roughness_m};
  }
  for (const Heap& heap : pit.heaps) {
    // Heap: a cone at its angle of repose.
    const double away = std::hypot(x - heap.centre_m.x(), y - heap.centre_m.y());
    const double cone = heap.height_m - away * std::tan(heap.repose_deg * kDegree);
    shape.height_m = std::max(shape.height_m, cone);
  }
  return shape;
}

}  // namespace

HeightField make_pit(const PitTerrain& terrain, std::uint64_t seed) {
  validate(terrain);
  HeightField field;
  field.cell_m = terrain.cell_m;
  field.columns = static_cast<std::size_t>(std::lround(terrain.size_m / terrain.cell_m)) + 1;
  field.rows = field.columns;
  const double half = 0.5 * terrain.cell_m * static_cast<double>(field.columns - 1);
  field.origin_m = {-half, -half};
  field.heights_m.reserve(field.columns * field.rows);
  constexpr double kLongestWave_m = 12.0;
  constexpr int kOctaves = 6;
  const NoiseField noise(RandomStream(seed, "scene/terrain").bits(), kLongestWave_m, kOctaves);
  for (std::size_t r = 0; r < field.rows; ++r) {
    for (std::size_t c = 0; c < field.columns; ++c) {
      const double x = field.origin_m.x() + field.cell_m * static_cast<double>(c);
      const double y = field.origin_m.y() + field.cell_m * static_cast<double>(r);
      const Shape shape = pit_shape(terrain, x, y);
      field.heights_m.push_back(terrain.floor_height_m + shape.height_m +
                                shape.roughness_m * noise.at(x, y));
    }
  }
  return field;
}

}  // namespace rigwire::sim
