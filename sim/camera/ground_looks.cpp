#include "sim/camera/ground_looks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace rigwire::sim {
namespace {

/// Of steepness, either way of where a slope is bare, in shares of that.
constexpr float kRaggedSlope = 0.25F;

/// Two slopes beside each other.
using Four = float __attribute__((vector_size(16)));

/// A value in [-1, 1) that wavers over the plane: one octave of value noise.
float waver(float x, float y, std::uint32_t seed) {
  const float fx = std::floor(x);
  const float fy = std::floor(y);
  const auto value = [&](float dx, float dy) {
    const auto ix = static_cast<std::uint32_t>(static_cast<std::int32_t>(fx + dx));
    const auto iy = static_cast<std::uint32_t>(static_cast<std::int32_t>(fy + dy));
    std::uint32_t mixed = ix * 0x9E3779B1U ^ iy * 0x85EBCA77U ^ seed;
    mixed ^= mixed >> 15U;
    mixed *= 0x2C1B3C6DU;
    mixed ^= mixed >> 13U;
    return static_cast<float>(static_cast<std::int32_t>(mixed * 0x297A2D39U)) * 0x1.0p-31F;
  };
  const float a = x - fx;
  const float b = y - fy;
  const float u = a * a * (3.0F - 2.0F * a);
  const float v = b * b * (3.0F - 2.0F * b);
  return (1.0F - v) * ((1.0F - u) * value(0.0F, 0.0F) + u * value(1.0F, 0.0F)) +
         v * ((1.0F - u) * value(0.0F, 1.0F) + u * value(1.0F, 1.0F));
}

/// What wavers ends at the pixel as grain does.
float fading(float cell_m, float footprint_m) {
  return std::clamp(cell_m / footprint_m * (1.0F / 1.5F) - 0.5F, 0.0F, 1.0F);
}

}  // namespace

void GroundLooks::prepare(const Scene::Internals& scene, const Scene::Internals::Terrain& terrain) {
  const HeightField& field = terrain.field;
  cover_ = terrain.cover.get();
  of_label.clear();
  offset_m_ = (scene.origin_W.head<2>() - field.origin_m).cast<float>();
  per_m_ = static_cast<float>(1.0 / field.cell_m);
  columns_ = static_cast<int>(field.columns);
  rows_ = static_cast<int>(field.rows);
  if (scene_.lock() != scene.identity || instance_ != terrain.instance ||
      updates_ != terrain.updates) {
    scene_ = scene.identity;
    instance_ = terrain.instance;
    updates_ = terrain.updates;
    find_slopes(field);
  }
}

/// Central differences; of one side at the edges.
void GroundLooks::find_slopes(const HeightField& field) {
  nodes_.resize(field.columns * field.rows);
  const auto columns = static_cast<std::ptrdiff_t>(field.columns);
  const double per_two = 0.5 / field.cell_m;
  for (std::size_t r = 0; r < field.rows; ++r) {
    const std::size_t south = r == 0 ? 0 : r - 1;
    const std::size_t north = std::min(r + 1, field.rows - 1);
    const double per_row = 1.0 / (field.cell_m * static_cast<double>(north - south));
    const double* const here = &field.heights_m[r * field.columns];
    const double* const below = &field.heights_m[south * field.columns];
    const double* const above = &field.heights_m[north * field.columns];
    Slopes* const to = &nodes_[r * field.columns];
    const auto slopes = [&](std::ptrdiff_t c, std::ptrdiff_t west, std::ptrdiff_t east,
                            double per) {
      to[c] = {static_cast<float>((here[east] - here[west]) * per),
               static_cast<float>((above[c] - below[c]) * per_row)};
    };
    for (std::ptrdiff_t c = 1; c + 1 < columns; ++c) {
      slopes(c, c - 1, c + 1, per_two);
    }
    slopes(0, 0, 1, 2.0 * per_two);
    slopes(columns - 1, columns - 2, columns - 1, 2.0 * per_two);
  }
}

