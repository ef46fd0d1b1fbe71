#include "sim/weather/weather_parameters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>

namespace rigwire::sim {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using namespace std::chrono_literals;

std::string complaint(const std::function<void(WeatherParameters&)>& spoil) {
  WeatherParameters parameters;
  parameters.course = {{.rain_mmph = 5.0}, {.at = 10s, .fog_visibility_m = 100.0}};
  validate(parameters);
  spoil(parameters);
  try {
    validate(parameters);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(WeatherParametersTest, BadValuesAreNamed) {
  using P = WeatherParameters;
  EXPECT_THAT(complaint([](P& p) { p.course[0].rain_mmph = std::nan(""); }),
              AllOf(HasSubstr("course[0].rain_mmph is nan"), HasSubstr("0 to 300")));
  EXPECT_THAT(complaint([](P& p) { p.course[1].rain_mmph = -1.0; }),
              HasSubstr("course[1].rain_mmph is -1"));
  EXPECT_THAT(complaint([](P& p) { p.course[0].snow_mmph = 1e6; }), HasSubstr("snow_mmph"));
  EXPECT_THAT(complaint([](P& p) { p.course[0].fog_visibility_m = 1e-9; }),
              AllOf(HasSubstr("fog_visibility_m"), HasSubstr("0 (none) or 5 to 10000")));
  EXPECT_THAT(complaint([](P& p) { p.course[0].haze_visibility_m = std::nan(""); }),
              HasSubstr("haze_visibility_m is nan"));
  EXPECT_THAT(complaint([](P& p) { p.course[0].wind_mps = 1e3; }), HasSubstr("wind_mps is 1000"));
  EXPECT_THAT(complaint([](P& p) { p.course[0].dryness = -0.1; }), HasSubstr("dryness"));
  EXPECT_THAT(complaint([](P& p) { p.course[1].at = 0s; }),
              AllOf(HasSubstr("course[1].at is 0"), HasSubstr("later than the key frame before")));
  EXPECT_THAT(complaint([](P& p) { p.dust.lidar_ratio_sr = 0.0; }),
              HasSubstr("dust.lidar_ratio_sr is 0"));
  EXPECT_THAT(complaint([](P& p) { p.overlap_end_m = 0.5; }), HasSubstr("overlap_end_m"));
  EXPECT_EQ(complaint([](P&) {}), "");
}

}  // namespace
}  // namespace rigwire::sim
