#include "sim/camera/surface_grain.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

constexpr float kLeastCell_px = 0.75F;  ///< Twice as wide cells count in full.
constexpr unsigned kPatchOctaves = 3;
/// Coarser relief is the mesh's own.
constexpr unsigned kFirstRelief = 2;

constexpr std::uint32_t kX = 0x9E3779B1U;
constexpr std::uint32_t kY = 0x85EBCA77U;
constexpr std::uint32_t kZ = 0xC2B2AE3DU;

constexpr float kStoneFrequency_pm = 1.25F;
constexpr unsigned kStoneLattices = 7;
/// Of the shade beside a stone, in its radii.
constexpr float kShadeReach = 1.3F;
constexpr float kWholeStone_px = 5.0F;
constexpr float kLeastStone_px = 2.5F;
/// Of the cells of each lattice, those that hold a stone at a density of 1.
constexpr std::array<float, kStoneLattices> kFilled{0.03F, 0.09F, 0.22F, 0.45F, 0.75F, 1.0F, 1.0F};
/// Axes of the stones' lattices: a rotation.
constexpr std::array<std::array<float, 3>, 3> kStoneAxes{
    {{0.36F, 0.48F, -0.8F}, {-0.8F, 0.6F, 0.0F}, {0.48F, 0.64F, 0.6F}}};

/// Places are counted in this part of a first cell, modulo 2^32: an octave's cell and the place in
/// it are bits of them.
constexpr unsigned kPlaceBits = 18;
constexpr auto kPerCell = static_cast<float>(1U << kPlaceBits);

std::uint32_t whole_place(double cells) {
  return static_cast<std::uint32_t>(
      static_cast<std::int64_t>(std::floor(cells * static_cast<double>(kPerCell))));
}

/// The place of a point from its anchor; what is out of reach stays at its end.
inline std::uint32_t place_of(float cells) {
  float place = cells * kPerCell;
  place = place > -2.1e9F ? place : -2.1e9F;
  place = place < 2.1e9F ? place : 2.1e9F;
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(place));
}

/// Of a place in the octave `times` (2^k) finer than the first, `bits` = kPlaceBits - k: the cell,
/// and the distance from its middle in cells.
inline std::uint32_t cell_of(std::uint32_t place, unsigned bits) {
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(place) >> bits);
}
inline float from_middle(std::uint32_t place, unsigned bits) {
  return static_cast<float>(static_cast<std::int32_t>(place << (32U - bits) ^ 0x80000000U)) *
         0x1.0p-32F;
}

/// A value in [-1, 1) of a lattice point, in units of kLatticeUnit.
constexpr float kLatticeUnit = 0x1.0p-31F;
/// Where all is alike along z. Blending along it, which is not done there, would leave 2 int q^2 of
/// the variance, 181 / 231 for the quintic q: 0.885 of the contrast; a little more keeps what
/// matching lives on.
constexpr float kFlatUnit = 0.92F * kLatticeUnit;
inline float lattice(std::uint32_t mixed) {
  mixed ^= mixed >> 15U;
  return static_cast<float>(static_cast<std::int32_t>(mixed * 0x2C1B3C6DU));
}

}  // namespace

void GrainAnchor::set(std::size_t lane, const Eigen::Vector3d& anchor_m, double frequency_pm,
                      double upright) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    place[axis][lane] =
        whole_place(anchor_m[static_cast<int>(axis)] * frequency_pm * (axis == 2 ? upright : 1.0));
  }
}

StoneAnchor::StoneAnchor(const Eigen::Vector3d& anchor_m) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double cells = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      cells += static_cast<double>(kStoneAxes[axis][k]) * anchor_m[static_cast<int>(k)];
    }
    place[axis] = whole_place(cells * static_cast<double>(kStoneFrequency_pm));
  }
}

