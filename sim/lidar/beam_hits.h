// Hits of the sub-rays of eight beams.
#pragma once

#include <limits>

#include "sim/lidar/ray_lanes.h"

namespace rigwire::sim {

/// What one sub-ray of each of eight beams has hit.
struct SubRayHits {
  static constexpr float kNothing = std::numeric_limits<float>::infinity();

  LaneArray range_m;     ///< kNothing: nothing within reach.
  LaneArray energy;      ///< In the unit of link_budget.h; 0: no echo from there.
  LaneArray brightness;  ///< Energy times range squared.
  LaneArray patch_m;     ///< Half the depth of the surface between it and its neighbours.
};

}  // namespace rigwire::sim
