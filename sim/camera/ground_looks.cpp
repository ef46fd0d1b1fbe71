#include "sim/camera/ground_looks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace rigwire::sim {
namespace {

/// Half width of the ragged edge of bare slopes, as share of the steepness where they begin.
constexpr float kRaggedSlope = 0.25F;

/// Two slopes beside each other.
using Four = float __attribute__((vector_size(16)));

/// Where points are in a lattice over the plane, for what wavers there.
struct PlaneLanes {
  alignas(32) std::array<std::uint32_t, kLanes> x, y;  ///< The cell, hashed along x and y.
  LaneArray u, v;                                      ///< Blends within it.
};

constexpr std::uint32_t kAlongX = 0x9E3779B1U;
constexpr std::uint32_t kAlongY = 0x85EBCA77U;

/// `x` and `y` in cells.
inline __attribute__((always_inline)) void enter_plane(const LaneArray& x, const LaneArray& y,
                                                       PlaneLanes& at) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    std::int32_t ix = static_cast<std::int32_t>(x[i]);
    std::int32_t iy = static_cast<std::int32_t>(y[i]);
    ix -= static_cast<float>(ix) > x[i] ? 1 : 0;
    iy -= static_cast<float>(iy) > y[i] ? 1 : 0;
    at.x[i] = static_cast<std::uint32_t>(ix) * kAlongX;
    at.y[i] = static_cast<std::uint32_t>(iy) * kAlongY;
    const float a = x[i] - static_cast<float>(ix);
    const float b = y[i] - static_cast<float>(iy);
    at.u[i] = a * a * (3.0F - 2.0F * a);
    at.v[i] = b * b * (3.0F - 2.0F * b);
  }
}

/// A value in [-1, 1) that wavers over the plane: one octave of value noise.
inline float waver(const PlaneLanes& at, std::size_t i, std::uint32_t seed) {
  const auto value = [seed](std::uint32_t x, std::uint32_t y) {
    std::uint32_t mixed = x ^ y ^ seed;
    mixed ^= mixed >> 15U;
    mixed *= 0x2C1B3C6DU;
    mixed ^= mixed >> 13U;
    return static_cast<float>(static_cast<std::int32_t>(mixed * 0x297A2D39U)) * 0x1.0p-31F;
  };
  const std::uint32_t x = at.x[i];
  const std::uint32_t y = at.y[i];
  const float u = at.u[i];
  const float v = at.v[i];
  return (1.0F - v) * ((1.0F - u) * value(x, y) + u * value(x + kAlongX, y)) +
         v * ((1.0F - u) * value(x, y + kAlongY) + u * value(x + kAlongX, y + kAlongY));
}

/// What wavers ends at the pixel as grain does.
inline float fading(float cell_m, float footprint_m) {
  const float share = cell_m / footprint_m * (1.0F / 1.5F) - 0.5F;
  return share < 0.0F ? 0.0F : (share > 1.0F ? 1.0F : share);
}

}  // namespace

void GroundLooks::add_label(std::uint16_t look, const Shade& shade) {
  of_label_.push_back(look);
  laid_.push_back(shade.bare_from == 0.0F ? 1 : 0);
  any_laid_ = any_laid_ || laid_.back() != 0;
}