namespace {

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

/// Places of the points, and sums in units of kLatticeUnit and, slopes, 30 of them.
struct GrainLanes {
  alignas(32) std::array<std::uint32_t, kLanes> x, y, z;
  alignas(32) std::array<std::uint32_t, kLanes> stands;  ///< ~0; 0: alike along z.
  LaneArray weight;
  LaneArray cells;  ///< Edges of the octave's cells in the least ones that show.
};

/// Adds an octave, whose cells are `bits` of a place wide: the value in a cell and its slopes, from
/// those at its corners, with the blends u, v, w
///   k0 + u k1 + v k2 + w k3 + u v k4 + v w k5 + u w k6 + u v w k7
/// Flat: of all lanes w = 0 and the cell's number along z.
template <bool kFlat, bool kPatch, bool kRelief>
inline __attribute__((always_inline)) void add_octave(GrainLanes& of, const LaneArray& persistence,
                                                      std::uint32_t shift, unsigned bits,
                                                      std::uint32_t seed, Grain& grain) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const std::uint32_t x = of.x[i] + shift;
    const std::uint32_t y = of.y[i] + shift;
    const Quintic u = quintic(from_middle(x, bits));
    const Quintic v = quintic(from_middle(y, bits));
    const std::uint32_t hx = cell_of(x, bits) * kX + seed;
    const std::uint32_t hy = cell_of(y, bits) * kY;
    // Fades out before the cell comes down to a pixel.
    const float there = clamp_to_one(of.cells[i] - 1.0F);
    float value;
    float by_x;
    float by_y;
    if constexpr (kFlat) {
      const float k0 = lattice(hx ^ hy);
      const float k1 = lattice((hx + kX) ^ hy) - k0;
      const float v010 = lattice(hx ^ (hy + kY));
      const float k4 = (lattice((hx + kX) ^ (hy + kY)) - v010) - k1;
      by_y = (v010 - k0) + u.value * k4;
      by_x = k1 + v.value * k4;
      value = (k0 + u.value * k1) + v.value * by_y;
    } else {
      const std::uint32_t z = (of.z[i] + shift) & of.stands[i];
      const std::uint32_t hz = cell_of(z, bits) * kZ;
      // Where all is alike along z the place is the lower end of a cell: w = 0.
      const Quintic w = quintic(from_middle(z, bits));
      const std::uint32_t h00 = hy ^ hz;
      const std::uint32_t h10 = (hy + kY) ^ hz;
      const std::uint32_t h01 = hy ^ (hz + kZ);
      const std::uint32_t h11 = (hy + kY) ^ (hz + kZ);
      const float k0 = lattice(hx ^ h00);
      const float k1 = lattice((hx + kX) ^ h00) - k0;
      const float v010 = lattice(hx ^ h10);
      const float v001 = lattice(hx ^ h01);
      const float v011 = lattice(hx ^ h11);
      const float e10 = lattice((hx + kX) ^ h10) - v010;
      const float e01 = lattice((hx + kX) ^ h01) - v001;
      const float e11 = lattice((hx + kX) ^ h11) - v011;
      const float k2 = v010 - k0;
      const float k3 = v001 - k0;
      const float k4 = e10 - k1;
      const float k5 = (v011 - v001) - k2;
      const float k6 = e01 - k1;
      const float k7 = (e11 - e01) - k4;
      const float bend = k4 + w.value * k7;
      const float flat_x = k1 + w.value * k6;
      by_y = (k2 + w.value * k5) + u.value * bend;
      by_x = flat_x + v.value * bend;
      value = ((k0 + w.value * k3) + u.value * flat_x) + v.value * by_y;
      if constexpr (kRelief) {
        const float by_z = (k3 + v.value * k5) + u.value * (k6 + v.value * k7);
        grain.slope_z[i] += there * (w.slope_30 * by_z);
      }
    }
    value *= there;
    grain.brightness[i] += of.weight[i] * value;
    if constexpr (kPatch) {
      grain.patch[i] += value;
    }
    if constexpr (kRelief) {
      grain.slope_x[i] += there * (u.slope_30 * by_x);
      grain.slope_y[i] += there * (v.slope_30 * by_y);
    }
    of.weight[i] *= persistence[i];
    of.cells[i] *= 0.5F;
  }
}

