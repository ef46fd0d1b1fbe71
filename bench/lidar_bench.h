// What the lidar costs and how far its ranges are from the truth, side by side.
#pragma once

#include <cstddef>
#include <vector>

#include "hil/rig/rig_configuration.h"

namespace rigwire::bench {

/// The lidar stage against bare Embree on the same rays: the rig's own scene and machine, all
/// functions in motion, rays from the rig's own mount. One thread, CPU time of the thread. Both are
/// cast slice by slice in turns, so that a disturbance of the host affects both.
struct LidarStageCost {
  int slice_ms = 0;
  std::size_t instances = 0;    ///< In the scene.
  std::size_t rays = 0;         ///< In all rounds.
  std::size_t hits = 0;         ///< Rays that hit.
  double stage_s = 0.0;         ///< SpinningLidar::cast, noise and echo model included.
  double bare_s = 0.0;          ///< Embree's calls alone.
  double begin_slice_s = 0.0;   ///< Scene::begin_slice, mean of one call; in neither of the above.
  double ratio = 0.0;           ///< Rays per second of stage / bare, median over the rounds.
  double least_ratio = 0.0;     ///< Ratio of the worst round.
  double greatest_ratio = 0.0;  ///< Ratio of the best round.
};

/// One entry per length of slice. A round is a revolution of 100 ms. Throws std::invalid_argument
/// when the rig has no lidar, or a number is below 1.
[[nodiscard]] std::vector<LidarStageCost> measure_lidar_stage(const hil::RigConfiguration& rig,
                                                              const std::vector<int>& slices_ms,
                                                              int rounds);

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

}  // namespace rigwire::bench
