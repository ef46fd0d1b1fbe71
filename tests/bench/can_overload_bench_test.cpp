#include "bench/can_overload_bench.h"

#include <gtest/gtest.h>

namespace rigwire::bench {
namespace {

TEST(CanOverloadBench, TheLeastUrgentStarveAndNobodyElse) {
  const CanOverload overload = measure_can_overload(5);
  EXPECT_NEAR(overload.offered_load, 1.3, 1e-6);
  EXPECT_GT(overload.bus_load, 0.999);
  ASSERT_EQ(overload.nodes.size(), 8U);
  // 1 / 1.3 of eight nodes' traffic fits: six get all of it, the seventh some, the eighth none.
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(overload.nodes[i].lost_share, 0.0) << i;
    EXPECT_NEAR(overload.nodes[i].sent_per_s, overload.nodes[i].offered_per_s, 2.0) << i;
  }
  EXPECT_GT(overload.nodes[6].lost_share, 0.5);
  EXPECT_LT(overload.nodes[6].lost_share, 1.0);
  EXPECT_GT(overload.nodes[7].lost_share, 0.97);
}

}  // namespace
}  // namespace rigwire::bench
