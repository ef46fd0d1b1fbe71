#include "bench/weather_bench.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/weather_reference.h"

namespace rigwire::bench {
namespace {

TEST(WeatherBench, RainReturnsAreThoseOfTheDoubleIntegral) {
  for (const RainReturns& row : measure_rain_returns(100000)) {
    EXPECT_NEAR(row.counted_share, row.expected_share, 3.0 * row.sigma) << row.rain_mmph;
    EXPECT_NEAR(row.extinction_pm / row.integrated_extinction_pm, 1.0, 1e-6) << row.rain_mmph;
  }
}

TEST(WeatherBench, FogReturnsAreThoseOfTheIntegralOverCells) {
  for (const FogReturns& row : measure_fog_returns(100000)) {
    // Steps along the beam: 2 % of the share.
    EXPECT_NEAR(row.counted_share, row.expected_share, 3.0 * row.sigma + 0.02 * row.expected_share)
        << row.visibility_m;
    if (row.counted_share > 0.001) {
      EXPECT_NEAR(row.mean_range_m, row.expected_mean_range_m, 0.1) << row.visibility_m;
    }
  }
}

TEST(WeatherBench, MarchingThroughEvenFogIsExact) {
  sim::WeatherParameters parameters;
  parameters.course = {{.fog_visibility_m = 100.0}};
  sim::WeatherBeam beam;
  beam.far_m = 60.0;
  const MarchedBeam marched = march_beam(parameters, {}, beam, 0.02);
  EXPECT_NEAR(marched.transmission, std::pow(0.05, 2.0 * 60.0 / 100.0), 1e-12);
}

}  // namespace
}  // namespace rigwire::bench
