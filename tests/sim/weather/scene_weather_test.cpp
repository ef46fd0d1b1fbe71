#include "sim/weather/scene_weather.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <thread>
#include <vector>

#include "sim/lidar/counter_noise.h"

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;

constexpr double kFar_m = 60.0;

WeatherParameters dusty_storm() {
  WeatherParameters parameters;
  parameters.course = {
      {.rain_mmph = 5.0,
       .fog_visibility_m = 80.0,
       .wind_mps = 4.0,
       .wind_from_rad = 1.0,
       .dryness = 1.0},
      {.at = 2s, .rain_mmph = 40.0, .snow_mmph = 1.0, .wind_mps = 9.0, .dryness = 0.5}};
  return parameters;
}

/// Emitters of a machine that drives east at 5 m/s, at any time.
std::vector<DustEmitter> emitters_at(SimTime time, const Eigen::Vector3d& origin_W) {
  const double x_m = 5.0 * to_seconds(time);
  return {{.position_W = origin_W + Eigen::Vector3d(x_m, 1.0, 0.0), .mass_rate_kgps = 0.05},
          {.position_W = origin_W + Eigen::Vector3d(x_m, -1.0, 0.0), .mass_rate_kgps = 0.05}};
}

WeatherBeam beam_of(std::uint64_t number, SimTime time, const Eigen::Vector3d& origin_W) {
  const double azimuth_rad = 2.0 * std::numbers::pi * counter_uniform(number, 0);
  const double elevation_rad = 0.3 * (counter_uniform(number, 1) - 0.7);
  WeatherBeam beam;
  beam.start_W = origin_W + Eigen::Vector3d(5.0 * to_seconds(time) + 4.0, 0.0, 2.0);
  beam.direction_W = {std::cos(elevation_rad) * std::cos(azimuth_rad),
                      std::cos(elevation_rad) * std::sin(azimuth_rad), std::sin(elevation_rad)};
  beam.near_m = 0.9;
  beam.far_m = kFar_m;
  beam.divergence_rad = 3e-3;
  beam.time = time;
  beam.draw_key = counter_bits(number, 2);
  return beam;
}

/// Two seconds of beams, one every 0.1 ms, with time cut into slices of that length.
std::vector<AirPath> run(const WeatherParameters& parameters, std::uint64_t seed, Duration slice,
                         const Eigen::Vector3d& origin_W = Eigen::Vector3d::Zero()) {
  SceneWeather weather(parameters, seed);
  std::vector<AirPath> paths;
  std::uint64_t number = 0;
  for (SimTime t0 = kStart; t0 < kStart + 2s; t0 += slice) {
    weather.advance(t0 + slice, emitters_at(t0 + slice, origin_W));
    for (SimTime time = t0 + 100us; time <= t0 + slice; time += 100us) {
      paths.push_back(weather.along(beam_of(number++, time, origin_W)));
    }
  }
  return paths;
}

bool same(const AirPath& a, const AirPath& b) {
  if (a.transmission != b.transmission || a.echo_count != b.echo_count) {
    return false;
  }
  for (std::size_t i = 0; i < a.echo_count; ++i) {
    if (a.echoes[i].range_m != b.echoes[i].range_m || a.echoes[i].energy != b.echoes[i].energy) {
      return false;
    }
  }
  return true;
}

TEST(SceneWeatherTest, WithoutACourseTheAirIsExactlyClear) {
  SceneWeather weather;
  weather.advance(kStart + 10s, emitters_at(kStart, Eigen::Vector3d::Zero()));
  EXPECT_FALSE(weather.present());
  EXPECT_TRUE(same(weather.along(beam_of(1, kStart + 10s, Eigen::Vector3d::Zero())), AirPath{}));
}

TEST(SceneWeatherTest, ZeroRatesAreExactlyClearAir) {
  WeatherParameters parameters;
  parameters.course = {{.wind_mps = 10.0}, {.at = 1s, .rain_mmph = 0.0, .wind_mps = 3.0}};
  EXPECT_FALSE(parameters.any());
  for (const AirPath& path : run(parameters, 1, 10ms)) {
    ASSERT_TRUE(same(path, AirPath{}));
  }
}

