// Grain and relief of surfaces, band-limited by the pixel, for eight points side by side.
//
// A sum of octaves of value noise over the points of space (so that there are no seams): lattice
// values are hashed, blended by quintic curves (K. Perlin, "Improving noise", SIGGRAPH 2002), with
// their exact gradient. Each octave's lattice is shifted and its axes exchanged, so that lattices
// do not show. An octave counts in full as long as its cell is 1.5 pixels wide and not at all from
// 0.75 on, so that the finest one that is there has a wavelength of 2 to 4 pixels: what stereo
// matching lives on, and no aliasing beyond what the blend's skirts leave.
//
// Cells are counted in integers from an anchor in doubles, so that the pattern is the same wherever
// the ray caster's local origin is; it repeats after 2^31 cells.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "sim/lidar/ray_lanes.h"

namespace rigwire::sim {

inline constexpr int kMostOctaves = 14;

/// Where the points are.
struct GrainPoints {
  LaneArray x, y, z;       ///< m, from the anchor.
  LaneArray frequency_pm;  ///< Of the first octave.
  LaneArray footprint_m;   ///< Width of a pixel on the surface, above 0.
  LaneArray persistence;   ///< Of an octave against the coarser one before it.
};

/// Anchor of the points' lattice at one frequency: the part of anchor x frequency before the point
/// and behind it, by axis.
struct GrainAnchor {
  struct alignas(32) Cells : std::array<std::int32_t, kLanes> {};
  std::array<Cells, 3> cell{};
  std::array<LaneArray, 3> share{};

  /// Of one lane.
  void set(std::size_t lane, const Eigen::Vector3d& anchor_m, double frequency_pm);
};

struct Grain {
  LaneArray patch;       ///< Of the three coarsest octaves, about -1 .. 1.
  LaneArray brightness;  ///< Of all octaves; rms about 0.4 for one octave of weight 1.
  LaneArray slope_x, slope_y, slope_z;  ///< Of relief: from the third octave on, all alike.
};

void sum_grain(const GrainPoints& points, const GrainAnchor& anchor, Grain& grain);

}  // namespace rigwire::sim
