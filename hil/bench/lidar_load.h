// What lidars cost in a forest of ten million triangles, with bodies that move in it.
#pragma once

#include <cstddef>
#include <vector>

namespace rigwire::hil {

struct LidarLoadCase {
  int lidars = 1;
  int threads = 1;  ///< That cast for each lidar, one lidar after the other.
  int slice_ms = 5;
  int revolutions = 3;  ///< Of 100 ms.
};

/// HDL-32E at 10 Hz on the corners of a vehicle that drives through the forest at 5 m/s.
struct LidarLoad {
  LidarLoadCase of;
  std::size_t instances = 0;  ///< Ground, trees and the parts of moving bodies.
  std::size_t triangles = 0;  ///< As if every tree were a mesh of its own.
  std::size_t rays = 0;
  double hit_share = 0.0;
  double stage_s = 0.0;         ///< CPU time of all casting, of this thread.
  double bare_s = 0.0;          ///< Embree's calls on the same rays; 0 where not measured.
  double begin_slice_s = 0.0;   ///< CPU time of one Scene::begin_slice, mean.
  double core_share = 0.0;      ///< CPU time of casting and begin_slice, all threads, per
                                ///< simulated time.
  double wall_share = 0.0;      ///< Elapsed per simulated time: below 1 is real time.
  double encoding_share = 0.0;  ///< CPU time of the devices' packets over that of casting.
  double bare_ratio = 0.0;      ///< bare_s / stage_s, median over the revolutions.
};

/// Throws std::invalid_argument when a number is below 1, or `lidars` above 4.
[[nodiscard]] std::vector<LidarLoad> measure_lidar_load(const std::vector<LidarLoadCase>& cases);

}  // namespace rigwire::hil
