#include "bench/encoding_bench.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigwire::bench {
namespace {

TEST(EncodingBench, EveryMessageIsReadBackWithinHalfACount) {
  const auto costs = measure_messages();
  EXPECT_EQ(costs.size(), 6U);
  for (const MessageCost& cost : costs) {
    EXPECT_LE(cost.worst_error, 1.001 * cost.half_count) << cost.message;
    EXPECT_GT(cost.bytes, 0U) << cost.message;
    EXPECT_TRUE(std::isfinite(cost.nanoseconds) && cost.nanoseconds > 0.0) << cost.message;
    EXPECT_TRUE(std::isfinite(cost.per_second)) << cost.message;
    EXPECT_GT(cost.wire_limit_per_second, 0.0) << cost.message;
  }
}

}  // namespace
}  // namespace rigwire::bench
