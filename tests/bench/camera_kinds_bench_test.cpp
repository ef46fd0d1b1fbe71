#include "bench/camera_kinds_bench.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigwire::bench {
namespace {

CameraCase terrain() {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() << -14.0, -8.0, 2.2;
  return {"terrain", X};
}

TEST(CameraKindsBench, MatchingIsDearerAndWrongerThanTruth) {
  const CameraCase scene = terrain();
  const StereoCost matched = measure_stereo(scene, "5 paths", {}, 1);
  sim::StereoMatchingParameters parameters;
  parameters.method = sim::MatchingMethod::truth;
  const StereoCost truth = measure_stereo(scene, "truth", parameters, 1);
  EXPECT_GT(matched.disparity_s, truth.disparity_s);
  EXPECT_GT(matched.all.median_px, 0.02);
  EXPECT_LT(matched.all.median_px, 0.5);
  EXPECT_LT(truth.all.median_px, 1e-3);
  // Depth errors grow with the square of the depth, about.
  ASSERT_EQ(matched.bands.size(), 4U);
  EXPECT_GT(matched.bands[2].median_m, 3.0 * matched.bands[0].median_m);
}

TEST(CameraKindsBench, RangesHaveTheNoiseThatIsSet) {
  int with_range = 0;
  int without = 0;
  for (const RangeNoise& noise : measure_range_noise()) {
    if (noise.set_m > 0.025) {
      EXPECT_LT(noise.valid, 0.01) << noise.surface << noise.distance_m;
      ++without;
    } else if (noise.set_m < 0.015) {
      EXPECT_GT(noise.valid, 0.99) << noise.surface << noise.distance_m;
      EXPECT_NEAR(noise.found_m / noise.set_m, 1.0, 0.05) << noise.surface << noise.distance_m;
      ++with_range;
    }
  }
  EXPECT_GE(with_range, 8);
  EXPECT_GE(without, 1);
}

TEST(CameraKindsBench, MoreSamplesOfRaysAreNearerToMany) {
  const auto costs = measure_all_round(terrain(), 16, 1);
  ASSERT_GE(costs.size(), 4U);
  EXPECT_LT(costs[1].rms_levels, costs[0].rms_levels);
  EXPECT_EQ(costs[0].seen, 1.0);
  EXPECT_GT(costs[2].seen, 0.999);  // so high that they meet at the corners
  EXPECT_LT(std::abs(costs[3].bias_levels), 3.0);
}

}  // namespace
}  // namespace rigwire::bench
