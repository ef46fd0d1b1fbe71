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
              HasSubstr("course.0.rain: found nan mm/h, allowed 0 .. 300 mm/h"));
  EXPECT_THAT(complaint([](P& p) { p.course[1].rain_mmph = -1.0; }),
              HasSubstr("course.1.rain: found -1 mm/h"));
  EXPECT_THAT(complaint([](P& p) { p.course[0].snow_mmph = 1e6; }),
              HasSubstr("course.0.snow: found 1000000 mm/h"));
  EXPECT_THAT(complaint([](P& p) { p.course[0].fog_visibility_m = 1e-9; }),
              AllOf(HasSubstr("course.0.fog_visibility: found"),
                    HasSubstr("allowed 0 (none) or 5 .. 10000 m")));
  EXPECT_THAT(complaint([](P& p) { p.course[0].haze_visibility_m = std::nan(""); }),
              HasSubstr("haze_visibility: found nan m"));
  EXPECT_THAT(complaint([](P& p) { p.course[0].wind_mps = 1e3; }),
              HasSubstr("course.0.wind: found 1000 m/s"));
  EXPECT_THAT(complaint([](P& p) { p.course[0].dryness = -0.1; }),
              HasSubstr("course.0.dryness: found -0.1, allowed 0 .. 10"));
  EXPECT_THAT(complaint([](P& p) { p.course[1].at = 0s; }),
              HasSubstr("course.1.at: found 0 s, allowed later than the key frame before"));
  EXPECT_THAT(complaint([](P& p) { p.dust.lidar_ratio_sr = 0.0; }),
              HasSubstr("dust.lidar_ratio: found 0 sr, allowed 1 .. 1000 sr"));
  EXPECT_THAT(
      complaint([](P& p) { p.overlap_end_m = 0.5; }),
      HasSubstr("overlap_end: found 0.5 m, allowed from 0.01 m beyond overlap_start, 0.9 m"));
  EXPECT_EQ(complaint([](P&) {}), "");
}

}  // namespace
}  // namespace rigwire::sim
