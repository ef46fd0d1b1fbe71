#include "sim/gnss/range_errors.h"
#include "fields/constants.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace rigwire::sim {
namespace {

/// All terms off; a test switches on what it is about.
constexpr RangeErrorParameters kNoErrors{.orbit_clock_sigma_m = 0.0,
                                         .ionosphere_sigma_m = 0.0,
                                         .ionosphere_gradient_sigma_mpkm = 0.0,
                                         .troposphere_sigma_m = 0.0,
                                         .code_noise_m = 0.0,
                                         .multipath_sigma_m = 0.0};

SignalArrival error_at(double elevation_deg, double azimuth_deg = 0.0) {
  return {.azimuth_rad = azimuth_deg * kDegree, .elevation_rad = elevation_deg * kDegree};
}

TEST(RangeErrors, MappingsRiseTowardsTheHorizon) {
  EXPECT_NEAR(ionosphere_mapping(90.0 * kDegree), 1.0004, 1e-4);
  EXPECT_NEAR(ionosphere_mapping(0.0), 1.0 + 16.0 * std::pow(0.53, 3), 1e-12);
  EXPECT_NEAR(troposphere_mapping(30.0 * kDegree), 2.0, 1e-12);
}

/// Autocorrelation of the multipath term at a lag, at this speed and step.
double multipath_correlation(double speed_mps, double step_s, double lag_s) {
  RangeErrorParameters parameters = kNoErrors;
  parameters.multipath_sigma_m = 1.0;
  SatelliteErrors satellite(1, "satellite");
  std::vector<double> x;
  for (int i = 0; i < 60'000; ++i) {
    satellite.advance(parameters, step_s, speed_mps);
    x.push_back(satellite.error(parameters, error_at(90.0), {}).total_m());
  }
  const auto lag = static_cast<std::size_t>(std::lround(lag_s / step_s));
  double product = 0.0;
  double square = 0.0;
  for (std::size_t i = 0; i + lag < x.size(); ++i) {
    product += x[i] * x[i + lag];
    square += x[i] * x[i];
  }
  return product / square;
}

TEST(RangeErrors, MultipathForgetsWithinSecondsInMotion) {
  // 1 / tau = 1 / 120 s + 10 m/s / 50 m: 4.8 s.
  EXPECT_NEAR(multipath_correlation(10.0, 1.0, 5.0), std::exp(-5.0 / 4.8), 0.05);
  EXPECT_NEAR(multipath_correlation(10.0, 0.5, 5.0), std::exp(-5.0 / 4.8), 0.05);
  EXPECT_NEAR(multipath_correlation(0.0, 5.0, 60.0), std::exp(-0.5), 0.07);
}

TEST(RangeErrors, CodeNoiseDoublesEverySixDecibel) {
  RangeErrorParameters parameters = kNoErrors;
  parameters.code_noise_m = 0.3;
  SatelliteErrors satellite(1, "satellite");
  satellite.advance(parameters, 1.0, 0.0);
  SignalArrival strong = error_at(45.0);
  SignalArrival weak = strong;
  weak.cn0_dbhz = strong.cn0_dbhz - 20.0 * std::log10(2.0);
  const RangeError one = satellite.error(parameters, strong, {});
  const RangeError two = satellite.error(parameters, weak, {});
  EXPECT_NEAR(one.sigma_m, 0.3, 1e-12);
  EXPECT_NEAR(two.sigma_m, 0.6, 1e-12);
  EXPECT_NEAR(two.total_m(), 2.0 * one.total_m(), 1e-12);
}

// Before: by elevation alone, so that a receiver behind a window, 15 dB weaker, knew its place as
// well as one on a roof.
TEST(RangeErrors, MultipathDoublesEverySixDecibelButNotByFading) {
  RangeErrorParameters parameters = kNoErrors;
  parameters.multipath_sigma_m = 0.5;
  SatelliteErrors satellite(1, "satellite");
  satellite.advance(parameters, 1.0, 0.0);
  const SignalArrival strong = error_at(45.0);
  SignalArrival weak = strong;
  weak.cn0_dbhz = strong.cn0_dbhz - 20.0 * std::log10(2.0);
  SignalArrival faded = weak;
  faded.fade_db = -20.0 * std::log10(2.0);
  const RangeError one = satellite.error(parameters, strong, {});
  const RangeError two = satellite.error(parameters, weak, {});
  const RangeError same = satellite.error(parameters, faded, {});
  EXPECT_NEAR(one.sigma_m, 0.5, 1e-12);
  EXPECT_NEAR(two.sigma_m, 1.0, 1e-12);
  EXPECT_NEAR(two.total_m(), 2.0 * one.total_m(), 1e-12);
  EXPECT_NEAR(same.total_m(), one.total_m(), 1e-12);
}

TEST(RangeErrors, ScatterIsExponentialAndRenewedByWayAndTime) {
  constexpr double kRest_s = 20.0;
  constexpr double kLength_m = 10.0;
  constexpr double kSpeed_mps = 5.0;
  constexpr double kStep_s = 0.5;
  constexpr int kSteps = 40'000;
  double sum = 0.0;
  double square = 0.0;
  int renewals = 0;
  SatelliteErrors satellite(1, "satellite");
  (void)satellite.scatter(0.0, kRest_s, 0.0, kLength_m);
  for (int i = 0; i < kSteps; ++i) {
    renewals += satellite.scatter(kStep_s, kRest_s, kSpeed_mps, kLength_m) ? 1 : 0;
    sum += satellite.scattered() / kSteps;
    square += std::pow(satellite.scattered(), 2) / kSteps;
  }
  EXPECT_NEAR(sum, 1.0, 0.05);
  EXPECT_NEAR(square, 2.0, 0.2);  // an exponential distribution's second moment
  // A Poisson process of 1 / 20 s + 5 m/s / 10 m.
  EXPECT_NEAR(static_cast<double>(renewals) / kSteps, 1.0 - std::exp(-kStep_s * 0.55), 0.01);
}

TEST(RangeErrors, ADetourIsExactAndNeverBelieved) {
  SatelliteErrors satellite(1, "satellite");
  SignalArrival reflected = error_at(45.0);
  reflected.extra_path_m = 17.0;
  const RangeError error = satellite.error(kNoErrors, reflected, {});
  EXPECT_DOUBLE_EQ(error.total_m(), 17.0);
  EXPECT_LT(error.sigma_m, 0.01);
  // A receiver mistrusts what is too weak, without knowing why.
  reflected.missing_db = 8.0;
  EXPECT_NEAR(satellite.error(kNoErrors, reflected, {}).sigma_m, 5.0, 1e-9);
}

TEST(RangeErrors, SigmaIsThatOfTheTotal) {
  const RangeErrorParameters parameters;
  for (const double elevation_deg : {10.0, 40.0, 80.0}) {
    double square = 0.0;
    double sigma_m = 0.0;
    constexpr int kSatellites = 4000;
    for (std::uint64_t seed = 1; seed <= kSatellites; ++seed) {
      SatelliteErrors satellite(seed, "satellite");
      satellite.advance(parameters, 0.0, 0.0);
      SignalArrival arrival = error_at(elevation_deg, 30.0);
      RandomStream shared(seed, "shared");
      arrival.shared = {.orbit_clock = shared.gaussian(),
                        .ionosphere = shared.gaussian(),
                        .troposphere = shared.gaussian()};
      const RangeError error = satellite.error(parameters, arrival, {});
      square += error.total_m() * error.total_m() / kSatellites;
      sigma_m = error.sigma_m;
    }
    EXPECT_NEAR(std::sqrt(square) / sigma_m, 1.0, 0.04) << elevation_deg;
  }
}

TEST(RangeErrors, RefusesStrangeParameters) {
  RangeErrorParameters parameters;
  parameters.multipath_length_m = 0.0;
  EXPECT_THROW(validate(parameters), std::invalid_argument);
  parameters = {};
  parameters.orbit_clock_sigma_m = std::nan("");
  EXPECT_THROW(validate(parameters), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
