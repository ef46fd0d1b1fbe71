// Rays against geometry that is known exactly: closed meshes seen from inside, and bodies that move
// while the scene is rebuilt more or less often.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rigwire::bench {

/// A closed mesh of 20 480 triangles, seen by a head at random places and attitudes inside.
struct LidarLeaks {
  std::uint64_t rays = 0;
  std::uint64_t leaks = 0;    ///< Rays that got out.
  std::uint64_t strayed = 0;  ///< Rays that hit farther away than the mesh reaches.
};

/// Counts leaks over at least `rays` rays.
[[nodiscard]] LidarLeaks count_lidar_leaks(std::uint64_t rays);

/// A plate at the end of a boom of 8 m that swings at 1 rad/s, against the closed form at each
/// ray's own instant.
struct RebuildInterval {
  int slice_ms = 0;
  bool blended = true;  ///< Bodies move during the slice; otherwise they are fixed at their
                        ///< poses at its middle.
  std::size_t rays = 0;
  std::size_t missed =
      0;  ///< Rays that hit the plate in one of the two only, 20 mm inside its rim.
  double rms_m = 0.0;
  double worst_m = 0.0;
  double begin_slice_s = 0.0;  ///< CPU time of one Scene::begin_slice, mean.
  double core_share = 0.0;     ///< CPU time of Scene::begin_slice per simulated time.
};

/// Ten revolutions at each length, blended and not. Throws std::invalid_argument for a length below
/// 1 ms.
[[nodiscard]] std::vector<RebuildInterval> measure_rebuild_intervals(
    const std::vector<int>& slices_ms);

}  // namespace rigwire::bench
