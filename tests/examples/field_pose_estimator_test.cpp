#include "field/pose_estimator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>

#include "vehicle_plant.h"

namespace rigwire::field {
namespace {

constexpr double kStep_s = 0.02;

struct Drive {
  double wander_m = 0.0;
  double white_m = 0.0;
  double bias_radps = 0.0;
  double heading_error_rad = 0.0;
  double speed_scale = 1.0;
  double fix_period_s = 1.0;
  double standing_s = 0.0;
  double antenna_x_m = 0.0;
};

struct Errors {
  double position_m = 0.0;  ///< Root mean square over the last two thirds.
  double heading_rad = 0.0;
  double receiver_m = 0.0;  ///< Error of the fixes themselves.
};

/// 120 s of bends at 2 m/s.
Errors drive(const Drive& how, PoseEstimator& estimator) {
  VehiclePlant plant;
  TestReceiver receiver(how.wander_m, how.white_m, 7);
  const auto antenna = [&] {
    return PlanePosition{plant.position.east_m + how.antenna_x_m * std::cos(plant.heading_rad),
                         plant.position.north_m + how.antenna_x_m * std::sin(plant.heading_rad)};
  };
  estimator.start(receiver.measure(antenna(), 1.0), how.heading_error_rad, 0.3);
  Errors errors;
  int counted = 0;
  int fixes = 0;
  constexpr int kSteps = 6000;
  const int every = static_cast<int>(how.fix_period_s / kStep_s);
  for (int i = 1; i <= kSteps; ++i) {
    const double t = i * kStep_s;
    plant.wish_mps = t < how.standing_s ? 0.0 : 2.0;
    plant.curvature_1pm = 0.06 * std::sin(0.2 * t);
    plant.step(kStep_s);
    estimator.advance(kStep_s, plant.speed_mps * how.speed_scale, plant.slip_rad,
                      plant.yaw_rate_radps + how.bias_radps);
    if (i % every == 0) {
      const PlanePosition fix = receiver.measure(antenna(), how.fix_period_s);
      estimator.position(fix);
      if (i > kSteps / 3) {
        errors.receiver_m += std::pow(fix.east_m - antenna().east_m, 2) +
                             std::pow(fix.north_m - antenna().north_m, 2);
        ++fixes;
      }
      const double course = plant.heading_rad + plant.slip_rad +
                            std::atan2(plant.yaw_rate_radps * how.antenna_x_m, plant.speed_mps);
      const double noise = how.white_m > 0.0 ? 0.05 * receiver.normal() : 0.0;
      estimator.course(wrapped(course + noise), plant.speed_mps);
    }
    if (i > kSteps / 3) {
      const Pose pose = estimator.pose();
      errors.position_m += std::pow(pose.position.east_m - plant.position.east_m, 2) +
                           std::pow(pose.position.north_m - plant.position.north_m, 2);
      errors.heading_rad += std::pow(wrapped(pose.heading_rad - plant.heading_rad), 2);
      ++counted;
    }
  }
  errors.position_m = std::sqrt(errors.position_m / counted);
  errors.heading_rad = std::sqrt(errors.heading_rad / counted);
  errors.receiver_m = std::sqrt(errors.receiver_m / fixes);
  return errors;
}

PoseEstimatorSettings prompt() {
  PoseEstimatorSettings settings;
  settings.gnss_age_s = 0.0;
  return settings;
}

TEST(FieldPoseEstimator, ExactSensorsGiveTheExactPose) {
  PoseEstimator estimator(prompt());
  const Errors errors = drive({}, estimator);
  EXPECT_LT(errors.position_m, 0.02);
  EXPECT_LT(errors.heading_rad, 0.002);
}

TEST(FieldPoseEstimator, LearnsHeadingAndBias) {
  PoseEstimator estimator(prompt());
  const Errors errors =
      drive({.bias_radps = 0.01, .heading_error_rad = 0.4, .standing_s = 0.0}, estimator);
  EXPECT_NEAR(estimator.bias_radps(), 0.01, 0.002);
  EXPECT_LT(errors.heading_rad, 0.03);
}

TEST(FieldPoseEstimator, LearnsThatTheWheelsSlip) {
  PoseEstimator estimator(prompt());
  const Errors errors = drive({.speed_scale = 1.1}, estimator);
  EXPECT_NEAR(estimator.scale_error(), 1.0 / 1.1 - 1.0, 0.02);
  EXPECT_LT(errors.position_m, 0.6);
}

TEST(FieldPoseEstimator, StandingTeachesTheBias) {
  PoseEstimator estimator(prompt());
  estimator.start({0, 0}, 1.0, 0.3);
  for (int i = 0; i < 250; ++i) {
    estimator.advance(kStep_s, 0.0, 0.0, -0.015);
  }
  EXPECT_NEAR(estimator.bias_radps(), -0.015, 0.001);
  EXPECT_EQ(estimator.pose().heading_rad, 1.0);
  EXPECT_EQ(estimator.pose().yaw_rate_radps, 0.0);
}

TEST(FieldPoseEstimator, SmoothsWhiteNoise) {
  PoseEstimator estimator(prompt());
  const Errors errors = drive({.white_m = 1.5, .heading_error_rad = 0.2}, estimator);
  EXPECT_GT(errors.receiver_m, 1.5);
  EXPECT_LT(errors.position_m, 0.4 * errors.receiver_m);
  EXPECT_LT(errors.heading_rad, 0.05);
}

TEST(FieldPoseEstimator, FollowsAReceiverThatWandersAndGetsNoWorse) {
  PoseEstimator estimator(prompt());
  const Errors errors = drive({.wander_m = 1.0,
                               .white_m = 0.5,
                               .bias_radps = 0.005,
                               .heading_error_rad = 0.2,
                               .speed_scale = 1.02},
                              estimator);
  // What wanders slowly cannot be told from moving.
  EXPECT_LT(errors.position_m, 1.2 * errors.receiver_m);
  EXPECT_LT(errors.heading_rad, 0.06);
}

TEST(FieldPoseEstimator, AntennaAheadOfTheAxle) {
  PoseEstimatorSettings settings = prompt();
  settings.antenna_x_m = 2.5;
  PoseEstimator estimator(settings);
  const Errors errors = drive({.antenna_x_m = 2.5}, estimator);
  EXPECT_LT(errors.position_m, 0.05);
  EXPECT_LT(errors.heading_rad, 0.01);
}

TEST(FieldPoseEstimator, AMachineWithoutFixesIsLostWhenItMayBeTooFarOff) {
  constexpr double kAllowed_m = 3.5;
  PoseEstimator estimator(prompt());
  estimator.start({0, 0}, 0.0, 0.1);
  for (int i = 0; i < 500; ++i) {
    estimator.advance(kStep_s, 2.0, 0.0, 0.0);
    estimator.position({2.0 * kStep_s * (i + 1), 0});
    EXPECT_FALSE(lost(estimator.pose(), kAllowed_m)) << "with fixes";
  }
  double blind_s = 0.0;
  std::optional<std::string> why;
  for (; !why && blind_s < 120.0; blind_s += kStep_s) {
    estimator.advance(kStep_s, 2.0, 0.0, 0.0);
    why = lost(estimator.pose(), kAllowed_m);
  }
  ASSERT_TRUE(why);
  EXPECT_NE(why->find("no position for"), std::string::npos);
  EXPECT_GE(blind_s, 3.0);
  EXPECT_GE(2.0 * estimator.pose().position_sigma_m, kAllowed_m);
}

TEST(FieldPoseEstimator, AMachineThatWaitedLongForItsFirstFixIsNotLostForThat) {
  PoseEstimator estimator({.gnss_sigma_m = 2.5});
  for (int i = 0; i < 60 * 50; ++i) {
    estimator.advance(kStep_s, 0.0, 0.0, 0.0);
  }
  estimator.start({}, 0.0, 0.1);
  EXPECT_EQ(lost(estimator.pose(), 3.5), std::nullopt);
}

TEST(FieldPoseEstimator, OneWildFixIsNotBelievedManyAre) {
  PoseEstimator estimator(prompt());
  estimator.start({0, 0}, 0.0, 0.1);
  for (int i = 0; i < 20; ++i) {
    estimator.advance(kStep_s, 0.0, 0.0, 0.0);
    estimator.position({0, 0});
  }
  estimator.position({80, 0});
  EXPECT_LT(std::abs(estimator.pose().position.east_m), 0.1);
  EXPECT_EQ(estimator.rejected(), 1U);
  for (int i = 0; i < 8; ++i) {
    estimator.advance(1.0, 0.0, 0.0, 0.0);
    estimator.position({80, 0});
  }
  EXPECT_NEAR(estimator.pose().position.east_m, 80.0, 3.0);
}

}  // namespace
}  // namespace rigwire::field
