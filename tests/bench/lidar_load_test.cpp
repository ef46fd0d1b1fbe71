#include <gtest/gtest.h>

#include <stdexcept>

#include "bench/lidar_geometry.h"
#include "bench/lidar_load.h"

namespace rigwire::bench {
namespace {

TEST(LidarLoad, CountsWhatTheLidarsOfAVehicleCast) {
  const auto loads = measure_lidar_load(
      make_instanced_forest(), {{.lidars = 2, .threads = 2, .slice_ms = 10, .revolutions = 1}});
  ASSERT_EQ(loads.size(), 1U);
  const LidarLoad& load = loads[0];
  EXPECT_EQ(load.instances, 2521U) << "ground, trees, bodies";
  EXPECT_NEAR(static_cast<double>(load.rays), 2.0 * 69'440.0, 128.0);
  EXPECT_GT(load.hit_share, 0.5);
  EXPECT_GT(load.core_share, 0.0);
  EXPECT_GT(load.wall_share, 0.0);
  EXPECT_GT(load.encoding_share, 0.0);
  EXPECT_THROW((void)measure_lidar_load(make_instanced_forest(), {{.lidars = 5}}),
               std::invalid_argument);
}

TEST(LidarGeometry, NoRayGetsOutOfAClosedMesh) {
  const LidarLeaks leaks = count_lidar_leaks(500'000);
  EXPECT_GE(leaks.rays, 500'000U);
  EXPECT_EQ(leaks.leaks, 0U);
  EXPECT_EQ(leaks.strayed, 0U);
}

TEST(LidarGeometry, BodiesThatMoveWithinASliceAreSeenWhereTheyAre) {
  const auto intervals = measure_rebuild_intervals({5, 50});
  ASSERT_EQ(intervals.size(), 4U);
  for (const RebuildInterval& interval : intervals) {
    EXPECT_GT(interval.rays, 5000U);
    const double h = 1e-3 * interval.slice_ms;
    // Poses blended: the arc's height over its chord. Held: the plate's own speed towards the
    // sensor, which stands beside the boom's axis, for half a slice.
    EXPECT_LT(interval.worst_m, interval.blended ? 8.1 * h * h / 8.0 * 1.3 + 2e-5 : 2.5 * h);
    EXPECT_GT(interval.worst_m, interval.blended ? 0.0 : 0.1 * h);
    EXPECT_LE(interval.missed, interval.blended ? 0U : interval.rays / 2);
  }
  EXPECT_THROW((void)measure_rebuild_intervals({0}), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::bench
