#include "hil/world/view.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <vector>

#include "hil/executive/shelves.h"
#include "sim/scene/scene.h"
#include "sim/weather/scene_weather.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;

/// What is told of ten slices of 100 ms, once a slice.
std::vector<ViewChange> told_of(sim::SceneWeather* weather,
                                std::span<const sim::DustEmitter> emitters = {}) {
  std::vector<ViewChange> told;
  const auto view =
      make_world_view(0, 100ms, [&](ViewChange change) { told.push_back(std::move(change)); });
  const sim::Scene scene;
  Shelves samples;
  for (SimTime t0 = kStart; t0 < kStart + 1s; t0 += 100ms) {
    if (weather != nullptr) {
      weather->advance(t0 + 100ms, emitters);
    }
    view->slice({.t0 = t0,
                 .t1 = t0 + 100ms,
                 .links_at_t0 = {},
                 .links_at_t1 = {},
                 .scene = scene,
                 .weather = weather,
                 .dug = {}},
                samples);
  }
  return told;
}

TEST(WorldView, OfClearAirNothingIsTold) {
  EXPECT_TRUE(told_of(nullptr).empty());
  sim::SceneWeather clear;
  EXPECT_TRUE(told_of(&clear).empty());
}

TEST(WorldView, SteadyFogIsToldOnceAndRisingFogEachTime) {
  sim::WeatherParameters parameters;
  parameters.course = {{.rain_mmph = 4.0, .fog_visibility_m = 40.0}};
  sim::SceneWeather steady(parameters, 1);
  const auto once = told_of(&steady);
  ASSERT_EQ(once.size(), 1U);
  EXPECT_FALSE(once.front().changes_the_scene());
  ASSERT_TRUE(once.front().air);
  EXPECT_EQ(once.front().air->rain_mmph, 4.0);
  // A twentieth of the contrast is left at the meteorological optical range; rain adds a hundredth.
  EXPECT_NEAR(once.front().air->extinction_pm, std::log(20.0) / 40.0, 0.003);

  parameters.course = {{}, {.at = 10s, .fog_visibility_m = 40.0}};
  sim::SceneWeather rising(parameters, 1);
  const auto each = told_of(&rising);
  ASSERT_EQ(each.size(), 10U);
  EXPECT_NEAR(each.back().air->extinction_pm / each.front().air->extinction_pm, 10.0, 1e-6);
}

TEST(WorldView, PuffsOfDustAreToldWhereTheyAre) {
  sim::WeatherParameters parameters;
  parameters.course = {{.dryness = 1.0}};
  sim::SceneWeather weather(parameters, 1);
  const std::array<sim::DustEmitter, 1> emitters{
      {{.position_W = {3.0, 4.0, 0.5}, .mass_rate_kgps = 0.01, .height_over_ground_m = 0.5}}};
  const auto told = told_of(&weather, emitters);
  ASSERT_FALSE(told.empty());
  ASSERT_TRUE(told.back().air);
  ASSERT_EQ(told.back().air->dust.size(), weather.dust().puffs().size());
  const AirView::Puff& puff = told.back().air->dust.front();
  EXPECT_NEAR((puff.centre_W - Eigen::Vector3d(3.0, 4.0, 0.5)).norm(), 0.0, 0.5);
  EXPECT_GT(puff.depth, 0.0);
}

}  // namespace
}  // namespace rigwire::hil
