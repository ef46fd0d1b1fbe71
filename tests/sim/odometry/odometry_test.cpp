#include "sim/odometry/odometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "sim/odometry/dead_reckoning.h"

namespace rigwire::sim {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Wheel readings of a body that moves with v_x, v_y, yaw rate, its wheels rolling without slip:
/// from the velocities of the wheels' places, without the formulas under test.
VehicleSample rolling(const OdometryParameters& p, double v_x, double v_y, double yaw_rate,
                      double radius_m) {
  VehicleSample sample;
  for (std::size_t i = 0; i < kWheels; ++i) {
    const double x = i < 2 ? p.front_distance_m : -p.rear_distance_m;
    const double y = (i % 2 == 0 ? 0.5 : -0.5) * p.track_m;
    const double u = v_x - yaw_rate * y;
    const double v = v_y + yaw_rate * x;
    sample.wheel_rate_radps[i] = std::copysign(std::hypot(u, v), u) / radius_m;
    sample.wheel_radius_m[i] = radius_m;
  }
  sample.front_steer_rad = std::atan((v_y + yaw_rate * p.front_distance_m) / v_x);
  sample.rear_steer_rad = std::atan((v_y - yaw_rate * p.rear_distance_m) / v_x);
  return sample;
}

VehicleSample straight(double rate_radps, double front_rad, double rear_rad) {
  VehicleSample sample;
  sample.wheel_rate_radps.fill(rate_radps);
  sample.wheel_radius_m.fill(0.5);
  sample.front_steer_rad = front_rad;
  sample.rear_steer_rad = rear_rad;
  return sample;
}

TEST(Odometry, FindsTheMotionOfABodyWhoseWheelsDoNotSlip) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 2000; ++i) {
    OdometryParameters p;
    p.front_distance_m = 2.0 + unit(random);
    p.rear_distance_m = 1.5 + unit(random);
    p.wheels = static_cast<OdometryWheels>(i % 3);
    const double v_x = (i % 2 == 0 ? 1.0 : -1.0) * (1.0 + std::abs(unit(random)));
    const double v_y = 0.4 * unit(random);
    const double yaw_rate = 0.4 * unit(random);
    const OdometryReading reading = odometry(p, rolling(p, v_x, v_y, yaw_rate, 0.565));
    ASSERT_NEAR(reading.speed_mps, v_x, 1e-12);
    ASSERT_NEAR(std::tan(reading.slip_angle_rad), v_y / v_x, 1e-12);
    ASSERT_NEAR(yaw_rate_radps(reading), yaw_rate, 1e-12);
    ASSERT_NEAR(reading.curvature_1pm, yaw_rate / std::copysign(std::hypot(v_x, v_y), v_x), 1e-12);
  }
}

TEST(RollerOdometry, CounterSteeringTurnsOnTheCircleOfHalfTheWheelbase) {
  // R = L / (2 tan delta), reference point in the middle, no slip angle.
  const OdometryParameters p{1.7, 1.7, 0.0, OdometryWheels::all};
  const double delta = 20.0 * std::numbers::pi / 180.0;
  const OdometryReading reading = odometry(p, straight(1.2, delta, -delta));
  EXPECT_NEAR(1.0 / reading.curvature_1pm, 3.4 / (2.0 * std::tan(delta)), 1e-12);
  EXPECT_NEAR(reading.slip_angle_rad, 0.0, 1e-15);
  // Drum speed v cos(beta) / (R cos(delta)).
  EXPECT_NEAR(reading.speed_mps, 1.2 * 0.5 * std::cos(delta), 1e-12);
}

