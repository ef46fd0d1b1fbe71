#include "dig_cycle/estimator.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigwire::dig_cycle {
namespace {

constexpr double kGravity_mps2 = 9.80665;
constexpr double kPeriod_s = 0.01;

/// Four links with their pitches against the horizontal, sampled without error unless said.
struct Rig {
  Estimator estimator{kPeriod_s};
  std::array<double, kLinks> pitch_rad{};
  std::array<double, kLinks> rate_radps{};
  std::array<double, kLinks> rate_offset_radps{};
  double sideways_mps2 = 0.0;  ///< Horizontal acceleration of all links, forward.

  void step() {
    for (std::size_t i = 0; i < kLinks; ++i) {
      const auto link = static_cast<Link>(i);
      pitch_rad[i] += rate_radps[i] * kPeriod_s;
      estimator.imu_rate(link, rate_radps[i] + rate_offset_radps[i]);
      estimator.imu_specific_force(
          link, kGravity_mps2 * std::sin(pitch_rad[i]) + sideways_mps2 * std::cos(pitch_rad[i]),
          kGravity_mps2 * std::cos(pitch_rad[i]) - sideways_mps2 * std::sin(pitch_rad[i]));
    }
  }
  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds / kPeriod_s)); ++i) {
      step();
    }
  }
};

TEST(DigCycleEstimator, IsReadyOnlyWhenEverySensorHasSpoken) {
  Estimator estimator;
  EXPECT_FALSE(estimator.belief().ready);
  for (const Link link : {chassis_link, boom_link, stick_link}) {
    estimator.imu_specific_force(link, 0.0, kGravity_mps2);
  }
  estimator.swing(0.1, 0.0);
  EXPECT_FALSE(estimator.belief().ready);
  estimator.imu_rate(bucket_link, 0.0);
  EXPECT_FALSE(estimator.belief().ready) << "a rate alone says nothing of the angle";
  estimator.imu_specific_force(bucket_link, 0.0, kGravity_mps2);
  EXPECT_TRUE(estimator.belief().ready);
}

TEST(DigCycleEstimator, AnglesAreDifferencesOfTheLinksPitches) {
  Rig rig;
  rig.pitch_rad = {3.0 * kDegree, 38.0 * kDegree, -52.0 * kDegree, -32.0 * kDegree};
  rig.estimator.swing(1.25, 0.0);
  rig.run(0.1);
  const Belief belief = rig.estimator.belief();
  EXPECT_NEAR(belief.chassis_pitch_rad, 3.0 * kDegree, 1e-9);
  EXPECT_NEAR(belief.angles_rad[swing], 1.25, 1e-12);
  EXPECT_NEAR(belief.angles_rad[boom], 35.0 * kDegree, 1e-9);
  EXPECT_NEAR(belief.angles_rad[stick], -90.0 * kDegree, 1e-9);
  EXPECT_NEAR(belief.angles_rad[bucket], 20.0 * kDegree, 1e-9);
}

TEST(DigCycleEstimator, LinkThatPointsBackwardsDoesNotWrapTheJointAngle) {
  Rig rig;  // stick at -161 degrees under a lowered boom: the bucket points beyond -180
  rig.pitch_rad = {0.0, -10.0 * kDegree, -170.0 * kDegree, -205.0 * kDegree};
  rig.estimator.swing(0.0, 0.0);
  rig.run(0.5);
  const Belief belief = rig.estimator.belief();
  EXPECT_NEAR(belief.angles_rad[stick], -160.0 * kDegree, 1e-9);
  EXPECT_NEAR(belief.angles_rad[bucket], -35.0 * kDegree, 1e-9);
}

TEST(DigCycleEstimator, FollowsAMovingJointWithoutLag) {
  Rig rig;
  rig.estimator.swing(0.0, 0.0);
  rig.run(1.0);
  rig.rate_radps = {0.0, 0.4, 0.4, 0.4};
  rig.run(2.0);
  const Belief belief = rig.estimator.belief();
  EXPECT_NEAR(belief.angles_rad[boom], 0.8, 1e-6);
  EXPECT_NEAR(belief.rates_radps[boom], 0.4, 1e-6);
  EXPECT_NEAR(belief.angles_rad[stick], 0.0, 1e-6);
}

