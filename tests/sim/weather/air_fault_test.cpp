// What comes into the air beside its course is what a course with it would be.
#include "sim/weather/air_fault.h"

#include <gtest/gtest.h>

#include <memory>

#include "sim/camera/camera_air.h"
#include "sim/weather/scene_weather.h"

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;

WeatherBeam beam_at(SimTime time) {
  WeatherBeam beam;
  beam.start_W = {0.0, 0.0, 2.0};
  beam.far_m = 60.0;
  beam.divergence_rad = 3e-3;
  beam.time = time;
  beam.draw_key = 7;
  return beam;
}

double transmission(const WeatherParameters& parameters, std::shared_ptr<const AirFaults> faults,
                    SimTime time) {
  SceneWeather weather(parameters, 1, std::move(faults));
  weather.advance(time, {});
  return weather.along(beam_at(time)).transmission;
}

WeatherParameters raining() {
  WeatherParameters parameters;
  parameters.course = {{.rain_mmph = 5.0, .fog_visibility_m = 200.0}};
  return parameters;
}

TEST(AirFault, AddsToTheCourseWhileItHolds) {
  const auto faults = std::make_shared<AirFaults>(std::vector<AirFault>{
      {{1s, 2s}, RainFault{.rate_mmph = 10.0}}, {{1s, 2s}, FogFault{.visibility_m = 200.0}}});
  WeatherParameters both;
  both.course = {{.rain_mmph = 15.0, .fog_visibility_m = 100.0}};
  const double course = transmission(raining(), nullptr, kStart + 2s);
  EXPECT_DOUBLE_EQ(transmission(raining(), faults, kStart + 980ms), course);
  EXPECT_DOUBLE_EQ(transmission(raining(), faults, kStart + 2s),
                   transmission(both, nullptr, kStart + 2s));
  EXPECT_LT(transmission(both, nullptr, kStart + 2s), course);
  EXPECT_DOUBLE_EQ(transmission(raining(), faults, kStart + 3s), course);
}

TEST(AirFault, FogGrowsByItsExtinctionInClearAir) {
  const auto faults = std::make_shared<AirFaults>(
      std::vector<AirFault>{{{1s, 9s}, FogFault{.visibility_m = 50.0, .ramp = 2s}}});
  WeatherParameters half;
  half.course = {{.fog_visibility_m = 100.0}};
  EXPECT_DOUBLE_EQ(transmission({}, faults, kStart + 1s), 1.0);
  EXPECT_DOUBLE_EQ(transmission({}, faults, kStart + 2s), transmission(half, nullptr, kStart + 2s));
}

TEST(AirFault, BegunWhileItIsLookedThroughItIsThere) {
  const auto faults = std::make_shared<AirFaults>();
  SceneWeather weather({}, 1, faults);
  weather.advance(kStart + 1s, {});
  EXPECT_FALSE(weather.present());
  faults->apply({.begin = AirFault{{1500ms, 1s}, SnowFault{.rate_mmph = 5.0}}});
  weather.advance(kStart + 2s, {});
  EXPECT_TRUE(weather.present());
  EXPECT_LT(weather.along(beam_at(kStart + 2s)).transmission, 1.0);
  faults->apply({.begin = {}, .end_of = 1, .end_at = kStart + 2100ms});
  weather.advance(kStart + 2200ms, {});
  EXPECT_DOUBLE_EQ(weather.along(beam_at(kStart + 2200ms)).transmission, 1.0);
}

TEST(AirFault, CamerasLookThroughTheSameAir) {
  const AirFaults faults({{{1s, 2s}, RainFault{.rate_mmph = 10.0}}});
  EXPECT_EQ(CameraAir(raining(), kStart, nullptr, &faults).rain_mmph(), 5.0);
  EXPECT_EQ(CameraAir(raining(), kStart + 2s, nullptr, &faults).rain_mmph(), 15.0);
}

}  // namespace
}  // namespace rigwire::sim
