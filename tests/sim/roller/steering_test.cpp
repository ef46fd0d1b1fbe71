#include "sim/roller/steering.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace rigwire::sim {
namespace {

TEST(PivotSteering, AngleAtATimeDoesNotDependOnTheStep) {
  const PivotSteeringParameters p;
  for (const double end : {0.2, 0.8, 1.7, 2.5}) {
    PivotSteering once(p);
    PivotSteering often(p);
    once.command(0.4);
    often.command(0.4);
    once.step(end);
    for (int i = 0; i < 1000; ++i) {
      often.step(end / 1000.0);
    }
    EXPECT_NEAR(once.angle_rad(), often.angle_rad(), 1e-12) << end;
    EXPECT_NEAR(once.rate_radps(), often.rate_radps(), 1e-11) << end;
  }
}

TEST(PivotSteering, FollowsRateLimitAndThenTheExponential) {
  const PivotSteeringParameters p;
  PivotSteering pivot(p);
  pivot.command(0.4);
  pivot.step(0.5);
  EXPECT_DOUBLE_EQ(pivot.angle_rad(), 0.5 * p.rate_max_radps);
  EXPECT_DOUBLE_EQ(pivot.rate_radps(), p.rate_max_radps);
  const double near = p.rate_max_radps * p.time_constant_s;
  const double linear_s = (0.4 - near) / p.rate_max_radps;
  pivot.step(linear_s + 0.3 - 0.5);
  EXPECT_NEAR(pivot.angle_rad(), 0.4 - near * std::exp(-0.3 / p.time_constant_s), 1e-12);
}

TEST(PivotSteering, NeverTurnsFasterThanItsLimitNorBeyondItsStop) {
  const PivotSteeringParameters p;
  PivotSteering pivot(p);
  double before = 0.0;
  for (int i = 0; i < 3000; ++i) {
    pivot.command(i / 500 % 2 == 0 ? 2.0 : -2.0);
    pivot.step(0.004);
    EXPECT_LE(std::abs(pivot.angle_rad() - before), p.rate_max_radps * 0.004 + 1e-15);
    EXPECT_LE(std::abs(pivot.angle_rad()), p.angle_max_rad);
    before = pivot.angle_rad();
  }
}

TEST(PivotSteering, KeepsItsSetPointWhenTheNewOneIsNoNumber) {
  PivotSteering pivot{PivotSteeringParameters{}};
  pivot.command(0.2);
  pivot.command(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(pivot.set_point_rad(), 0.2);
  pivot.step(10.0);
  EXPECT_EQ(pivot.angle_rad(), 0.2);
  EXPECT_EQ(pivot.rate_radps(), 0.0);
}

TEST(PivotSteering, RefusesNumbersThatMakeNoSteering) {
  PivotSteeringParameters p;
  p.rate_max_radps = 0.0;
  EXPECT_THROW(validate(p), std::invalid_argument);
  p = {};
  p.angle_max_rad = 1.6;
  EXPECT_THROW(validate(p), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