template <bool kFlat>
inline __attribute__((always_inline)) void add_octaves(GrainLanes& of, const LaneArray& persistence,
                                                       float widest, Grain& grain) {
  for (unsigned octave = 0; octave < kMostOctaves && widest > 1.0F; ++octave) {
    const unsigned bits = kPlaceBits - octave;
    // The golden ratio's share of a cell further in each octave.
    const std::uint32_t shift = (octave * 0x61C88647U) >> (32U - bits);
    const std::uint32_t seed = (octave + 1U) * 0x7FEB352DU;
    if (octave < kFirstRelief) {
      add_octave<kFlat, true, false>(of, persistence, shift, bits, seed, grain);
    } else if (octave < kPatchOctaves) {
      add_octave<kFlat, true, true>(of, persistence, shift, bits, seed, grain);
    } else {
      add_octave<kFlat, false, true>(of, persistence, shift, bits, seed, grain);
    }
    widest *= 0.5F;
  }
}

}  // namespace

RIGWIRE_WIDE_VECTORS void sum_grain(const GrainPoints& points, const GrainAnchor& anchor,
                                    Grain& grain) {
  GrainLanes of;
  std::uint32_t stands = 0;
  float widest = 0.0F;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float upright = points.upright[i];
    of.x[i] = place_of(points.x[i] * points.frequency_pm[i]) + anchor.place[0][i];
    of.y[i] = place_of(points.y[i] * points.frequency_pm[i]) + anchor.place[1][i];
    of.z[i] = place_of(points.z[i] * points.frequency_pm[i] * upright) + anchor.place[2][i];
    of.stands[i] = upright > 0.0F ? ~0U : 0U;
    const float finest = upright > 1.0F ? upright : 1.0F;
    of.cells[i] =
        (1.0F / kLeastCell_px) / (points.frequency_pm[i] * finest * points.footprint_m[i]);
    of.weight[i] = 1.0F;
    grain.patch[i] = 0.0F;
    grain.brightness[i] = 0.0F;
    grain.slope_x[i] = 0.0F;
    grain.slope_y[i] = 0.0F;
    grain.slope_z[i] = 0.0F;
  }
  for (std::size_t i = 0; i < kLanes; ++i) {
    stands |= of.stands[i];
    widest = of.cells[i] > widest ? of.cells[i] : widest;
  }
  if (stands == 0) {
    add_octaves<true>(of, points.persistence, widest, grain);
  } else {
    add_octaves<false>(of, points.persistence, widest, grain);
  }
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float unit = of.stands[i] != 0 ? kLatticeUnit : kFlatUnit;
    grain.patch[i] *= unit;
    grain.brightness[i] *= unit;
    grain.slope_x[i] *= 30.0F * unit;
    grain.slope_y[i] *= 30.0F * unit;
    grain.slope_z[i] *= 30.0F * unit * points.upright[i];
  }
}

