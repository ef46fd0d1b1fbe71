// Up to eight firings that are cast together, so that the rays of one laser make one packet.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sim/lidar/ray_lanes.h"

namespace rigwire::sim {

struct FiringBlock {
  std::size_t first = 0;  ///< Index into the firings of this cast.
  std::size_t count = 0;  ///< 1 .. 8.
  FiringLanes lanes;
};

/// Which firing of the block and which laser a lane carries.
struct LaneMap {
  std::array<std::uint8_t, kLanes> firing{};
  std::array<std::uint8_t, kLanes> laser{};
};

}  // namespace rigwire::sim
