#include "bench/weather_drive.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/lidar/counter_noise.h"

namespace rigwire::bench {
namespace {

constexpr double kHeight_m = 2.2;
constexpr double kDrive_mps = 8.0;
constexpr double kMass_kg = 10000.0;

}  // namespace

sim::WeatherParameters constant_weather(const sim::WeatherFrame& frame) {
  sim::WeatherParameters parameters;
  parameters.course = {frame};
  return parameters;
}

std::vector<sim::DustEmitter> wheels_at(SimTime time) {
  const double x_m = kDrive_mps * to_seconds(time);
  const double rate_kgps = sim::road_dust_kgpm(kMass_kg) * kDrive_mps / 4.0;
  std::vector<sim::DustEmitter> wheels;
  for (const double along_m : {0.0, 3.0}) {
    for (const double aside_m : {-0.9, 0.9}) {
      wheels.push_back({.position_W = {x_m + along_m, aside_m, 0.0}, .mass_rate_kgps = rate_kgps});
    }
  }
  return wheels;
}

sim::WeatherBeam bench_beam(std::uint64_t number, LidarPlace place, SimTime time) {
  const double azimuth_rad = 2.0 * std::numbers::pi * sim::counter_uniform(number, 0);
  const double elevation_rad =
      (10.67 - 41.34 * sim::counter_uniform(number, 1)) / 180.0 * std::numbers::pi;
  sim::WeatherBeam beam;
  // The trail ends at the vehicle; a follower drives 15 m behind, another lidar is 80 m to the
  // side.
  const double x_m = kDrive_mps * to_seconds(time) - 15.0;
  beam.start_W = {x_m, place == LidarPlace::in_dust ? 0.0 : 80.0, kHeight_m};
  beam.direction_W = {std::cos(elevation_rad) * std::cos(azimuth_rad),
                      std::cos(elevation_rad) * std::sin(azimuth_rad), std::sin(elevation_rad)};
  if (place == LidarPlace::clear_of_dust) {
    beam.direction_W.y() = std::abs(beam.direction_W.y());
  }
  beam.near_m = 0.9;
  beam.far_m = elevation_rad < 0.0 ? std::min(kHeight_m / -std::sin(elevation_rad), kBenchReach_m)
                                   : kBenchReach_m;
  beam.focus_m = 8.0;  // an HDL-32E's
  beam.divergence_rad = 3e-3;
  beam.time = time;
  beam.draw_key = sim::counter_bits(number, 2);
  return beam;
}

}  // namespace rigwire::bench
