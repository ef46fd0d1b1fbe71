// What lidars cost in a forest of ten million triangles, with bodies that move in it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "sim/scene/scene.h"
#include "sim/scene/scene_description.h"

namespace rigwire::bench {

/// A place where a vehicle drives straight on at 5 m/s for some seconds.
struct LidarLoadPlace {
  std::string name;
  std::unique_ptr<sim::Scene> scene;
  Eigen::Vector3d start_m = Eigen::Vector3d::Zero();  ///< Middle of the lidars.
  double yaw_rad = 0.0;
};

/// 2500 instances of four trees of 4000 triangles each on gentle hills.
[[nodiscard]] LidarLoadPlace make_instanced_forest();

/// A scene of the configurations, from the origin eastwards.
[[nodiscard]] LidarLoadPlace make_described_place(const std::string& name,
                                                  const sim::SceneDescription& description);

struct LidarLoadCase {
  int lidars = 1;
  int threads = 1;  ///< Threads that cast for each lidar, one lidar after the other.
  int slice_ms = 5;
  int revolutions = 7;  ///< Number of revolutions of 100 ms.
};

/// HDL-32E at 10 Hz on the corners of the vehicle, 20 bodies in motion around it.
struct LidarLoad {
  std::string place;
  LidarLoadCase of;
  std::size_t instances = 0;  ///< Ground, trees and the parts of moving bodies.
  std::size_t rays = 0;
  double hit_share = 0.0;
  double stage_s = 0.0;         ///< CPU time of all casting, on all threads.
  double bare_s = 0.0;          ///< Embree's calls on the same rays, on one thread.
  double begin_slice_s = 0.0;   ///< CPU time of one Scene::begin_slice, mean.
  double core_share = 0.0;      ///< CPU time of casting and begin_slice, all threads, per
                                ///< simulated time.
  double wall_share = 0.0;      ///< Elapsed per simulated time: below 1 is real time.
  double encoding_share = 0.0;  ///< CPU time of the devices' packets over that of casting.
  double bare_ratio = 0.0;      ///< bare_s / stage_s, median over the revolutions.
};

/// One case after the other along the way. Throws std::invalid_argument when a number is below 1,
/// or `lidars` above 4.
[[nodiscard]] std::vector<LidarLoad> measure_lidar_load(LidarLoadPlace place,
                                                        const std::vector<LidarLoadCase>& cases);

}  // namespace rigwire::bench
