// The lidar's scene and rays for another ray caster, so that both are measured on the very same
// shots: scripts/lidar-peer.py runs the peers that are installed and compares.
#pragma once

#include <cstddef>
#include <filesystem>

namespace rigwire::bench {

/// One revolution in pit_case(): 69 440 rays. Single thread, CPU time, minimum of `rounds`.
struct LidarPeerFigures {
  std::size_t triangles = 0;
  std::size_t rays = 0;
  std::size_t hits = 0;
  double stage_s = 0.0;  ///< SpinningLidar::cast, echo model and noise included.
  double bare_s = 0.0;   ///< Embree's calls alone.
};

/// Writes, all numbers little-endian:
///   scene.ply   triangles in world coordinates (east, north, up; m): binary PLY, double vertices
///   rays.f64    start x y z, unit direction x y z of each ray, in double
///   ranges.f32  what our rays found, in the same order; 0: nothing within 100 m
/// An empty path writes nothing. Throws std::invalid_argument when rounds < 1, std::runtime_error
/// when a file cannot be written.
[[nodiscard]] LidarPeerFigures measure_and_write_for_peers(const std::filesystem::path& folder,
                                                           int rounds);

}  // namespace rigwire::bench
