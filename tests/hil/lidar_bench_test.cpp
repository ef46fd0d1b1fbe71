#include "hil/bench/lidar_bench.h"

#include <gtest/gtest.h>

namespace rigwire::hil {
namespace {

TEST(LidarBench, RangeErrorStaysUnderHalfADistanceUnitFarFromTheMapOrigin) {
  const auto errors = measure_lidar_range_error({0.0, 10e3, 1000e3});
  ASSERT_EQ(errors.size(), 3U);
  for (const LidarRangeError& error : errors) {
    EXPECT_GT(error.rays, 50000U);
    EXPECT_EQ(error.leaks, 0U) << error.map_offset_m;
    EXPECT_LT(error.worst_m, 1e-3) << error.map_offset_m;
    RecordProperty("worst_um_at_" + std::to_string(static_cast<int>(error.map_offset_m)),
                   std::to_string(error.worst_m * 1e6));
  }
}

TEST(LidarBench, StageAndBareCasterSeeTheSameRays) {
  const LidarStageCost cost = measure_lidar_stage(5, 1);
  EXPECT_NEAR(static_cast<double>(cost.rays), 69440.0, 64.0);
  EXPECT_GT(cost.hit_share, 0.7);
  EXPECT_GT(cost.ratio, 0.2);
  EXPECT_LE(cost.bare_s, 1.5 * cost.stage_s);
}

TEST(LidarBench, RecommitCountsTheInstances) {
  const RecommitCost cost = measure_recommit(4, 10);
  EXPECT_EQ(cost.moving_instances, 4U);
  EXPECT_GT(cost.instances, 40U);
  EXPECT_GT(cost.mean_s, 0.0);
}

}  // namespace
}  // namespace rigwire::hil