std::size_t GroundLooks::cell(float x, float y) const {
  return static_cast<std::size_t>(std::clamp(static_cast<int>(y), 0, rows_ - 2)) *
             static_cast<std::size_t>(columns_ - 1) +
         static_cast<std::size_t>(std::clamp(static_cast<int>(x), 0, columns_ - 2));
}

/// The cell whose soil lies at a place near which soils meet: their edge wavers.
std::size_t GroundLooks::cell_beyond_edges(float place_x, float place_y, float footprint_m,
                                           const PreparedLook* looks) const {
  constexpr float kCoarse_m = 0.9F;
  constexpr float kFine_m = 0.16F;
  Eigen::Vector2f at(place_x, place_y);
  const Eigen::Vector2f world = at / per_m_;
  // Hard surfaces are laid along a line.
  constexpr auto kReach = static_cast<float>(Scene::Internals::kCoverReach);
  bool laid = false;
  for (const float dx : {-kReach, 0.0F, kReach}) {
    for (const float dy : {-kReach, 0.0F, kReach}) {
      laid = laid ||
             looks[of_label[cover_->cells[cell(at.x() + dx, at.y() + dy)]]].shade.bare_from == 0.0F;
    }
  }
  const float coarse = (laid ? 0.04F : 0.25F) * fading(kCoarse_m, footprint_m);
  const float fine = (laid ? 0.03F : 0.07F) * fading(kFine_m, footprint_m);
  const Eigen::Vector2f aside(coarse * waver(world.x() / kCoarse_m, world.y() / kCoarse_m, 1U) +
                                  fine * waver(world.x() / kFine_m, world.y() / kFine_m, 2U),
                              coarse * waver(world.x() / kCoarse_m, world.y() / kCoarse_m, 3U) +
                                  fine * waver(world.x() / kFine_m, world.y() / kFine_m, 4U));
  at += aside * per_m_;
  // The one of the four nearest cells that weighs most here.
  const float x = at.x() - 0.5F;
  const float y = at.y() - 0.5F;
  const float a = x - std::floor(x);
  const float b = y - std::floor(y);
  const std::array<std::size_t, 4> corner{
      cell(std::floor(x), std::floor(y)), cell(std::floor(x) + 1.0F, std::floor(y)),
      cell(std::floor(x), std::floor(y) + 1.0F), cell(std::floor(x) + 1.0F, std::floor(y) + 1.0F)};
  const std::array<float, 4> weight{(1.0F - a) * (1.0F - b), a * (1.0F - b), (1.0F - a) * b, a * b};
  float most = 0.0F;
  std::size_t here = corner[0];
  for (std::size_t i = 0; i < 4; ++i) {
    float sum = 0.0F;
    for (std::size_t k = 0; k < 4; ++k) {
      sum += cover_->cells[corner[k]] == cover_->cells[corner[i]] ? weight[k] : 0.0F;
    }
    if (sum > most) {
      most = sum;
      here = corner[i];
    }
  }
  return here;
}

