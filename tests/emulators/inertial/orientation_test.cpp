#include "emulators/inertial/orientation.h"
#include "fields/constants.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rigwire::emulators {
namespace {

constexpr double kGravity = 9.80665;

/// The specific force at rest under an attitude.
Triad at_rest(const Quaternion& q) {
  return rotate(conjugate(q), {0.0, 0.0, kGravity});
}

TEST(Orientation, QuaternionsTurnTheRightWay) {
  const Quaternion left = from_rotation_vector({0.0, 0.0, std::numbers::pi / 2.0});
  const Triad forward = rotate(left, {1.0, 0.0, 0.0});
  EXPECT_NEAR(forward[1], 1.0, 1e-12);  // points north
  EXPECT_NEAR(euler(left).yaw_rad, std::numbers::pi / 2.0, 1e-12);
  const Quaternion nose_down = from_rotation_vector({0.0, 0.1, 0.0});
  EXPECT_NEAR(euler(nose_down).pitch_rad, 0.1, 1e-12);
  EXPECT_LT(rotate(nose_down, {1.0, 0.0, 0.0})[2], 0.0);
}

TEST(Orientation, TiltFromGravityAndHeadingFromTheStart) {
  const Quaternion truth = product(
      from_rotation_vector({0.0, 0.0, 0.7}),
      product(from_rotation_vector({0.0, 0.3, 0.0}), from_rotation_vector({-0.2, 0.0, 0.0})));
  OrientationFilter filter(0.7);
  for (int i = 0; i < 4000; ++i) {
    filter.step({}, at_rest(truth), 0.0025);
  }
  const RollPitchYawAngles angles = euler(filter.attitude());
  EXPECT_NEAR(angles.roll_rad, -0.2, 1e-6);
  EXPECT_NEAR(angles.pitch_rad, 0.3, 1e-6);
  // The first alignment turns about a level axis, which is not the one of roll then pitch.
  EXPECT_NEAR(angles.yaw_rad, 0.7, 0.04);
}

TEST(Orientation, HeadingFollowsTheGyroscopeThroughAFullTurnUnderTilt) {
  // Right side down by 60 degrees, turning about the vertical at 30 deg/s for 12 s.
  Quaternion truth = from_rotation_vector({60.0 * kDegree, 0.0, 0.0});
  OrientationFilter filter(0.0);
  filter.step({}, at_rest(truth), 0.0025);
  const double start_rad = euler(filter.attitude()).yaw_rad;
  const double rate_radps = 30.0 * kDegree;
  for (int i = 0; i < 4801; ++i) {  // the first step only starts the mean of two rates
    const Triad body = rotate(conjugate(truth), {0.0, 0.0, rate_radps});
    truth = product(from_rotation_vector({0.0, 0.0, rate_radps * 0.0025}), truth);
    filter.step(body, at_rest(truth), 0.0025);
  }
  const RollPitchYawAngles angles = euler(filter.attitude());
  EXPECT_NEAR(std::remainder(angles.yaw_rad - start_rad, 2.0 * std::numbers::pi), 0.0, 0.01);
  EXPECT_NEAR(angles.roll_rad, 60.0 * kDegree, 1e-3);
}

TEST(Orientation, StandsOnItsHeadWithoutAJump) {
  Quaternion truth{1.0, 0.0, 0.0, 0.0};
  OrientationFilter filter(0.0);
  const double rate_radps = std::numbers::pi / 4.0;
  for (int i = 0; i < 1600; ++i) {  // half a turn about y
    filter.step({0.0, rate_radps, 0.0}, at_rest(truth), 0.0025);
    truth = product(truth, from_rotation_vector({0.0, rate_radps * 0.0025, 0.0}));
  }
  const Triad up = rotate(conjugate(filter.attitude()), {0.0, 0.0, 1.0});
  EXPECT_NEAR(up[2], -1.0, 1e-3);
}

}  // namespace
}  // namespace rigwire::emulators
