// What the lidar's benchmarks look at, and with which head: independent of rigs and devices, so
// that figures stay comparable when those change.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sim/link_motion.h"
#include "sim/samples/lidar_sample.h"
#include "sim/scene/scene.h"

namespace rigwire::bench {

inline constexpr Duration kBenchRevolution = std::chrono::milliseconds{100};

/// A head as the HDL-32E: elevations, firing times, exit points.
[[nodiscard]] LidarPattern bench_head();
[[nodiscard]] SamplePlan bench_firing_plan();
/// 600 rpm.
[[nodiscard]] LidarCommand bench_rotor();

/// A scene and the pose of a lidar in it.
struct LidarCase {
  std::string name;
  std::unique_ptr<sim::Scene> scene;
  sim::LinkMotion mount;

  /// Makes the scene ready for one revolution from the start.
  void begin_revolution() const;
};

/// A level plane of 400 m, the lidar 2.5 m above its middle.
[[nodiscard]] LidarCase level_ground_case();

/// The pit of the default scene with 80 boulders, the lidar 3.2 m above its floor.
[[nodiscard]] LidarCase pit_case();

/// Every triangle of a scene in the world, in double.
struct WorldTriangles {
  std::vector<Eigen::Vector3d> vertices_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Returns the triangles of pit_case(), equal to those that its rays hit, to the rounding of
/// vertices to floats.
[[nodiscard]] WorldTriangles pit_triangles();

}  // namespace rigwire::bench
