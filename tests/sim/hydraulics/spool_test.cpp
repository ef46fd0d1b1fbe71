#include "sim/hydraulics/spool.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rigwire::sim {
namespace {

SpoolParameters slow_lag() {
  return {
      .time_constant_s = 0.05, .rate_limit_per_s = 1e6, .dead_band = 0.05, .flow_max_m3ps = 0.005};
}

TEST(Spool, LagIsTheExactExponential) {
  Spool spool(slow_lag());
  ASSERT_TRUE(spool.command(0.8));
  spool.step(0.05);
  EXPECT_NEAR(spool.position(), 0.8 * (1.0 - std::exp(-1.0)), 1e-6);
}

TEST(Spool, DividingAStepChangesNothing) {
  for (const double rate : {1e6, 10.0, 2.0}) {
    SpoolParameters parameters = slow_lag();
    parameters.rate_limit_per_s = rate;
    Spool whole(parameters);
    Spool parts(parameters);
    whole.command(-1.0);
    parts.command(-1.0);
    whole.step(0.2);
    for (int i = 0; i < 1000; ++i) {
      parts.step(0.2e-3);
    }
    EXPECT_NEAR(whole.position(), parts.position(), 1e-12) << rate;
  }
}

TEST(Spool, RateLimitBoundsTheTravel) {
  SpoolParameters parameters = slow_lag();
  parameters.rate_limit_per_s = 2.0;
  Spool spool(parameters);
  spool.command(1.0);
  spool.step(0.1);
  EXPECT_NEAR(spool.position(), 0.2, 1e-12);
}

TEST(Spool, DeadBandHasNoFlowAndTheRestIsProportional) {
  SpoolParameters parameters = slow_lag();
  parameters.time_constant_s = 0.0;
  Spool spool(parameters);
  for (const auto& [opening, share] : {std::pair{0.0, 0.0},
                                       {0.05, 0.0},
                                       {-0.05, 0.0},
                                       {1.0, 1.0},
                                       {-1.0, -1.0},
                                       {0.525, 0.5},
                                       {-0.525, -0.5}}) {
    spool.command(opening);
    spool.step(1.0);
    EXPECT_NEAR(spool.flow_request_m3ps(), share * 0.005, 1e-15) << opening;
  }
}

TEST(Spool, RefusesNotANumberAndClampsTheRest) {
  Spool spool(slow_lag());
  EXPECT_TRUE(spool.command(5.0));
  EXPECT_FALSE(spool.command(std::numeric_limits<double>::quiet_NaN()));
  spool.step(100.0);
  EXPECT_EQ(spool.position(), 1.0);
}

TEST(Spool, ZeroAndNegativeSpansChangeNothing) {
  Spool spool(slow_lag());
  spool.command(1.0);
  spool.step(0.0);
  spool.step(-1.0);
  EXPECT_EQ(spool.position(), 0.0);
}

}  // namespace
}  // namespace rigwire::sim