TEST(SceneWeatherTest, RainThatEndsLeavesExactlyClearAir) {
  WeatherParameters parameters;
  parameters.course = {{.rain_mmph = 20.0}, {.at = 1s, .rain_mmph = 0.0}};
  SceneWeather weather(parameters, 1);
  EXPECT_TRUE(weather.present());
  weather.advance(kStart + 900ms, {});
  EXPECT_TRUE(weather.present());
  weather.advance(kStart + 1s, {});
  weather.advance(kStart + 1020ms, {});
  EXPECT_FALSE(weather.present());
  EXPECT_TRUE(same(weather.along(beam_of(1, kStart + 1010ms, Eigen::Vector3d::Zero())), {}));
}

TEST(SceneWeatherTest, KeyFramesAreInterpolatedInTime) {
  WeatherParameters parameters;
  parameters.course = {{.at = 1s, .fog_visibility_m = 100.0, .wind_from_rad = 0.0},
                       {.at = 3s, .rain_mmph = 10.0, .fog_visibility_m = 50.0},
                       {.at = 5s, .fog_visibility_m = 0.0}};
  EXPECT_NEAR(state_at(parameters.course, 0s).inverse_fog_visibility_pm, 0.01, 1e-15);
  EXPECT_NEAR(state_at(parameters.course, 2s).inverse_fog_visibility_pm, 0.015, 1e-15);
  EXPECT_NEAR(state_at(parameters.course, 2s).rain_mmph, 5.0, 1e-12);
  EXPECT_NEAR(state_at(parameters.course, 4s).inverse_fog_visibility_pm, 0.01, 1e-15);
  EXPECT_EQ(state_at(parameters.course, 50s).inverse_fog_visibility_pm, 0.0);
  SceneWeather weather(parameters, 1);
  weather.advance(kStart + 2s, {});
  const double expected_pm = std::log(20.0) * 0.015 + 3.65e-4 * std::pow(5.0, 0.63);
  EXPECT_NEAR(weather.even_extinction_pm(kStart + 2s) / expected_pm, 1.0, 2e-4);
}

TEST(SceneWeatherTest, WindBlowsFromWhereItIsSaid) {
  EXPECT_TRUE(wind_from(3.0, 0.0).isApprox(Eigen::Vector2d(0.0, -3.0)));
  EXPECT_TRUE(wind_from(3.0, 0.5 * std::numbers::pi).isApprox(Eigen::Vector2d(-3.0, 0.0), 1e-12));
}

TEST(SceneWeatherTest, DustDriftsWithTheWindAndItsGusts) {
  WeatherParameters parameters;
  parameters.course = {{.wind_mps = 5.0, .wind_from_rad = 1.5 * std::numbers::pi, .dryness = 1.0}};
  parameters.dust.settling_mps = 0.0;
  SceneWeather weather(parameters, 4);
  const DustEmitter emitter{.position_W = {0, 0, 1.0}, .mass_rate_kgps = 10.0};
  weather.advance(kStart + 20ms, {&emitter, 1});
  Eigen::Vector2d way_m = Eigen::Vector2d::Zero();
  for (int i = 2; i <= 500; ++i) {
    weather.advance(kStart + i * SceneWeather::kGrid, {});
    way_m += to_seconds(SceneWeather::kGrid) * weather.wind_mps();
  }
  ASSERT_EQ(weather.dust().puffs().size(), 1U);
  EXPECT_TRUE(weather.dust().puffs()[0].centre_W.head<2>().isApprox(way_m, 1e-9));
  EXPECT_NEAR(way_m.x(), 5.0 * 10.0, 0.5 * 50.0);
  EXPECT_NE(way_m.y(), 0.0);
}

