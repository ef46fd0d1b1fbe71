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
  const auto errors = measure_sampling(terrain, 64, sampling_ways(), 64, 1);
  ASSERT_EQ(errors.size(), 5U);
  EXPECT_GT(errors[0].rms_levels, errors[1].rms_levels);
  EXPECT_GT(errors[1].rms_levels, errors[3].rms_levels);
  EXPECT_GT(errors[3].rms_levels, errors[4].rms_levels);
  EXPECT_GT(errors[4].rms_levels, 0.0);
  EXPECT_LT(errors[0].rms_levels, 40.0);
}

// Flecks of sun and leaves within a pixel: a ray through its middle sees one of them. Samples that
// fall together, or of which but one counts, leave the error of one.
TEST(CameraBench, BlurEdgesAndSamplesBringTheForestNearerAsThePageSays) {
  const auto errors = measure_sampling(forest_case(), 200, sampling_ways(), 64, 1);
  ASSERT_EQ(errors.size(), 5U);
  EXPECT_GT(errors[0].rms_levels, 40.0) << "the middle alone";
  EXPECT_LT(errors[1].rms_levels, 0.75 * errors[0].rms_levels) << "blur";
  EXPECT_LT(errors[2].rms_levels, 0.6 * errors[0].rms_levels) << "four rays at edges";
  EXPECT_LT(errors[3].rms_levels, 0.6 * errors[0].rms_levels) << "four samples";
  EXPECT_LT(errors[4].rms_levels, 0.6 * errors[3].rms_levels) << "16 samples";
}

TEST(CameraBench, APictureOnAWallIsDearerThanItsLabelAndAsNearWithOneSample) {
  const auto costs = measure_textures(160, 3, 64);
  ASSERT_EQ(costs.size(), 9U);
  for (std::size_t view = 0; view < costs.size(); view += 3) {
    const TextureCost& label = costs[view];
    const TextureCost& picture = costs[view + 2];
    EXPECT_EQ(label.ratio, 1.0);
    EXPECT_GT(picture.ratio, 0.5) << label.view;
    EXPECT_LT(picture.ratio, 10.0) << label.view;
    EXPECT_GT(picture.rms_levels, costs[view + 1].rms_levels) << label.view;
    // Texels narrower than a pixel are averaged over it: without, each pixel would show one of
    // them, 46 levels rms at their contrast.
    EXPECT_LT(picture.rms_levels, 20.0) << label.view;
  }
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
