#include "bench/can_hop_bench.h"

#include <gtest/gtest.h>

namespace rigwire::bench {
namespace {

TEST(CanHopBench, EveryFrameArrivesAndCostsSomething) {
  constexpr std::size_t kFrames = 2'000;
  for (const CanHopCost& cost : measure_can_hops(kFrames)) {
    EXPECT_EQ(cost.sent, kFrames) << cost.hop;
    EXPECT_EQ(cost.received, kFrames) << cost.hop;
    EXPECT_GT(cost.device_ns, 0.0) << cost.hop;
    EXPECT_GE(cost.both_ns, cost.device_ns) << cost.hop;
    // The frame has 143 bits, stuff bits and interframe space included.
    EXPECT_NEAR(cost.wire_limit_per_second, 1e6 / 143, 1e-6) << cost.hop;
  }
}

}  // namespace
}  // namespace rigwire::bench