TEST(RollerOdometry, CrabKeepsTheHeading) {
  const OdometryParameters p{1.2, 2.2, 0.0, OdometryWheels::all};
  const double delta = 23.0 * std::numbers::pi / 180.0;
  const OdometryReading reading = odometry(p, straight(-1.0, delta, delta));
  EXPECT_NEAR(reading.curvature_1pm, 0.0, 1e-16);
  EXPECT_NEAR(reading.slip_angle_rad, delta, 1e-15);
  EXPECT_NEAR(reading.speed_mps, -0.5 * std::cos(delta), 1e-15);
  DeadReckoning track;
  track.advance(reading, 10.0);
  EXPECT_NEAR(track.pose().yaw_rad, 0.0, 1e-15);
  EXPECT_NEAR(track.pose().x_m, -5.0 * std::cos(delta), 1e-12);
  EXPECT_NEAR(track.pose().y_m, -5.0 * std::sin(delta), 1e-12);
}

TEST(RollerOdometry, AFullCircleClosesWhateverTheStep) {
  const OdometryParameters p{1.7, 1.7, 0.0, OdometryWheels::all};
  const OdometryReading reading = odometry(p, straight(2.0, 0.5, -0.3));
  const double period = 2.0 * std::numbers::pi / yaw_rate_radps(reading);
  for (const int steps : {1, 3, 7, 1000, 100000}) {
    DeadReckoning track;
    for (int i = 0; i < steps; ++i) {
      track.advance(reading, period / steps);
    }
    EXPECT_NEAR(std::hypot(track.pose().x_m, track.pose().y_m), 0.0, 1e-9) << steps;
    EXPECT_NEAR(track.pose().yaw_rad, 2.0 * std::numbers::pi, 1e-9);
  }
}

TEST(DeadReckoningTest, AQuarterCircleEndsAtItsRadius) {
  DeadReckoning track;
  OdometryReading reading;
  reading.speed_mps = 2.0;
  reading.curvature_1pm = 0.1;
  track.advance(reading, 0.5 * std::numbers::pi * 10.0 / 2.0);
  EXPECT_NEAR(track.pose().x_m, 10.0, 1e-12);
  EXPECT_NEAR(track.pose().y_m, 10.0, 1e-12);
  EXPECT_NEAR(track.distance_m(), 5.0 * std::numbers::pi, 1e-12);
}

TEST(DeadReckoningTest, ThereAndBackIsWhereItBegan) {
  DeadReckoning track({1.0, 2.0, 0.3});
  OdometryReading reading{1.5, 0.2, 0.1};
  track.advance(reading, 3.0);
  reading.speed_mps = -1.5;
  track.advance(reading, 3.0);
  EXPECT_NEAR(track.pose().x_m, 1.0, 1e-12);
  EXPECT_NEAR(track.pose().y_m, 2.0, 1e-12);
  EXPECT_NEAR(track.pose().yaw_rad, 0.3, 1e-12);
}

TEST(DeadReckoningTest, ASmallTurnIsAsAccurateAsALargeOne) {
  // Both sides of the switch to the series.
  for (const double curvature : {1e-12, 1.9999e-5, 2.0001e-5, 1e-3}) {
    DeadReckoning track;
    track.advance({10.0, curvature, 0.0}, 1.0);
    const double turn = 10.0 * curvature;
    EXPECT_NEAR(track.pose().x_m, std::sin(turn) / curvature, 1e-14 / curvature * 1e-3 + 1e-12);
    EXPECT_NEAR(track.pose().y_m, 5.0 * turn, 1e-3 * turn);
  }
}

TEST(OdometryUnderSlip, TenPercentSlipGivesOneOverNineTenthsOfTheWay) {
  // Encoder distance over true distance = 1 / (1 - s).
  const double slip = 0.1;
  const double v = 2.0;
  const OdometryParameters p;
  VehicleSample sample = rolling(p, v, 0.0, 0.0, 0.565);
  for (double& rate : sample.wheel_rate_radps) {
    rate /= 1.0 - slip;
  }
  DeadReckoning track;
  for (int i = 0; i < 500; ++i) {
    track.advance(odometry(p, sample), 0.02);
  }
  EXPECT_NEAR(track.distance_m() / (v * 10.0), 1.0 / (1.0 - slip), 1e-12);
}