RIGWIRE_WIDE_VECTORS void lay_stones(const GrainPoints& points, const StoneAnchor& anchor,
                                     const LaneArray& density, Stones& stones) {
  alignas(32) std::array<std::array<std::uint32_t, kLanes>, 3> place;
  LaneArray cell_px;
  float widest_px = 0.0F;
  for (std::size_t axis = 0; axis < 3; ++axis) {
#pragma GCC ivdep
    for (std::size_t i = 0; i < kLanes; ++i) {
      place[axis][i] =
          place_of((kStoneAxes[axis][0] * points.x[i] + kStoneAxes[axis][1] * points.y[i] +
                    kStoneAxes[axis][2] * points.z[i]) *
                   kStoneFrequency_pm) +
          anchor.place[axis];
    }
  }
  // Slopes along the lattices' axes.
  LaneArray bend_x, bend_y, bend_z;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float cell = 1.0F / (kStoneFrequency_pm * points.footprint_m[i]);
    cell_px[i] = density[i] > 0.0F ? cell : 0.0F;
    stones.share[i] = 0.0F;
    stones.tone[i] = 1.0F;
    stones.gap[i] = 1.0F;
    bend_x[i] = 0.0F;
    bend_y[i] = 0.0F;
    bend_z[i] = 0.0F;
  }
  for (std::size_t i = 0; i < kLanes; ++i) {
    widest_px = cell_px[i] > widest_px ? cell_px[i] : widest_px;
  }
  LaneArray presence;
  alignas(32) std::array<std::uint32_t, kLanes> drawn;
  const auto byte = [](std::uint32_t bits, unsigned from) {
    return static_cast<float>(static_cast<std::int32_t>(bits >> from & 0xFFU));
  };
  constexpr float kByte = 1.0F / 255.0F;
  for (unsigned k = 0; k < kStoneLattices && widest_px > kLeastStone_px; ++k) {
    const unsigned bits = kPlaceBits - k;
    const std::uint32_t seed = (k + 1U) * 0x27D4EB2FU;
    const float filled = 255.0F * kFilled[k];
    // Which cells hold a stone; of the coarse lattices few do.
    std::uint32_t somewhere = 0;
#pragma GCC ivdep
    for (std::size_t i = 0; i < kLanes; ++i) {
      std::uint32_t one = (cell_of(place[0][i], bits) * kX) ^ (cell_of(place[1][i], bits) * kY) ^
                          (cell_of(place[2][i], bits) * kZ) ^ seed;
      one ^= one >> 15U;
      one *= 0x2C1B3C6DU;
      one ^= one >> 13U;
      drawn[i] = one;
      const float there =
          clamp_to_one((cell_px[i] - kLeastStone_px) * (1.0F / (kWholeStone_px - kLeastStone_px)));
      const bool holds = byte(one, 24U) < density[i] * filled;
      presence[i] = holds ? there : 0.0F;
      somewhere |= holds ? 1U : 0U;
    }
    if (somewhere != 0) {
#pragma GCC ivdep
      for (std::size_t i = 0; i < kLanes; ++i) {
        const std::uint32_t one = drawn[i];
        const std::uint32_t two = one * 0x297A2D39U;
        // Radius, presence and brightness; then the centre, so that the stone and the shade beside
        // it stay in their cell.
        const float radius = 0.14F + 0.24F * kByte * byte(two, 24U);
        const float margin = kShadeReach * radius - 0.5F;
        const float room = -2.0F * kByte * margin;
        const float dx = from_middle(place[0][i], bits) - margin - room * byte(one, 0U);
        const float dy = from_middle(place[1][i], bits) - margin - room * byte(one, 8U);
        const float dz = from_middle(place[2][i], bits) - margin - room * byte(one, 16U);
        const float out = 1.0F / radius;
        // Broken stones: the sphere less what a slanting octahedron leaves of it.
        const float lean = kByte * byte(two, 8U) - 0.5F;
        const float corner =
            std::abs(dx + lean * dy) + std::abs(dy - lean * dz) + std::abs(dz + 0.7F * lean * dx);
        const float ball = dx * dx + dy * dy + dz * dz;
        const float edged = 0.62F * corner * corner;
        const float square = (ball > edged ? ball : edged) * out * out;
        const float there = presence[i] * (1.0F - stones.share[i]);
        // An edge one pixel wide, and the shade beside it.
        const float cover = clamp_to_one((1.0F - square) * 0.5F * radius * cell_px[i]);
        const float beside =
            clamp_to_one(1.0F - (square - 1.0F) * (1.0F / (kShadeReach * kShadeReach - 1.0F)));
        const float mine = there * cover;
        const float tone = 0.70F + 0.60F * kByte * byte(two, 16U);
        stones.tone[i] += mine * (tone - stones.tone[i]);
        stones.share[i] += mine;
        stones.gap[i] *= 1.0F - 0.35F * (there - mine) * beside;
        const float bend = mine * out;
        bend_x[i] += bend * dx;
        bend_y[i] += bend * dy;
        bend_z[i] += bend * dz;
      }
    }
#pragma GCC ivdep
    for (std::size_t i = 0; i < kLanes; ++i) {
      cell_px[i] *= 0.5F;
    }
    widest_px *= 0.5F;
  }
  constexpr float kDome = -1.1F;
  const auto turned = [&](std::size_t axis, std::size_t i) {
    return kDome * (kStoneAxes[0][axis] * bend_x[i] + kStoneAxes[1][axis] * bend_y[i] +
                    kStoneAxes[2][axis] * bend_z[i]);
  };
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    stones.slope_x[i] = turned(0, i);
    stones.slope_y[i] = turned(1, i);
    stones.slope_z[i] = turned(2, i);
  }
}

}  // namespace rigwire::sim
