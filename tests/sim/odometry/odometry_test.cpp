#include "sim/odometry/odometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

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
  EXPECT_NEAR(yaw_rate_radps(reading), 0.0, 1e-15);
}

TEST(OdometryUnderSlip, TenPercentSlipGivesOneOverNineTenthsOfTheSpeed) {
  // Encoder speed over true speed = 1 / (1 - s).
  const double slip = 0.1;
  const double v = 2.0;
  const OdometryParameters p;
  VehicleSample sample = rolling(p, v, 0.0, 0.0, 0.565);
  for (double& rate : sample.wheel_rate_radps) {
    rate /= 1.0 - slip;
  }
  EXPECT_NEAR(odometry(p, sample).speed_mps / v, 1.0 / (1.0 - slip), 1e-12);
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