TEST(OdometryEdges, StandstillIsZeroWithTheCurvatureOfTheSteering) {
  const OdometryReading reading = odometry(OdometryParameters{}, straight(0.0, 0.3, 0.0));
  EXPECT_EQ(reading.speed_mps, 0.0);
  EXPECT_NEAR(reading.curvature_1pm, std::tan(0.3) / 3.85, 1e-15);
  EXPECT_EQ(yaw_rate_radps(reading), 0.0);
}

TEST(OdometryEdges, ATurnAboutAPointBetweenTheWheelsKeepsItsSign) {
  // Counter steering to beyond half the track: inner wheels turn backwards.
  const OdometryParameters p{1.0, 1.0, 1.94, OdometryWheels::all};
  const OdometryReading reading = odometry(p, rolling(p, 0.5, 0.0, 1.0, 0.5));
  EXPECT_NEAR(reading.speed_mps, 0.5, 1e-12);
  EXPECT_NEAR(yaw_rate_radps(reading), 1.0, 1e-12);
}

TEST(OdometryEdges, SteeringAtAndBeyondARightAngleStaysFinite) {
  const double right = 0.5 * std::numbers::pi;
  for (const double front : {right, -right, 3.0, -3.0, 1e9}) {
    for (const double rear : {0.0, right, -right}) {
      const OdometryReading reading = odometry(OdometryParameters{}, straight(1.0, front, rear));
      EXPECT_TRUE(std::isfinite(reading.speed_mps));
      EXPECT_TRUE(std::isfinite(reading.curvature_1pm));
      EXPECT_TRUE(std::isfinite(yaw_rate_radps(reading)));
      EXPECT_LT(std::abs(reading.slip_angle_rad), 1.5);
    }
  }
}

TEST(OdometryEdges, ReadingsThatAreNoNumbersAreLeftOut) {
  const OdometryParameters p;
  VehicleSample sample = rolling(p, 3.0, 0.0, 0.0, 0.5);
  sample.wheel_rate_radps[1] = kNan;
  sample.wheel_radius_m[2] = kInfinity;
  EXPECT_NEAR(odometry(p, sample).speed_mps, 3.0, 1e-12);
  sample.wheel_rate_radps.fill(kNan);
  EXPECT_EQ(odometry(p, sample).speed_mps, 0.0);
  sample = rolling(p, 3.0, 0.0, 0.0, 0.5);
  sample.front_steer_rad = kNan;
  sample.rear_steer_rad = kInfinity;
  EXPECT_NEAR(odometry(p, sample).speed_mps, 3.0, 1e-12);
  EXPECT_EQ(odometry(p, sample).curvature_1pm, 0.0);
  sample.wheel_rate_radps.fill(1e308);
  sample.wheel_radius_m.fill(1e308);
  EXPECT_TRUE(std::isfinite(odometry(p, sample).speed_mps));

  DeadReckoning track;
  track.advance({kNan, 0.0, 0.0}, 1.0);
  track.advance({1.0, kInfinity, 0.0}, 1.0);
  track.advance({1.0, 0.0, kNan}, 1.0);
  track.advance({1.0, 0.0, 0.0}, kNan);
  track.advance({1.0, 0.0, 0.0}, -1.0);
  track.advance({1.0, 0.0, 0.0}, 0.0);
  EXPECT_EQ(track.pose().x_m, 0.0);
  EXPECT_EQ(track.distance_m(), 0.0);
}

TEST(OdometryEdges, ParametersWithoutWheelbaseAreRefused) {
  EXPECT_NO_THROW(validate(OdometryParameters{}));
  EXPECT_NO_THROW(validate(OdometryParameters{-0.5, 2.0, 0.0, OdometryWheels::rear}));
  EXPECT_THROW(validate(OdometryParameters{1.0, -1.0, 1.0, OdometryWheels::all}),
               std::invalid_argument);
  EXPECT_THROW(validate(OdometryParameters{kNan, 1.0, 1.0, OdometryWheels::all}),
               std::invalid_argument);
  EXPECT_THROW(validate(OdometryParameters{1.0, 1.0, -1.0, OdometryWheels::all}),
               std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
