#include "sim/camera/surface_grain.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

constexpr float kLeastCell_px = 0.75F;  ///< Twice as wide cells count in full.
constexpr int kPatchOctaves = 3;
/// Coarser relief is the mesh's own.
constexpr int kFirstRelief = 2;

constexpr std::uint32_t kX = 0x9E3779B1U;
constexpr std::uint32_t kY = 0x85EBCA77U;
constexpr std::uint32_t kZ = 0xC2B2AE3DU;

constexpr float kStoneFrequency_pm = 1.25F;
constexpr int kStoneLattices = 7;
/// Radius of the shade around a stone, in the stone's radii.
constexpr float kShadeReach = 1.3F;
constexpr float kWholeStone_px = 5.0F;
constexpr float kLeastStone_px = 2.5F;
/// Share of the cells of each lattice that hold a stone at a density of 1.
constexpr std::array<float, kStoneLattices> kFilled{0.03F, 0.09F, 0.22F, 0.45F, 0.75F, 1.0F, 1.0F};
/// Axes of the stones' lattices: a rotation.
constexpr std::array<std::array<float, 3>, 3> kStoneAxes{
    {{0.36F, 0.48F, -0.8F}, {-0.8F, 0.6F, 0.0F}, {0.48F, 0.64F, 0.6F}}};

void split(double cells, std::int32_t& cell, float& share) {
  const double whole = std::floor(cells);
  cell = static_cast<std::int32_t>(static_cast<std::uint32_t>(static_cast<std::int64_t>(whole)));
  share = static_cast<float>(cells - whole);
}

/// A value in [-1, 1) of a lattice point, in units of kLatticeUnit.
constexpr float kLatticeUnit = 0x1.0p-31F;
inline float lattice(std::uint32_t mixed) {
  mixed ^= mixed >> 15U;
  return static_cast<float>(static_cast<std::int32_t>(mixed * 0x2C1B3C6DU));
}

}  // namespace

void GrainAnchor::set(std::size_t lane, const Eigen::Vector3d& anchor_m, double frequency_pm,
                      double upright) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    split(anchor_m[static_cast<int>(axis)] * frequency_pm * (axis == 2 ? upright : 1.0),
          cell[axis][lane], share[axis][lane]);
  }
}

StoneAnchor::StoneAnchor(const Eigen::Vector3d& anchor_m) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double cells = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      cells += static_cast<double>(kStoneAxes[axis][k]) * anchor_m[static_cast<int>(k)];
    }
    split(cells * static_cast<double>(kStoneFrequency_pm), cell[axis], share[axis]);
  }
}

namespace {

/// Where points are in an octave's lattice, and what it adds to the sums.
struct OctaveLanes {
  LaneArray a, b, c;                                      ///< Place from the cell's middle.
  alignas(32) std::array<std::uint32_t, kLanes> x, y, z;  ///< The cell.
};

/// The value in a cell and its slopes, from those at its corners: with the blends u, v, w
///   k0 + u k1 + v k2 + w k3 + u v k4 + v w k5 + u w k6 + u v w k7
struct CellTerms {
  float k0, k1, k2, k3, k4, k5, k6, k7;
};

inline CellTerms terms_of(float v000, float v100, float v010, float v110, float v001, float v101,
                          float v011, float v111) {
  const float e00 = v100 - v000;
  const float e10 = v110 - v010;
  const float e01 = v101 - v001;
  const float e11 = v111 - v011;
  const float n0 = v010 - v000;
  const float n1 = v011 - v001;
  const float d0 = e10 - e00;
  return {v000, e00, n0, v001 - v000, d0, n1 - n0, e01 - e00, (e11 - e01) - d0};
}

/// Quintic blend 6 t^5 - 15 t^4 + 10 t^3 and its slope 30 t^2 (1 - t)^2, by the place s = t - 1 / 2
/// from the cell's middle, of which they are odd and even.
struct Quintic {
  float value;
  float slope_30;  ///< A thirtieth of it.
};
inline Quintic quintic(float s) {
  const float ss = s * s;
  const float side = 0.25F - ss;
  return {0.5F + s * (1.875F + ss * (6.0F * ss - 5.0F)), side * side};
}

/// Adds an octave; `terms_at` of a lane.
template <bool kPatch, bool kRelief, class TermsAt>
inline __attribute__((always_inline)) void add_octave(
    const OctaveLanes& at, const TermsAt& terms_at, const LaneArray& persistence, LaneArray& weight,
    LaneArray& cells, Grain& grain, float* sx, float* sy, float* sz) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const CellTerms k = terms_at(i);
    // Fades out before the cell comes down to a pixel.
    float there = cells[i] - 1.0F;
    there = there < 0.0F ? 0.0F : (there > 1.0F ? 1.0F : there);
    there *= kLatticeUnit;
    const Quintic u = quintic(at.a[i]);
    const Quintic v = quintic(at.b[i]);
    const Quintic w = quintic(at.c[i]);
    const float bend = k.k4 + w.value * k.k7;
    const float flat_x = k.k1 + w.value * k.k6;
    const float by_y = (k.k2 + w.value * k.k5) + u.value * bend;
    const float share = there * ((k.k0 + w.value * k.k3) + u.value * flat_x + v.value * by_y);
    grain.brightness[i] += weight[i] * share;
    weight[i] *= persistence[i];
    cells[i] *= 0.5F;
    if constexpr (kPatch) {
      grain.patch[i] += share;
    }
    if constexpr (kRelief) {
      const float by_x = flat_x + v.value * bend;
      const float by_z = (k.k3 + v.value * k.k5) + u.value * (k.k6 + v.value * k.k7);
      const float steep = 30.0F * there;
      sx[i] += steep * (u.slope_30 * by_x);
      sy[i] += steep * (v.slope_30 * by_y);
      sz[i] += steep * (w.slope_30 * by_z);
    }
  }
}

}  // namespace