void GroundLooks::prepare(const Scene::Internals& scene, const Scene::Internals::Terrain& terrain) {
  const HeightField& field = terrain.field;
  cover_ = terrain.cover.get();
  of_label_.clear();
  laid_.clear();
  any_laid_ = false;
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

bool GroundLooks::near_laid(float x, float y) const {
  const auto cell = [this](float column, float row) {
    return static_cast<std::size_t>(std::clamp(static_cast<int>(row), 0, rows_ - 2)) *
               static_cast<std::size_t>(columns_ - 1) +
           static_cast<std::size_t>(std::clamp(static_cast<int>(column), 0, columns_ - 2));
  };
  constexpr auto kReach = static_cast<float>(Scene::Internals::kCoverReach);
  bool laid = false;
  for (const float dx : {-kReach, 0.0F, kReach}) {
    for (const float dy : {-kReach, 0.0F, kReach}) {
      laid = laid || laid_[cover_->cells[cell(x + dx, y + dy)]] != 0;
    }
  }
  return laid;
}

/// Picks the labels at places near a boundary between soils, whose edges are ragged.
RIGWIRE_WIDE_VECTORS void GroundLooks::cross_edges(const Places& at, const LaneArray& footprint_m,
                                                   LabelLanes& label) const {
  constexpr float kCoarse_m = 0.9F;
  constexpr float kFine_m = 0.16F;
  alignas(32) std::array<int, kLanes> line;  // Hard surfaces are laid along one.
  for (std::size_t i = 0; i < kLanes; ++i) {
    line[i] = any_laid_ && at.near_edge[i] != 0 && near_laid(at.x[i], at.y[i]) ? -1 : 0;
  }
  LaneArray coarse_x, coarse_y, fine_x, fine_y;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float x_m = at.x[i] / per_m_;
    const float y_m = at.y[i] / per_m_;
    coarse_x[i] = x_m / kCoarse_m;
    coarse_y[i] = y_m / kCoarse_m;
    fine_x[i] = x_m / kFine_m;
    fine_y[i] = y_m / kFine_m;
  }
  PlaneLanes coarse_at, fine_at;
  enter_plane(coarse_x, coarse_y, coarse_at);
  enter_plane(fine_x, fine_y, fine_at);
  // The four nearest cells, and how much each weighs.
  alignas(32) std::array<int, kLanes> west, east, south, north;
  std::array<LaneArray, 4> weight;
  const int last_column = columns_ - 2;
  const int last_row = rows_ - 2;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float coarse = choose(line[i] != 0, 0.04F, 0.25F) * fading(kCoarse_m, footprint_m[i]);
    const float fine = choose(line[i] != 0, 0.03F, 0.07F) * fading(kFine_m, footprint_m[i]);
    const float aside_x = coarse * waver(coarse_at, i, 1U) + fine * waver(fine_at, i, 2U);
    const float aside_y = coarse * waver(coarse_at, i, 3U) + fine * waver(fine_at, i, 4U);
    const float x = (at.x[i] + aside_x * per_m_) - 0.5F;
    const float y = (at.y[i] + aside_y * per_m_) - 0.5F;
    std::int32_t column = static_cast<std::int32_t>(x);
    std::int32_t row = static_cast<std::int32_t>(y);
    column -= static_cast<float>(column) > x ? 1 : 0;
    row -= static_cast<float>(row) > y ? 1 : 0;
    const float a = x - static_cast<float>(column);
    const float b = y - static_cast<float>(row);
    weight[0][i] = (1.0F - a) * (1.0F - b);
    weight[1][i] = a * (1.0F - b);
    weight[2][i] = (1.0F - a) * b;
    weight[3][i] = a * b;
    const auto within = [](int place, int last) {
      const int above = place > 0 ? place : 0;
      return above < last ? above : last;
    };
    west[i] = within(column, last_column);
    east[i] = within(column + 1, last_column);
    south[i] = within(row, last_row);
    north[i] = within(row + 1, last_row);
  }
  const std::uint8_t* const labels = cover_->cells.data();
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (at.near_edge[i] == 0) {
      continue;
    }
    const std::uint8_t* const below = labels + south[i] * (columns_ - 1);
    const std::uint8_t* const above = labels + north[i] * (columns_ - 1);
    const std::array<std::uint8_t, 4> corner{below[west[i]], below[east[i]], above[west[i]],
                                             above[east[i]]};
    // The one of their labels that weighs most.
    float most = 0.0F;
    label[i] = corner[0];
    for (std::size_t k = 0; k < 4; ++k) {
      float sum = 0.0F;
      for (std::size_t j = 0; j < 4; ++j) {
        sum += corner[j] == corner[k] ? weight[j][i] : 0.0F;
      }
      if (sum > most) {
        most = sum;
        label[i] = corner[k];
      }
    }
  }
}