RIGWIRE_WIDE_VECTORS void GroundLooks::find(const std::array<int, kLanes>& mine,
                                            const RTCRay8& rays, const LaneArray& pixel_rad,
                                            const PreparedLook* looks, MetSurfaces& met,
                                            LookLanes& look) const {
  LaneArray place_x, place_y, a, b, slope_x, slope_y, steep;  // squared
  alignas(32) std::array<int, kLanes> column;
  alignas(32) std::array<int, kLanes> row;
  const float offset_x = offset_m_.x();
  const float offset_y = offset_m_.y();
  const float last_x = static_cast<float>(columns_ - 1) * 0.999999F;
  const float last_y = static_cast<float>(rows_ - 1) * 0.999999F;
  const int last_column = columns_ - 2;
  const int last_row = rows_ - 2;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    place_x[i] = (met.x[i] + offset_x) * per_m_;
    place_y[i] = (met.y[i] + offset_y) * per_m_;
    float x = choose(place_x[i] > 0.0F, place_x[i], 0.0F);
    float y = choose(place_y[i] > 0.0F, place_y[i], 0.0F);
    x = x < last_x ? x : last_x;
    y = y < last_y ? y : last_y;
    const int c = static_cast<int>(x);
    const int r = static_cast<int>(y);
    column[i] = c < last_column ? c : last_column;
    row[i] = r < last_row ? r : last_row;
    a[i] = x - static_cast<float>(column[i]);
    b[i] = y - static_cast<float>(row[i]);
  }
  // Between the two nodes on either side, whose slopes lie beside each other.
  for (std::size_t i = 0; i < kLanes; ++i) {
    Four south, north;
    std::memcpy(&south, nodes_.data() + row[i] * columns_ + column[i], sizeof(Four));
    std::memcpy(&north, nodes_.data() + (row[i] + 1) * columns_ + column[i], sizeof(Four));
    const Four between = south + b[i] * (north - south);
    const Four east = __builtin_shufflevector(between, between, 2, 3, 2, 3);
    const Four here = between + a[i] * (east - between);
    slope_x[i] = here[0];
    slope_y[i] = here[1];
  }
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float square = slope_x[i] * slope_x[i] + slope_y[i] * slope_y[i];
    steep[i] = square;
    const float size = 1.0F / std::sqrt(1.0F + square);
    const float side = met.gz[i] < 0.0F ? -size : size;
    met.nx[i] = mine[i] != 0 ? -slope_x[i] * side : met.nx[i];
    met.ny[i] = mine[i] != 0 ? -slope_y[i] * side : met.ny[i];
    met.nz[i] = mine[i] != 0 ? side : met.nz[i];
  }
  // Ground lies flatter than the ray mostly: a pixel is as long there as the slant makes it.
  const auto footprint_m = [&](std::size_t i) {
    const float cosine = std::max(std::abs(rays.dir_z[i]), 0.05F);
    return rays.tfar[i] * pixel_rad[i] / std::sqrt(cosine) + 1e-6F;
  };
  // Mostly there is one soil, and nothing is steep.
  alignas(32) std::array<std::uint32_t, kLanes> cells;
  std::uint32_t common = own;
  unsigned differ = 0;
  if (cover_ != nullptr) {
    const auto across = static_cast<std::uint32_t>(columns_ - 1);
    for (std::size_t i = 0; i < kLanes; ++i) {
      cells[i] =
          static_cast<std::uint32_t>(row[i]) * across + static_cast<std::uint32_t>(column[i]);
    }
    const std::uint8_t* const labels = cover_->cells.data();
    const std::uint8_t* const edges = cover_->near_edge.data();
    const unsigned first = labels[cells[0]];
    for (const std::uint32_t of : cells) {
      differ |= (labels[of] ^ first) | edges[of];
    }
    common = of_label[first];
  }
  if (differ == 0) {
    const float bare_from = looks[common].shade.bare_from;
    const float begin = bare_from > 0.0F ? (1.0F - kRaggedSlope) * bare_from : 1e18F;
    int somewhere = 0;
    for (std::size_t i = 0; i < kLanes; ++i) {
      look[i] = choose(mine[i] != 0, common, look[i]);
      somewhere |= steep[i] > begin * begin ? mine[i] : 0;
    }
    if (somewhere == 0) {
      return;
    }
  }
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (mine[i] == 0) {
      continue;
    }
    std::uint32_t here = own;
    if (cover_ != nullptr) {
      std::size_t of = cells[i];
      if (cover_->near_edge[of] != 0) {
        of = cell_beyond_edges(place_x[i], place_y[i], footprint_m(i), looks);
      }
      here = of_label[cover_->cells[of]];
    }
    const float bare_from = looks[here].shade.bare_from;
    const float reach = kRaggedSlope * bare_from;
    const float least = bare_from - reach;
    if (bare_from > 0.0F && steep[i] > least * least) {
      const float slope = std::sqrt(steep[i]);
      constexpr float kPatch_m = 0.5F;
      const float per_patch = 1.0F / (per_m_ * kPatch_m);
      const float ragged = slope > bare_from + reach
                               ? 0.0F
                               : reach * fading(kPatch_m, footprint_m(i)) *
                                     waver(place_x[i] * per_patch, place_y[i] * per_patch, 5U);
      here = slope + ragged > bare_from ? face : here;
    }
    look[i] = here;
  }
}

}  // namespace rigwire::sim
