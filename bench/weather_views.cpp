#include "bench/weather_views.h"

#include <cmath>

#include "bench/weather_drive.h"
#include "sim/weather/scene_weather.h"

namespace rigwire::bench {
namespace {

using namespace std::chrono_literals;

constexpr double kGroundReflectance = 0.3;
constexpr std::uint64_t kBeams = 6000;
constexpr double kWeatherViewsStep_m = 2.0;
/// A bucket that empties 1 m3/s, 3 m above the ground, 7 m before the lidar.
constexpr double kBucket_m = 7.0;
constexpr double kFall_m = 3.0;
constexpr double kFlow_m3ps = 1.0;

}  // namespace

std::vector<TransmissionCurve> transmission_curves() {
  struct Medium {
    std::string name;
    sim::WeatherParameters parameters;
  };
  sim::WeatherParameters goodin = constant_weather({.rain_mmph = 10.0});
  goodin.rain.model = sim::RainModel::goodin;
  const std::vector<Medium> media{{"rain 10 mm/h", constant_weather({.rain_mmph = 10.0})},
                                  {"rain 50 mm/h", constant_weather({.rain_mmph = 50.0})},
                                  {"rain 10 mm/h, Goodin", goodin},
                                  {"snow 2 mm/h", constant_weather({.snow_mmph = 2.0})},
                                  {"haze 5 km", constant_weather({.haze_visibility_m = 5000.0})},
                                  {"fog 200 m", constant_weather({.fog_visibility_m = 200.0})},
                                  {"fog 50 m", constant_weather({.fog_visibility_m = 50.0})}};
  std::vector<TransmissionCurve> curves;
  for (const Medium& medium : media) {
    const sim::SceneWeather weather(medium.parameters, 1);
    TransmissionCurve curve{medium.name, {}, {}};
    const int steps = static_cast<int>(kBenchReach_m / kWeatherViewsStep_m);
    for (int step = 0; step <= steps; ++step) {
      const double range_m = step * kWeatherViewsStep_m;
      sim::WeatherBeam beam;
      beam.far_m = range_m;
      curve.range_m.push_back(range_m);
      curve.two_way.push_back(weather.along(beam).transmission);
    }
    curves.push_back(curve);
  }
  return curves;
}

/// Dust of falling soil after 1.5 s, and the strongest return of each beam: from the ground,
/// reflectance times transmission over range squared, or from the dust.
DustView dust_view() {
  constexpr SimTime kEnd = kStart + 1500ms;
  sim::SceneWeather weather(
      constant_weather({.wind_mps = 2.0, .wind_from_rad = 3.4, .dryness = 10.0}), 1);
  const sim::DustEmitter bucket{
      .position_W = {kBucket_m, 0.0, 0.5 * kFall_m},
      .radius_m = 0.5 + 0.25 * kFall_m,
      .mass_rate_kgps = kFlow_m3ps * sim::dropped_soil_dust_kgpm3(kFall_m),
      .height_over_ground_m = 0.5 * kFall_m};
  for (SimTime time = kStart; time <= kEnd; time += sim::SceneWeather::kGrid) {
    weather.advance(time, {&bucket, 1});
  }
  DustView view;
  view.puffs.assign(weather.dust().puffs().begin(), weather.dust().puffs().end());
  for (std::uint64_t i = 0; i < kBeams; ++i) {
    sim::WeatherBeam beam = bench_beam(i, LidarPlace::in_dust, kEnd);
    beam.start_W.head<2>().setZero();
    view.sensor_x_m = beam.start_W.x();
    view.sensor_y_m = beam.start_W.y();
    const sim::AirPath path = weather.along(beam);
    const bool to_ground = beam.far_m < kBenchReach_m;
    double energy = to_ground ? kGroundReflectance * -beam.direction_W.z() * path.transmission /
                                    (beam.far_m * beam.far_m)
                              : 0.0;
    double range_m = beam.far_m;
    bool from_dust = false;
    if (energy < beam.detection_energy) {
      energy = 0.0;
    }
    for (std::size_t k = 0; k < path.echo_count; ++k) {
      if (path.echoes[k].energy > energy) {
        energy = path.echoes[k].energy;
        range_m = path.echoes[k].range_m;
        from_dust = true;
      }
    }
    if (energy > 0.0) {
      const Eigen::Vector3d point_W = beam.start_W + range_m * beam.direction_W;
      view.returns.push_back({point_W.x(), point_W.y(), from_dust});
    } else if (to_ground) {
      ++view.lost;
    }
  }
  return view;
}

}  // namespace rigwire::bench
