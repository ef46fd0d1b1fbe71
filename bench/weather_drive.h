// The drive that the weather is measured on: a vehicle of 10 t at 8 m/s over level dry ground, and
// a lidar 2.2 m above it.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/samples/time.h"
#include "sim/weather/dust_emitter.h"
#include "sim/weather/weather.h"
#include "sim/weather/weather_parameters.h"

namespace rigwire::bench {

inline constexpr double kBenchReach_m = 100.0;

[[nodiscard]] sim::WeatherParameters constant_weather(const sim::WeatherFrame& frame);

/// The four wheels at that time.
[[nodiscard]] std::vector<sim::DustEmitter> wheels_at(SimTime time);

enum class LidarPlace {
  clear_of_dust,  ///< 80 m beside the trail, looking away from it.
  in_dust,        ///< On a follower, 15 m behind.
};

/// One of the beams of a lidar with elevations from 10.67 to -30.67 degrees, all round, up to the
/// ground or the end of its reach.
[[nodiscard]] sim::WeatherBeam bench_beam(std::uint64_t number, LidarPlace place, SimTime time);

}  // namespace rigwire::bench
