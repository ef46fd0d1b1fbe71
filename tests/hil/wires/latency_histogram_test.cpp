#include "hil/wires/latency_histogram.h"

#include <gtest/gtest.h>

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;

TEST(LatencyHistogram, IsEmptyAtFirst) {
  const LatencyHistogram histogram;
  EXPECT_EQ(histogram.count(), 0U);
  EXPECT_EQ(histogram.percentile(0.99), 0ns);
}

TEST(LatencyHistogram, PercentilesStayWithinThreePercentOverTheWholeRange) {
  for (const Duration value : {Duration{1ns}, Duration{63ns}, Duration{64ns}, Duration{997ns},
                               Duration{123'456ns}, Duration{50ms}, Duration{17min}}) {
    LatencyHistogram histogram;
    histogram.record(value);
    histogram.record(18min);  // so that max() does not clip the percentile
    const double found = to_seconds(histogram.percentile(0.5));
    EXPECT_GE(found, to_seconds(value));
    EXPECT_LE(found, to_seconds(value) * 1.032);
  }
}

TEST(LatencyHistogram, SplitsAUniformRampWhereItShould) {
  LatencyHistogram histogram;
  for (int us = 1; us <= 1000; ++us) {
    histogram.record(std::chrono::microseconds{us});
  }
  EXPECT_NEAR(to_seconds(histogram.percentile(0.5)), 500e-6, 500e-6 * 0.032);
  EXPECT_NEAR(to_seconds(histogram.percentile(0.99)), 990e-6, 990e-6 * 0.032);
  EXPECT_EQ(histogram.max(), 1000us);
  EXPECT_EQ(histogram.percentile(1.0), 1000us);
}

TEST(LatencyHistogram, TellsHowManyLieBelowAnEdgeAndTheirSum) {
  LatencyHistogram histogram;
  for (int us = 1; us <= 1000; ++us) {
    histogram.record(std::chrono::microseconds{us});
  }
  EXPECT_EQ(histogram.up_to(Duration{-1}), 0U);
  EXPECT_NEAR(static_cast<double>(histogram.up_to(std::chrono::microseconds{100})), 100.0, 3.5);
  EXPECT_NEAR(static_cast<double>(histogram.up_to(std::chrono::microseconds{500})), 500.0, 16.0);
  EXPECT_EQ(histogram.up_to(std::chrono::microseconds{1000}), 1000U);
  EXPECT_EQ(histogram.sum(), std::chrono::microseconds{500'500});
}

TEST(LatencyHistogram, TakesNegativeAndAbsurdSpans) {
  LatencyHistogram histogram;
  histogram.record(-5ms);
  histogram.record(Duration::max());
  EXPECT_EQ(histogram.percentile(0.5), 0ns);
  EXPECT_EQ(histogram.max(), Duration::max());
}

}  // namespace
}  // namespace rigwire::hil
