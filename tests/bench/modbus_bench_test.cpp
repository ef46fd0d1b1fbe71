#include "bench/modbus_bench.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rigwire::bench {
namespace {

TEST(ModbusBench, measures_both_servers_and_every_answer_is_right) {
  const ModbusBench bench = measure_modbus({.rounds = 2, .transactions = 64, .pipelined = 8});
  EXPECT_EQ(bench.wrong_answers, 0U);
  EXPECT_GT(bench.per_second, 0.0);
  EXPECT_GT(bench.pipelined_per_second, 0.0);
  EXPECT_GT(bench.nanoseconds_alone, 0.0);
  EXPECT_LE(bench.modbus.p50_us, bench.modbus.p99_us);
  EXPECT_GT(bench.echo.p50_us, 0.0);
  EXPECT_DOUBLE_EQ(bench.ratio_p50, bench.modbus.p50_us / bench.echo.p50_us);
}

}  // namespace
}  // namespace rigwire::bench
