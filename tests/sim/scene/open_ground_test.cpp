#include "sim/scene/open_ground.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/scene/scene_description.h"

namespace rigwire::sim {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(OpenGround, SlopeRisesTowardsItsDirection) {
  LevelTerrain level;
  level.size_m = 100.0;
  level.roughness_m = 0.0;
  level.slope = {0.02, 0.5 * std::numbers::pi, 3.0};
  const HeightField field = make_level(level, 1);
  EXPECT_NEAR(field.height_m(17.3, 20.0), 3.4, 1e-9);
  EXPECT_NEAR(field.height_m(-44.0, -50.0), 2.0, 1e-9);
}

TEST(OpenGround, HillsHaveTheirDeviation) {
  HillsTerrain hills;
  hills.size_m = 600.0;
  hills.cell_m = 2.0;
  hills.longest_wave_m = 40.0;
  hills.roughness_m = 1.5;
  const HeightField field = make_hills(hills, 8);
  double sum = 0.0;
  double squares = 0.0;
  for (const double height : field.heights_m) {
    sum += height;
    squares += height * height;
  }
  const double count = static_cast<double>(field.heights_m.size());
  EXPECT_NEAR(std::sqrt(squares / count - std::pow(sum / count, 2)), 1.5, 0.3);
}

TEST(OpenGround, EveryKindOfTerrainIsBuiltAndThePitIsTheDefault) {
  EXPECT_EQ(make_terrain({}, {}, 4).heights_m, make_pit({}, 4).heights_m);
  EXPECT_EQ(make_terrain(HillsTerrain{}, {}, 4).heights_m, make_hills({}, 4).heights_m);
  EXPECT_EQ(make_terrain(LevelTerrain{}, {}, 4).heights_m, make_level({}, 4).heights_m);
}

TEST(OpenGround, RefusesNonsenseByName) {
  HillsTerrain hills;
  hills.longest_wave_m = 0.1;
  EXPECT_THAT([&] { validate(hills); }, ThrowsMessage<std::invalid_argument>(
                                            HasSubstr("longest_wave: two cells or more, found")));
  LevelTerrain level;
  level.slope.rise = std::nan("");
  EXPECT_THAT([&] { validate(level); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("slope.rise: found")));
}

}  // namespace
}  // namespace rigwire::sim
