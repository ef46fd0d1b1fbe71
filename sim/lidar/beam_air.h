// The air's effect on a beam of sub-rays.
//
// The weather is evaluated only along the middle of the beam. It is assumed to be the same across
// the beam, and to weaken light evenly between the nearest and the farthest surface: exact in rain
// and fog, and where all sub-rays hit one surface. An echo of the air keeps the share of the beam
// that no surface has stopped before it.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "sim/lidar/beam_hits.h"
#include "sim/lidar/echo_detector.h"
#include "sim/weather/weather.h"

namespace rigwire::sim {

struct AirEchoes {
  std::array<EchoPart, kMaxAirEchoes> parts;
  std::size_t count = 0;
};

/// Weakens the hits of one lane and adds the echoes of the air. `beam` is the middle of the beam,
/// far_m its reach. `weights` are those of the sub-rays; hits beyond them (scattered light) are
/// weakened only.
[[nodiscard]] AirEchoes pass_air(const Weather& weather, WeatherBeam beam,
                                 std::span<const float> weights, std::span<SubRayHits> hits,
                                 std::size_t lane);

}  // namespace rigwire::sim