TEST(SceneWeatherTest, ResultsDoNotDependOnSlices) {
  const auto fine = run(dusty_storm(), 1, 2ms);
  for (const Duration slice : {Duration{5ms}, Duration{20ms}}) {
    const auto coarse = run(dusty_storm(), 1, slice);
    ASSERT_EQ(coarse.size(), fine.size());
    for (std::size_t i = 0; i < fine.size(); ++i) {
      ASSERT_TRUE(same(fine[i], coarse[i])) << i;
    }
  }
}

TEST(SceneWeatherTest, ResultsDoNotDependOnThreads) {
  SceneWeather weather(dusty_storm(), 1);
  const SimTime end = kStart + 2s;
  for (SimTime time = kStart + 20ms; time <= end; time += 20ms) {
    weather.advance(time, emitters_at(time, Eigen::Vector3d::Zero()));
  }
  constexpr std::size_t kBeams = 4000;
  std::vector<AirPath> alone(kBeams);
  std::vector<AirPath> together(kBeams);
  const auto cast = [&](std::vector<AirPath>& paths, std::size_t first, std::size_t step) {
    for (std::size_t i = first; i < kBeams; i += step) {
      paths[i] = weather.along(beam_of(i, end, Eigen::Vector3d::Zero()));
    }
  };
  cast(alone, 0, 1);
  std::vector<std::thread> threads;
  for (std::size_t k = 0; k < 4; ++k) {
    threads.emplace_back(cast, std::ref(together), k, 4);
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  for (std::size_t i = 0; i < kBeams; ++i) {
    ASSERT_TRUE(same(alone[i], together[i])) << i;
  }
}

TEST(SceneWeatherTest, SeedsDecideGustsAndNothingElse) {
  const auto first = run(dusty_storm(), 1, 20ms);
  const auto again = run(dusty_storm(), 1, 20ms);
  const auto other = run(dusty_storm(), 2, 20ms);
  std::size_t different = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    ASSERT_TRUE(same(first[i], again[i]));
    different += same(first[i], other[i]) ? 0 : 1;
  }
  EXPECT_GT(different, 100U);
  WeatherParameters calm = dusty_storm();
  for (WeatherFrame& frame : calm.course) {
    frame.wind_mps = 0.0;
  }
  const auto calm_first = run(calm, 1, 20ms);
  const auto calm_other = run(calm, 2, 20ms);
  for (std::size_t i = 0; i < calm_first.size(); ++i) {
    ASSERT_TRUE(same(calm_first[i], calm_other[i]));
  }
}

TEST(SceneWeatherTest, TenKilometresFromTheOriginEverythingIsTheSame) {
  const auto here = run(dusty_storm(), 1, 20ms);
  const auto there = run(dusty_storm(), 1, 20ms, {10e3, -7e3, 300.0});
  std::size_t other_count = 0;
  for (std::size_t i = 0; i < here.size(); ++i) {
    ASSERT_NEAR(there[i].transmission, here[i].transmission, 1e-9);
    if (there[i].echo_count != here[i].echo_count) {
      ++other_count;  // an echo at the very limit
      continue;
    }
    for (std::size_t k = 0; k < here[i].echo_count; ++k) {
      ASSERT_NEAR(there[i].echoes[k].range_m, here[i].echoes[k].range_m, 1e-6);
      ASSERT_NEAR(there[i].echoes[k].energy, here[i].echoes[k].energy,
                  1e-6 * here[i].echoes[k].energy);
    }
  }
  EXPECT_LE(other_count, 2U);
}

TEST(SceneWeatherTest, DustNearAMachineThatDrivesIsSeen) {
  WeatherParameters parameters;
  parameters.course = {{.wind_mps = 2.0, .dryness = 1.0}};
  std::size_t echoes = 0;
  double least = 1.0;
  for (const AirPath& path : run(parameters, 1, 20ms)) {
    echoes += path.echo_count;
    least = std::min(least, path.transmission);
  }
  EXPECT_GT(echoes, 100U);
  EXPECT_LT(least, 0.7);
}

}  // namespace
}  // namespace rigwire::sim
