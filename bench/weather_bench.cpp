#include "bench/weather_bench.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/cost.h"
#include "bench/weather_drive.h"
#include "bench/weather_reference.h"
#include "sim/lidar/counter_noise.h"
#include "sim/lidar/velodyne_heads.h"
#include "sim/weather/scene_weather.h"

namespace rigwire::bench {
namespace {

using namespace std::chrono_literals;

constexpr Duration kDrive = 10s;
constexpr double kStep_m = 0.02;
constexpr int kCompared = 48;

struct WeatherCase {
  std::string medium;
  sim::WeatherParameters parameters;
  LidarPlace place = LidarPlace::clear_of_dust;
};

std::vector<WeatherCase> weather_cases() {
  sim::WeatherParameters goodin = constant_weather({.rain_mmph = 10.0});
  goodin.rain.model = sim::RainModel::goodin;
  sim::WeatherParameters layer = constant_weather({.fog_visibility_m = 50.0});
  layer.fog.base_height_m = 1.0;
  layer.fog.scale_height_m = 3.0;
  const sim::WeatherFrame dry{.dryness = 1.0};
  // Fog that only weakens: its own echoes are drawn, and not to be found in small steps.
  sim::WeatherParameters dark = constant_weather({.fog_visibility_m = 100.0, .dryness = 1.0});
  dark.fog.backscatter = 0.0;
  return {{"clear", {}},
          {"rain 1 mm/h", constant_weather({.rain_mmph = 1.0})},
          {"rain 10 mm/h", constant_weather({.rain_mmph = 10.0})},
          {"rain 50 mm/h", constant_weather({.rain_mmph = 50.0})},
          {"rain 10 mm/h, Goodin", goodin},
          {"fog 200 m", constant_weather({.fog_visibility_m = 200.0})},
          {"fog 50 m", constant_weather({.fog_visibility_m = 50.0})},
          {"fog 50 m, layer", layer},
          {"dust, beside it", constant_weather(dry)},
          {"dust, in the trail", constant_weather(dry), LidarPlace::in_dust},
          {"dust, dark fog 100 m", dark, LidarPlace::in_dust}};
}

void compare(const WeatherCase& weather_case, const sim::SceneWeather& weather,
             const std::vector<sim::WeatherBeam>& beams, WeatherCost& cost) {
  const double begin_s = hil::thread_cpu_seconds();
  std::vector<MarchedBeam> marched;
  marched.reserve(kCompared);
  for (int i = 0; i < kCompared; ++i) {
    marched.push_back(march_beam(weather_case.parameters, weather.dust().puffs(),
                                 beams[static_cast<std::size_t>(i)], kStep_m));
  }
  cost.reference_ns = 1e9 * (hil::thread_cpu_seconds() - begin_s) / kCompared;
  for (std::size_t i = 0; i < kCompared; ++i) {
    const sim::AirPath path = weather.along(beams[i]);
    cost.transmission_error =
        std::max(cost.transmission_error, std::abs(path.transmission - marched[i].transmission));
    const sim::AirEcho& expected = marched[i].dust;
    // Echoes near the detection limit: either method may see nothing.
    if (expected.energy < 1.1 * beams[i].detection_energy) {
      continue;
    }
    double energy_error = 1.0;
    double range_error_m = beams[i].far_m;
    for (std::size_t k = 0; k < path.echo_count; ++k) {
      const double apart_m = std::abs(path.echoes[k].range_m - expected.range_m);
      if (apart_m < range_error_m) {
        range_error_m = apart_m;
        energy_error = std::abs(path.echoes[k].energy / expected.energy - 1.0);
      }
    }
    cost.echo_energy_error = std::max(cost.echo_energy_error, energy_error);
    cost.echo_range_error_m = std::max(cost.echo_range_error_m, range_error_m);
  }
}

}  // namespace

std::vector<WeatherCost> measure_weather_cost() {
  std::vector<WeatherCost> costs;
  for (const WeatherCase& weather_case : weather_cases()) {
    sim::SceneWeather weather(weather_case.parameters, 1);
    for (SimTime time = kStart; time <= kStart + kDrive; time += sim::SceneWeather::kGrid) {
      weather.advance(time, wheels_at(time));
    }
    std::vector<sim::WeatherBeam> beams;
    for (std::uint64_t i = 0; i < kCostVariants; ++i) {
      beams.push_back(bench_beam(i, weather_case.place, kStart + kDrive));
    }
    WeatherCost cost;
    cost.medium = weather_case.medium;
    sim::AirPath path;
    cost.beam_ns = nanoseconds_of([&](int i) {
      path = weather.along(beams[static_cast<std::size_t>(i)]);
      keep(&path);
    });
    for (const sim::WeatherBeam& beam : beams) {
      cost.echo_share += (weather.along(beam).echo_count > 0 ? 1.0 : 0.0) / kCostVariants;
    }
    if (!weather_case.parameters.course.empty()) {
      compare(weather_case, weather, beams, cost);
    }
    costs.push_back(cost);
  }
  return costs;
}

std::vector<RainReturns> measure_rain_returns(int beams) {
  std::vector<RainReturns> rows;
  for (const double rate_mmph : {1.0, 5.0, 10.0, 30.0, 100.0}) {
    const sim::WeatherParameters parameters = constant_weather({.rain_mmph = rate_mmph});
    const sim::SceneWeather weather(parameters, 1);
    sim::WeatherBeam beam;
    beam.far_m = kBenchReach_m;
    beam.divergence_rad = 3e-3;
    RainReturns row;
    row.rain_mmph = rate_mmph;
    row.beams = beams;
    row.extinction_pm = weather.even_extinction_pm(kStart);
    row.integrated_extinction_pm = integrated_rain_extinction_pm(rate_mmph, parameters.rain);
    const double drops =
        expected_drop_echoes(rate_mmph, row.integrated_extinction_pm, parameters.rain, beam);
    row.expected_share = -std::expm1(-drops);
    int returned = 0;
    for (int i = 0; i < beams; ++i) {
      beam.draw_key = sim::counter_bits(static_cast<std::uint64_t>(i), 7);
      returned += weather.along(beam).echo_count > 0 ? 1 : 0;
    }
    row.counted_share = static_cast<double>(returned) / beams;
    row.sigma = std::sqrt(row.expected_share * (1.0 - row.expected_share) / beams);
    rows.push_back(row);
  }
  return rows;
}

// Counts beams with an echo and compares with 1 - exp(-expected echoes); sigma is that of the
// binomial share.
std::vector<FogReturns> measure_fog_returns(int beams) {
  std::vector<FogReturns> rows;
  const sim::SpinningLidarParameters receiver = sim::velodyne_head("HDL-32E").receiver;
  for (const double visibility_m : {20.0, 40.0, 60.0, 100.0, 200.0}) {
    const sim::WeatherParameters parameters = constant_weather({.fog_visibility_m = visibility_m});
    const sim::SceneWeather weather(parameters, 1);
    sim::WeatherBeam beam;
    beam.near_m = receiver.air_minimum_range_m;
    beam.far_m = kBenchReach_m;
    beam.focus_m = receiver.air_focus_range_m;
    beam.detection_energy = sim::detection_energy(receiver.air_reference_range_m);
    const ExpectedClutter expected = expected_clutter(visibility_m, parameters.fog, beam);
    FogReturns row;
    row.visibility_m = visibility_m;
    row.beams = beams;
    row.expected_share = -std::expm1(-expected.echoes);
    row.expected_mean_range_m = expected.mean_range_m;
    int returned = 0;
    int echoes = 0;
    for (int i = 0; i < beams; ++i) {
      beam.draw_key = sim::counter_bits(static_cast<std::uint64_t>(i), 7);
      const sim::AirPath path = weather.along(beam);
      returned += path.echo_count > 0 ? 1 : 0;
      for (std::size_t k = 0; k < path.echo_count; ++k, ++echoes) {
        row.mean_range_m += path.echoes[k].range_m;
      }
    }
    row.mean_range_m /= std::max(echoes, 1);
    row.counted_share = static_cast<double>(returned) / beams;
    row.sigma = std::sqrt(row.expected_share * (1.0 - row.expected_share) / beams);
    rows.push_back(row);
  }
  return rows;
}

DustStepCost measure_dust_step() {
  sim::SceneWeather weather(constant_weather({.wind_mps = 3.0, .dryness = 1.0}), 1);
  const auto advance = [&](Duration span, SimTime from) {
    int steps = 0;
    for (SimTime time = from; time < from + span; time += sim::SceneWeather::kGrid) {
      weather.advance(time, wheels_at(time));
      ++steps;
    }
    return steps;
  };
  advance(kDrive, kStart);
  const double begin_s = hil::thread_cpu_seconds();
  const int steps = advance(kDrive, kStart + kDrive);
  return {weather.dust().puffs().size(), 1e6 * (hil::thread_cpu_seconds() - begin_s) / steps};
}

}  // namespace rigwire::bench