/// Whether each surface is bare where it is so steep: its cut face begins raggedly.
RIGWIRE_WIDE_VECTORS void GroundLooks::lay_bare(const Places& at, const LaneArray& footprint_m,
                                                const LaneArray& steep, const LaneArray& bare_from,
                                                std::array<int, kLanes>& bare) const {
  constexpr float kPatch_m = 0.5F;
  const float per_patch = 1.0F / (per_m_ * kPatch_m);
  LaneArray x, y;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    x[i] = at.x[i] * per_patch;
    y[i] = at.y[i] * per_patch;
  }
  PlaneLanes patch;
  enter_plane(x, y, patch);
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float reach = kRaggedSlope * bare_from[i];
    const float least = bare_from[i] - reach;
    const float slope = std::sqrt(steep[i]);
    const float wavers = reach * fading(kPatch_m, footprint_m[i]) * waver(patch, i, 5U);
    const float ragged = choose(slope > bare_from[i] + reach, 0.0F, wavers);
    const bool may = (bare_from[i] > 0.0F) & (steep[i] > least * least);
    bare[i] = may & (slope + ragged > bare_from[i]) ? -1 : 0;
  }
}

RIGWIRE_WIDE_VECTORS void GroundLooks::find(const std::array<int, kLanes>& mine,
                                            const RTCRay8& rays, const LaneArray& pixel_rad,
                                            const PreparedLook* looks, MetSurfaces& met,
                                            LookLanes& look) const {
  Places at;
  LaneArray a, b, slope_x, slope_y, steep;  // squared
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
    at.x[i] = (met.x[i] + offset_x) * per_m_;
    at.y[i] = (met.y[i] + offset_y) * per_m_;
    float x = choose(at.x[i] > 0.0F, at.x[i], 0.0F);
    float y = choose(at.y[i] > 0.0F, at.y[i], 0.0F);
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
    met.draw[i] = mine[i] != 0 ? 0.0F : met.draw[i];  // ground is not made of its triangles
  }
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
    common = of_label_[first];
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
  // Ground lies flatter than the ray mostly: a pixel is as long there as the slant makes it.
  LaneArray footprint_m;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float down = rays.dir_z[i] < 0.0F ? -rays.dir_z[i] : rays.dir_z[i];
    const float cosine = down > 0.05F ? down : 0.05F;
    footprint_m[i] = rays.tfar[i] * pixel_rad[i] / std::sqrt(cosine) + 1e-6F;
  }
  alignas(32) std::array<std::uint32_t, kLanes> here;
  here.fill(own);
  if (cover_ != nullptr) {
    LabelLanes label;
    int on_edges = 0;
    for (std::size_t i = 0; i < kLanes; ++i) {
      label[i] = cover_->cells[cells[i]];
      at.near_edge[i] = cover_->near_edge[cells[i]] != 0 ? mine[i] : 0;
      on_edges |= at.near_edge[i];
    }
    if (on_edges != 0) {
      cross_edges(at, footprint_m, label);
    }
    for (std::size_t i = 0; i < kLanes; ++i) {
      here[i] = of_label_[label[i]];
    }
  }
  LaneArray bare_from;
  for (std::size_t i = 0; i < kLanes; ++i) {
    bare_from[i] = looks[here[i]].shade.bare_from;
  }
  alignas(32) std::array<int, kLanes> bare;
  lay_bare(at, footprint_m, steep, bare_from, bare);
  for (std::size_t i = 0; i < kLanes; ++i) {
    look[i] = mine[i] == 0 ? look[i] : bare[i] != 0 ? face : here[i];
  }
}

}  // namespace rigwire::sim
