#include "bench/gs_usb_bench.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigwire::bench {
namespace {

TEST(GsUsbBench, EveryFrameArrivesAsItWasSent) {
  const auto costs = measure_gs_usb();
  EXPECT_EQ(costs.size(), 4U);
  for (const GsUsbCost& cost : costs) {
    EXPECT_EQ(cost.wrong, 0U) << cost.way;
    EXPECT_TRUE(std::isfinite(cost.nanoseconds) && cost.nanoseconds > 0.0) << cost.way;
    // 1 Mbit/s: the 29-bit frame has 131 to 160 bits, the empty one 47 to 55.
    const bool empty = cost.frame == "11-bit, empty";
    EXPECT_GE(cost.wire_limit_per_second, 1e6 / (empty ? 55 : 160));
    EXPECT_LE(cost.wire_limit_per_second, 1e6 / (empty ? 47 : 131));
  }
}

}  // namespace
}  // namespace rigwire::bench