TEST(DigCycleEstimator, AccelerationOfTheMotionHardlyTiltsTheVertical) {
  Rig rig;
  rig.estimator.swing(0.0, 0.0);
  rig.run(1.0);
  // One second of 1 m/s2 forward while the boom moves: gravity alone would be 5.8 degrees off.
  rig.rate_radps[boom_link] = 0.1;
  rig.sideways_mps2 = 1.0;
  rig.run(1.0);
  const double error_rad = rig.estimator.belief().angles_rad[boom] - rig.pitch_rad[boom_link];
  EXPECT_LT(std::abs(error_rad), 1.0 * kDegree);
  EXPECT_GT(std::abs(std::atan2(1.0, kGravity_mps2)), 5.0 * kDegree);
}

// The acceleration of a boom that drops shows before its rate does.
TEST(DigCycleEstimator, TheJerkOfAStartDoesNotTiltTheVertical) {
  Rig rig;
  rig.estimator.swing(0.0, 0.0);
  rig.run(3.0);
  rig.sideways_mps2 = 4.0;
  rig.run(0.03);
  rig.rate_radps[boom_link] = -0.5;
  rig.run(0.1);
  rig.sideways_mps2 = 0.0;
  rig.run(1.0);
  const double error_rad = rig.estimator.belief().angles_rad[boom] - rig.pitch_rad[boom_link];
  EXPECT_LT(std::abs(error_rad), 0.1 * kDegree);
}

TEST(DigCycleEstimator, ShockIsNotTakenForGravity) {
  Rig rig;
  rig.estimator.swing(0.0, 0.0);
  rig.run(1.0);
  for (int i = 0; i < 20; ++i) {
    rig.estimator.imu_specific_force(bucket_link, 30.0, 5.0);
    rig.estimator.imu_specific_force(bucket_link, std::nan(""), 5.0);
  }
  EXPECT_NEAR(rig.estimator.belief().angles_rad[bucket], 0.0, 1e-9);
}

TEST(DigCycleEstimator, LearnsTheRateOffsetAtRestAndKeepsTheAngleDuringASwing) {
  Rig rig;
  rig.rate_offset_radps = {0.0, 0.2 * kDegree, -0.2 * kDegree, 0.1 * kDegree};
  rig.estimator.swing(0.0, 0.0);
  rig.run(60.0);
  EXPECT_NEAR(rig.estimator.inclination(boom_link).rate_offset_radps(), 0.2 * kDegree,
              0.01 * kDegree);
  // Ten seconds of swinging, when gravity hardly counts.
  rig.estimator.swing(0.0, 0.5);
  rig.run(10.0);
  EXPECT_NEAR(rig.estimator.belief().angles_rad[boom], 0.0, 0.1 * kDegree);
}

// Inertial sensors of this class have offsets of some 0.1 deg/s: over the 8 s with which gravity
// counts in motion, that is a degree.
TEST(DigCycleEstimator, TheFirstRestTellsTheRateOffset) {
  Rig rig;
  rig.rate_offset_radps = {-0.1 * kDegree, 0.2 * kDegree, 0.0, 0.0};
  rig.estimator.swing(0.0, 0.0);
  rig.run(1.0);
  EXPECT_FALSE(rig.estimator.belief().rested);
  rig.run(1.5);
  EXPECT_TRUE(rig.estimator.belief().rested);
  EXPECT_NEAR(rig.estimator.inclination(chassis_link).rate_offset_radps(), -0.1 * kDegree,
              0.01 * kDegree);
  rig.rate_radps[bucket_link] = 0.2;  // Something moves: gravity hardly counts.
  rig.run(10.0);
  EXPECT_NEAR(rig.estimator.belief().angles_rad[boom], 0.0, 0.1 * kDegree);
}

TEST(DigCycleEstimator, SwingDoesNotTiltTheVertical) {
  Rig rig;
  rig.estimator.swing(0.0, 0.0);
  rig.run(1.0);
  rig.estimator.swing(0.0, 0.5);
  rig.sideways_mps2 = -1.25;  // towards the axis: 0.5 rad/s at 5 m
  rig.run(4.0);
  EXPECT_NEAR(rig.estimator.belief().chassis_pitch_rad, 0.0, 1e-6);
  EXPECT_NEAR(rig.estimator.inclination(boom_link).pitch_rad(), 0.0, 1e-6);
}

}  // namespace
}  // namespace rigwire::dig_cycle
