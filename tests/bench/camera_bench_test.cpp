#include "bench/camera_bench.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigwire::bench {
namespace {

Eigen::Isometry3d above_the_floor() {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() << -14.0, -8.0, 2.2;
  return X;
}

TEST(CameraBench, MoreSamplesAreNearerToMany) {
  const CameraCase terrain("terrain", above_the_floor());
  const auto errors = measure_sampling(terrain, 64, {1, 4, 16}, 64);
  ASSERT_EQ(errors.size(), 3U);
  EXPECT_GT(errors[0].rms_levels, errors[1].rms_levels);
  EXPECT_GT(errors[1].rms_levels, errors[2].rms_levels);
  EXPECT_GT(errors[2].rms_levels, 0.0);
  EXPECT_LT(errors[0].rms_levels, 40.0);
}

TEST(CameraBench, ComparesTheSameRays) {
  const CameraCase terrain("terrain", above_the_floor());
  const PictureCost cost = measure_picture(terrain, 160, 1, 3);
  EXPECT_EQ(cost.pixels, 160U * 120U);
  EXPECT_GT(cost.shadow_share, 0.2);
  EXPECT_LE(cost.shadow_share, 1.0);
  EXPECT_GT(cost.bare_s, 0.0);
  EXPECT_LT(cost.ratio, 1.2);
  EXPECT_GT(cost.ratio, 0.02);
}

TEST(CameraBench, TheLatticeOfTheSkyIsNearerThanNone) {
  const CameraCase terrain("terrain", above_the_floor());
  const auto costs = measure_sky(terrain, 64, {-1, 0}, 64);
  ASSERT_EQ(costs.size(), 2U);
  EXPECT_LT(std::abs(costs[1].bias_levels), std::abs(costs[0].bias_levels) + 0.2);
}

TEST(CameraBench, TheSensorsFiguresComeBackWithinThreePercent) {
  for (const SensorFigure& figure : measure_sensor()) {
    EXPECT_NEAR(figure.found / figure.set, 1.0, 0.03) << figure.figure;
  }
}

}  // namespace
}  // namespace rigwire::bench