RIGWIRE_WIDE_VECTORS void sum_grain(const GrainPoints& points, const GrainAnchor& anchor,
                                    Grain& grain) {
  std::array<LaneArray, 3> place;
  LaneArray weight;
  LaneArray cells;  // Cell edges, in units of the smallest visible cell.
  float widest = 0.0F;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    place[0][i] = points.x[i] * points.frequency_pm[i] + anchor.share[0][i];
    place[1][i] = points.y[i] * points.frequency_pm[i] + anchor.share[1][i];
    place[2][i] = points.z[i] * points.frequency_pm[i] * points.upright[i] + anchor.share[2][i];
    const float finest = points.upright[i] > 1.0F ? points.upright[i] : 1.0F;
    cells[i] = (1.0F / kLeastCell_px) / (points.frequency_pm[i] * finest * points.footprint_m[i]);
    weight[i] = 1.0F;
    grain.patch[i] = 0.0F;
    grain.brightness[i] = 0.0F;
    grain.slope_x[i] = 0.0F;
    grain.slope_y[i] = 0.0F;
    grain.slope_z[i] = 0.0F;
  }
  for (std::size_t i = 0; i < kLanes; ++i) {
    widest = cells[i] > widest ? cells[i] : widest;
  }
  const std::array<LaneArray*, 3> slope{&grain.slope_x, &grain.slope_y, &grain.slope_z};
  OctaveLanes at;
  for (int octave = 0; octave < kMostOctaves && widest > 1.0F; ++octave) {
    // Axes change places from octave to octave.
    const auto turn = static_cast<std::size_t>(octave % 3);
    const std::size_t ax = turn;
    const std::size_t ay = (turn + 1) % 3;
    const std::size_t az = (turn + 2) % 3;
    float* const px = place[ax].data();
    float* const py = place[ay].data();
    float* const pz = place[az].data();
    const std::int32_t* const cx = anchor.cell[ax].data();
    const std::int32_t* const cy = anchor.cell[ay].data();
    const std::int32_t* const cz = anchor.cell[az].data();
    float* const sx = slope[ax]->data();
    float* const sy = slope[ay]->data();
    float* const sz = slope[az]->data();
    const auto shift = static_cast<float>(octave) * 0.3819660F;
    const auto seed = static_cast<std::uint32_t>(octave + 1) * 0x7FEB352DU;
    const std::uint32_t times = 1U << static_cast<unsigned>(octave);
#pragma GCC ivdep
    for (std::size_t i = 0; i < kLanes; ++i) {
      const float x = px[i] + shift;
      const float y = py[i] + shift;
      const float z = pz[i] + shift;
      px[i] += px[i];
      py[i] += py[i];
      pz[i] += pz[i];
      // Cell, and place from its middle.
      std::int32_t ix = static_cast<std::int32_t>(x);
      std::int32_t iy = static_cast<std::int32_t>(y);
      std::int32_t iz = static_cast<std::int32_t>(z);
      ix -= static_cast<float>(ix) > x ? 1 : 0;
      iy -= static_cast<float>(iy) > y ? 1 : 0;
      iz -= static_cast<float>(iz) > z ? 1 : 0;
      at.a[i] = (x - static_cast<float>(ix)) - 0.5F;
      at.b[i] = (y - static_cast<float>(iy)) - 0.5F;
      at.c[i] = (z - static_cast<float>(iz)) - 0.5F;
      at.x[i] = static_cast<std::uint32_t>(ix) + static_cast<std::uint32_t>(cx[i]) * times;
      at.y[i] = static_cast<std::uint32_t>(iy) + static_cast<std::uint32_t>(cy[i]) * times;
      at.z[i] = static_cast<std::uint32_t>(iz) + static_cast<std::uint32_t>(cz[i]) * times;
    }
    const auto terms = [&at, seed ](std::size_t i) __attribute__((always_inline)) {
      const std::uint32_t hx = at.x[i] * kX + seed;
      const std::uint32_t hy = at.y[i] * kY;
      const std::uint32_t hz = at.z[i] * kZ;
      const std::uint32_t h00 = hy ^ hz;
      const std::uint32_t h10 = (hy + kY) ^ hz;
      const std::uint32_t h01 = hy ^ (hz + kZ);
      const std::uint32_t h11 = (hy + kY) ^ (hz + kZ);
      return terms_of(lattice(hx ^ h00), lattice((hx + kX) ^ h00), lattice(hx ^ h10),
                      lattice((hx + kX) ^ h10), lattice(hx ^ h01), lattice((hx + kX) ^ h01),
                      lattice(hx ^ h11), lattice((hx + kX) ^ h11));
    };
    if (octave < kFirstRelief) {
      add_octave<true, false>(at, terms, points.persistence, weight, cells, grain, sx, sy, sz);
    } else if (octave < kPatchOctaves) {
      add_octave<true, true>(at, terms, points.persistence, weight, cells, grain, sx, sy, sz);
    } else {
      add_octave<false, true>(at, terms, points.persistence, weight, cells, grain, sx, sy, sz);
    }
    widest *= 0.5F;
  }
  for (std::size_t i = 0; i < kLanes; ++i) {
    grain.slope_z[i] *= points.upright[i];
  }
}

