#include "bench/lidar_bench.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "bench/private_rig.h"
#include "hil/command_line/config_files.h"
#include "sanitized.h"

namespace rigwire::bench {
namespace {

hil::RigConfiguration bench_rig_configuration() {
  return hil::load_rig(hil::find_rig(kBenchRig), {}).configuration;
}

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

TEST(LidarBench, StageAndBareCasterSeeTheSameRaysOfTheRigsOwnScene) {
  const auto costs = measure_lidar_stage(bench_rig_configuration(), {5}, 1);
  ASSERT_EQ(costs.size(), 1U);
  const LidarStageCost& cost = costs[0];
  EXPECT_EQ(cost.slice_ms, 5);
  EXPECT_GT(cost.instances, 80U) << "rocks and links are in the scene";
  EXPECT_NEAR(static_cast<double>(cost.rays), 69440.0, 64.0);
  EXPECT_GT(cost.hits, cost.rays / 2);
  EXPECT_LT(cost.hits, cost.rays);
  EXPECT_GT(cost.begin_slice_s, 0.0);
  EXPECT_GT(cost.ratio, kSanitized ? 0.0 : 0.2);
  EXPECT_LE(cost.bare_s, 1.5 * cost.stage_s);
}

TEST(LidarBench, RefusesWhatMeasuresNothing) {
  hil::RigConfiguration rig = bench_rig_configuration();
  EXPECT_THROW((void)measure_lidar_stage(rig, {0}, 1), std::invalid_argument);
  EXPECT_THROW((void)measure_lidar_stage(rig, {1}, 0), std::invalid_argument);
  rig.devices.erase("lidar");
  EXPECT_THROW((void)measure_lidar_stage(rig, {1}, 1), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::bench
