// What the lidar costs and how far its ranges are from the truth, side by side.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rigwire::hil {

/// The lidar stage against bare Embree on the very same rays, in the standard pit, one thread,
/// processor time of the thread, best of several rounds.
struct LidarStageCost {
  std::size_t rays = 0;    ///< One revolution of an HDL-32E at 600 rpm.
  double hit_share = 0.0;  ///< Of the rays.
  double stage_s = 0.0;    ///< SpinningLidar::cast, noise and echo model included.
  double bare_s = 0.0;     ///< Embree's calls alone.
  double stage_rays_per_s = 0.0;
  double bare_rays_per_s = 0.0;
  double ratio = 0.0;  ///< stage / bare rays per second, 1 = free; the goal is 0.8.
};

/// `slice_ms`: length of the slices that the revolution is cast in, a divisor of 100.
[[nodiscard]] LidarStageCost measure_lidar_stage(int slice_ms, int rounds);

/// Error of the cast range against a closed form in double, over one revolution.
struct LidarRangeError {
  double map_offset_m = 0.0;  ///< Distance of the scene from the map origin.
  std::size_t rays = 0;       ///< Compared.
  std::size_t leaks = 0;      ///< Rays that should have hit and did not, or the other way round.
  double rms_m = 0.0;
  double worst_m = 0.0;
};

/// A plane and a box, seen by a moving and turning sensor, at each of the offsets.
[[nodiscard]] std::vector<LidarRangeError> measure_lidar_range_error(
    const std::vector<double>& map_offsets_m);

/// Processor time of Scene::begin_slice in the standard pit with the links of a machine.
struct RecommitCost {
  std::size_t instances = 0;
  std::size_t moving_instances = 0;
  double mean_s = 0.0;
};
[[nodiscard]] RecommitCost measure_recommit(std::size_t links, int slices);

}  // namespace rigwire::hil