RIGWIRE_WIDE_VECTORS void lay_stones(const GrainPoints& points, const StoneAnchor& anchor,
                                     const LaneArray& density, Stones& stones) {
  std::array<LaneArray, 3> place;
  LaneArray cell_px;
  float widest_px = 0.0F;
  for (std::size_t axis = 0; axis < 3; ++axis) {
#pragma GCC ivdep
    for (std::size_t i = 0; i < kLanes; ++i) {
      place[axis][i] = (kStoneAxes[axis][0] * points.x[i] + kStoneAxes[axis][1] * points.y[i] +
                        kStoneAxes[axis][2] * points.z[i]) *
                           kStoneFrequency_pm +
                       anchor.share[axis];
    }
  }
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    cell_px[i] = density[i] > 0.0F ? 1.0F / (kStoneFrequency_pm * points.footprint_m[i]) : 0.0F;
    stones.share[i] = 0.0F;
    stones.tone[i] = 1.0F;
    stones.gap[i] = 1.0F;
    stones.slope_x[i] = 0.0F;
    stones.slope_y[i] = 0.0F;
    stones.slope_z[i] = 0.0F;
  }
  for (std::size_t i = 0; i < kLanes; ++i) {
    widest_px = cell_px[i] > widest_px ? cell_px[i] : widest_px;
  }
  std::array<LaneArray, 3> within;
  LaneArray presence;
  alignas(32) std::array<std::uint32_t, kLanes> drawn;
  const auto byte = [](std::uint32_t bits, unsigned from) {
    return static_cast<float>(static_cast<std::int32_t>(bits >> from & 0xFFU)) * (1.0F / 255.0F);
  };
  for (int k = 0; k < kStoneLattices && widest_px > kLeastStone_px; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const std::uint32_t times = 1U << static_cast<unsigned>(k);
    const std::uint32_t cx = static_cast<std::uint32_t>(anchor.cell[0]) * times;
    const std::uint32_t cy = static_cast<std::uint32_t>(anchor.cell[1]) * times;
    const std::uint32_t cz = static_cast<std::uint32_t>(anchor.cell[2]) * times;
    const std::uint32_t seed = static_cast<std::uint32_t>(k + 1) * 0x27D4EB2FU;
    const float filled = kFilled[at];
    // Find the cells that hold a stone; few of the coarse lattices' do.
    std::uint32_t somewhere = 0;
#pragma GCC ivdep
    for (std::size_t i = 0; i < kLanes; ++i) {
      const float x = place[0][i];
      const float y = place[1][i];
      const float z = place[2][i];
      place[0][i] += x;
      place[1][i] += y;
      place[2][i] += z;
      std::int32_t ix = static_cast<std::int32_t>(x);
      std::int32_t iy = static_cast<std::int32_t>(y);
      std::int32_t iz = static_cast<std::int32_t>(z);
      ix -= static_cast<float>(ix) > x ? 1 : 0;
      iy -= static_cast<float>(iy) > y ? 1 : 0;
      iz -= static_cast<float>(iz) > z ? 1 : 0;
      within[0][i] = x - static_cast<float>(ix);
      within[1][i] = y - static_cast<float>(iy);
      within[2][i] = z - static_cast<float>(iz);
      std::uint32_t one = ((static_cast<std::uint32_t>(ix) + cx) * kX) ^
                          ((static_cast<std::uint32_t>(iy) + cy) * kY) ^
                          ((static_cast<std::uint32_t>(iz) + cz) * kZ) ^ seed;
      one ^= one >> 15U;
      one *= 0x2C1B3C6DU;
      one ^= one >> 13U;
      drawn[i] = one;
      float there = (cell_px[i] - kLeastStone_px) * (1.0F / (kWholeStone_px - kLeastStone_px));
      there = there < 0.0F ? 0.0F : (there > 1.0F ? 1.0F : there);
      const bool holds = byte(one, 24U) < density[i] * filled;
      presence[i] = holds ? there : 0.0F;
      somewhere |= holds ? 1U : 0U;
    }
    if (somewhere == 0) {
      for (std::size_t i = 0; i < kLanes; ++i) {
        cell_px[i] *= 0.5F;
      }
      widest_px *= 0.5F;
      continue;
    }
#pragma GCC ivdep
    for (std::size_t i = 0; i < kLanes; ++i) {
      const std::uint32_t one = drawn[i];
      const std::uint32_t two = one * 0x297A2D39U;
      // Radius, presence and brightness; then the centre, so that the stone and the shade beside it
      // stay in their cell.
      const float radius = 0.14F + 0.24F * byte(two, 24U);
      const float margin = kShadeReach * radius;
      const float room = 1.0F - 2.0F * margin;
      const float dx = within[0][i] - margin - room * byte(one, 0U);
      const float dy = within[1][i] - margin - room * byte(one, 8U);
      const float dz = within[2][i] - margin - room * byte(one, 16U);
      const float out = 1.0F / radius;
      // Broken stones: the sphere less what a slanting octahedron leaves of it.
      const float lean = byte(two, 8U) - 0.5F;
      const float corner =
          std::abs(dx + lean * dy) + std::abs(dy - lean * dz) + std::abs(dz + 0.7F * lean * dx);
      const float ball = dx * dx + dy * dy + dz * dz;
      const float edged = 0.62F * corner * corner;
      const float square = (ball > edged ? ball : edged) * out * out;
      const float there = presence[i] * (1.0F - stones.share[i]);
      // An edge one pixel wide, and the shade beside it.
      float cover = (1.0F - square) * 0.5F * radius * cell_px[i];
      cover = cover < 0.0F ? 0.0F : (cover > 1.0F ? 1.0F : cover);
      float beside = 1.0F - (square - 1.0F) * (1.0F / (kShadeReach * kShadeReach - 1.0F));
      beside = beside < 0.0F ? 0.0F : (beside > 1.0F ? 1.0F : beside);
      const float mine = there * cover;
      const float tone = 0.70F + 0.60F * byte(two, 16U);
      stones.tone[i] += mine * (tone - stones.tone[i]);
      stones.share[i] += mine;
      stones.gap[i] *= 1.0F - 0.35F * there * (1.0F - cover) * beside;
      const float bend = -1.1F * mine * out;
      stones.slope_x[i] +=
          bend * (kStoneAxes[0][0] * dx + kStoneAxes[1][0] * dy + kStoneAxes[2][0] * dz);
      stones.slope_y[i] +=
          bend * (kStoneAxes[0][1] * dx + kStoneAxes[1][1] * dy + kStoneAxes[2][1] * dz);
      stones.slope_z[i] +=
          bend * (kStoneAxes[0][2] * dx + kStoneAxes[1][2] * dy + kStoneAxes[2][2] * dz);
      cell_px[i] *= 0.5F;
    }
    widest_px *= 0.5F;
  }
}

}  // namespace rigwire::sim
