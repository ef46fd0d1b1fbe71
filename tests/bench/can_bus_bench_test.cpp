#include "bench/can_bus_bench.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigwire::bench {
namespace {

TEST(CanBusBench, SaturatedBusKeepsItsScheduleToTheNanosecond) {
  const CanBusCost cost = measure_can_bus(20'000);
  EXPECT_EQ(cost.frames, 20'000U);
  EXPECT_EQ(cost.worst_arrival_error_ns, 0.0);
  // 29-bit frames of 0 .. 8 bytes have 67 .. 160 bits.
  EXPECT_GT(cost.wire_frames_per_s, 1e6 / 160);
  EXPECT_LT(cost.wire_frames_per_s, 1e6 / 67);
  EXPECT_TRUE(std::isfinite(cost.frame_ns) && cost.frame_ns > 0.0);
  EXPECT_TRUE(std::isfinite(cost.core_share) && cost.core_share > 0.0);
  EXPECT_TRUE(std::isfinite(cost.failed_attempt_ns) && cost.failed_attempt_ns > 0.0);
}

}  // namespace
}  // namespace rigwire::bench
