#include "bench/rig_bench.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "bench/private_rig.h"

namespace rigwire::bench {
namespace {

TEST(RigBench, FreeRunCountsEveryShotAndKeepsItsBytesWhateverTheThreads) {
  const FreeRun one = measure_free_run(std::chrono::milliseconds{500}, 1);
  const FreeRun two = measure_free_run(std::chrono::milliseconds{500}, 2);
  EXPECT_DOUBLE_EQ(one.sim_s, 0.5);
  // Whole packets of 384 shots, 694 444 a second.
  EXPECT_NEAR(one.points_per_s * one.wall_s, 0.5 * 694'444.0, 2 * 384.0);
  EXPECT_GT(one.truth.ray_casting_s, 0.0);
  EXPECT_GT(one.peak_rss_mb, 1.0);
  EXPECT_TRUE(same_bytes(one, two));
}

TEST(RigBench, OtherBytesAreSeen) {
  const FreeRun one = measure_free_run(std::chrono::milliseconds{40}, 1);
  const FreeRun longer = measure_free_run(std::chrono::milliseconds{60}, 1);
  EXPECT_FALSE(same_bytes(one, longer));
}

TEST(RigBench, PacedRunHearsTheMasterAndRecordsLateness) {
  const PacedRun run = measure_paced_run(std::chrono::milliseconds{500});
  EXPECT_GT(run.exchanges, 5U);
  for (const hil::DeviceReport& device : run.devices) {
    if (device.name == "lidar" || device.name == "valves") {
      EXPECT_GT(device.statistics.lateness.count(), 5U) << device.name;
    }
  }
}

TEST(PrivateRig, TwoStandSideBySideAndLeaveNothingBehind) {
  std::string folder;
  {
    const PrivateRig one;
    const PrivateRig two;
    const auto path_of = [](const PrivateRig& rig) {
      return std::filesystem::path(rig.configuration().buses.at("can").path);
    };
    EXPECT_NE(path_of(one), path_of(two));
    EXPECT_NE(one.modbus_port(), two.modbus_port());
    folder = path_of(one).parent_path();
    EXPECT_TRUE(std::filesystem::exists(folder));
  }
  EXPECT_FALSE(std::filesystem::exists(folder));
}

}  // namespace
}  // namespace rigwire::bench
