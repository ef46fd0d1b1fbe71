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
  LaneArray frequency_pm;  ///< One over the cell of the first octave.
  LaneArray upright;       ///< Ratio of the frequency along z to that.
  LaneArray footprint_m;   ///< Width of a pixel on the surface, above 0.
  LaneArray persistence;   ///< Weight of an octave relative to the next coarser one.
};

/// Anchor of the points' lattice at one frequency: the part of anchor x frequency before the point
/// and behind it, by axis.
struct GrainAnchor {
  struct alignas(32) Cells : std::array<std::int32_t, kLanes> {};
  std::array<Cells, 3> cell{};
  std::array<LaneArray, 3> share{};

  /// Sets one lane.
  void set(std::size_t lane, const Eigen::Vector3d& anchor_m, double frequency_pm,
           double upright = 1.0);
};

struct Grain {
  LaneArray patch;       ///< Sum of the three coarsest octaves, about -1 .. 1.
  LaneArray brightness;  ///< Sum of all octaves; rms about 0.4 for one octave of weight 1.
  LaneArray slope_x, slope_y, slope_z;  ///< Relief: octaves from the third on, all alike.
};

void sum_grain(const GrainPoints& points, const GrainAnchor& anchor, Grain& grain);

/// Where stones lie: the anchor of their own lattice, in its first cells, by axis.
struct StoneAnchor {
  std::array<std::int32_t, 3> cell{};
  std::array<float, 3> share{};

  StoneAnchor() = default;
  explicit StoneAnchor(const Eigen::Vector3d& anchor_m);
};

/// Stones in the ground at eight points.
struct Stones {
  LaneArray share;                      ///< 0 .. 1 of the point is stone.
  LaneArray tone;                       ///< Brightness of that stone against the mean one.
  LaneArray gap;                        ///< Light that is left between stones.
  LaneArray slope_x, slope_y, slope_z;  ///< Slope of the stone's dome, in space.
};

/// `density`: share of the lattice's cells that hold a stone; 0 in lanes without stones.
///
/// Seven lattices of cubes, cells of 0.8 m down to 12.5 mm, turned so that their rows do not run
/// with the world's; a cell holds one stone at most, a sphere of 0.14 .. 0.38 of its edge in radius
/// with corners broken off, all of it within the cell, so that a point asks one cell of each
/// lattice. Fewer cells of the coarse lattices are filled: the number of stones above a size falls
/// with its 3rd power and faster. Ground cuts the spheres: larger stones lie over smaller ones. A
/// lattice counts in full where a cell is 5 pixels wide, and not at all from 2.5 on.
void lay_stones(const GrainPoints& points, const StoneAnchor& anchor, const LaneArray& density,
                Stones& stones);

}  // namespace rigwire::sim
