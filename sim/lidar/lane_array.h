// Eight numbers side by side, as many as Embree's packets have rays.
#pragma once

#include <array>
#include <cstddef>

namespace rigwire::sim {

inline constexpr std::size_t kLanes = 8;

/// One value per lane.
struct alignas(32) LaneArray : std::array<float, kLanes> {};

}  // namespace rigwire::sim
