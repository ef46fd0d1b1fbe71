#include "sim/gnss/receiver_clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;

TEST(ReceiverClockTest, MeasuresWhenItShowsAWholeMillisecond) {
  ReceiverClock clock({}, 1, "clock");
  for (SimTime t = kStart; t < kStart + 3h; t += 1s) {
    const ClockEpoch epoch = clock.measure(t);
    EXPECT_LE(std::abs(epoch.measured_after_s), 0.5e-3 + 1e-9);
    EXPECT_LE(std::abs(epoch.bias_s), 1e-3 + 1e-9);
    EXPECT_EQ(epoch.label_offset % 1ms, 0ns);
    EXPECT_LE(std::chrono::abs(epoch.label_offset), 1ms);
    EXPECT_DOUBLE_EQ(epoch.measured_after_s + epoch.bias_s, to_seconds(epoch.label_offset));
    EXPECT_NEAR(to_seconds(epoch.measured_after), epoch.measured_after_s, 0.5e-9 + 1e-15);
  }
}

TEST(ReceiverClockTest, BiasIsASawToothOfMilliseconds) {
  // -430 ns/s: a reset after each 2326 s; in between the bias falls by the drift.
  ReceiverClockParameters parameters;
  parameters.wander_sigma = 0.0;
  ReceiverClock clock(parameters, 7, "clock");
  ClockEpoch before = clock.measure(kStart);
  std::vector<SimTime> resets;
  int labels_behind = 0;
  for (SimTime t = kStart + 1s; t < kStart + 4h; t += 1s) {
    const ClockEpoch epoch = clock.measure(t);
    const double true_step_s = 1.0 + epoch.measured_after_s - before.measured_after_s;
    const double step_s = epoch.bias_s - before.bias_s - parameters.drift * true_step_s;
    EXPECT_NEAR(step_s, epoch.reset ? 1e-3 : 0.0, 1e-15);
    EXPECT_NEAR(epoch.drift, parameters.drift, 1e-16);
    if (epoch.reset) {
      resets.push_back(t);
    }
    labels_behind += epoch.label_offset == -1ms ? 1 : 0;
    before = epoch;
  }
  ASSERT_GE(resets.size(), 5U);
  EXPECT_NEAR(to_seconds(resets[2] - resets[1]), 1e-3 / 4.3e-7, 2.0);
  EXPECT_NEAR(labels_behind / (4.0 * 3'600.0), 0.5, 0.1);  // iTOW ends with 999 half of the time
}

TEST(ReceiverClockTest, DriftIsTheDerivativeOfTheBias) {
  ReceiverClockParameters parameters;
  parameters.wander_sigma = 1e-7;
  parameters.wander_correlation_s = 20.0;
  ReceiverClock clock(parameters, 3, "clock");
  std::vector<ClockEpoch> epochs;
  for (SimTime t = kStart; t < kStart + 30s; t += 10ms) {
    epochs.push_back(clock.measure(t));
  }
  for (std::size_t i = 1; i + 1 < epochs.size(); ++i) {
    const double span_s = 0.02 + epochs[i + 1].measured_after_s - epochs[i - 1].measured_after_s;
    EXPECT_NEAR((epochs[i + 1].bias_s - epochs[i - 1].bias_s) / span_s, epochs[i].drift, 1e-9);
  }
}

TEST(ReceiverClockTest, TrajectoryDoesNotDependOnTheEpochs) {
  ReceiverClockParameters parameters;
  parameters.wander_sigma = 2e-8;
  ReceiverClock fast(parameters, 5, "clock");
  ReceiverClock slow(parameters, 5, "clock");
  for (SimTime t = kStart; t <= kStart + 600s; t += 50ms) {
    const ClockEpoch of_fast = fast.measure(t);
    if (t.time_since_epoch() % 7s == 0s) {
      const ClockEpoch of_slow = slow.measure(t);
      EXPECT_EQ(of_fast.bias_s, of_slow.bias_s);
      EXPECT_EQ(of_fast.drift, of_slow.drift);
    }
  }
}

TEST(ReceiverClockTest, WanderHasItsSigmaAndItsCorrelation) {
  ReceiverClockParameters parameters;
  parameters.wander_sigma = 5e-9;
  parameters.wander_correlation_s = 50.0;
  ReceiverClock clock(parameters, 11, "clock");
  constexpr int kSeconds = 200'000;
  constexpr int kLag = 50;
  std::vector<double> wander;
  for (int i = 0; i < kSeconds; ++i) {
    wander.push_back(clock.measure(kStart + i * 1s).drift - parameters.drift);
  }
  double square = 0.0;
  double lagged = 0.0;
  for (std::size_t i = 0; i + kLag < wander.size(); ++i) {
    square += wander[i] * wander[i];
    lagged += wander[i] * wander[i + kLag];
  }
  EXPECT_NEAR(std::sqrt(square / kSeconds), 5e-9, 0.3e-9);
  EXPECT_NEAR(lagged / square, std::exp(-1.0), 0.05);
}

TEST(ReceiverClockTest, OtherNamesHaveOtherClocks) {
  ReceiverClock a({}, 5, "a");
  ReceiverClock b({}, 5, "b");
  EXPECT_NE(a.measure(kStart).bias_s, b.measure(kStart).bias_s);
}

TEST(ReceiverClockTest, RefusesStrangeParameters) {
  EXPECT_THROW(ReceiverClock({.drift = 2e-4}, 1, "c"), std::invalid_argument);
  EXPECT_THROW(ReceiverClock({.wander_sigma = -1e-9}, 1, "c"), std::invalid_argument);
  EXPECT_THROW(ReceiverClock({.wander_correlation_s = 0.0}, 1, "c"), std::invalid_argument);
  EXPECT_THROW(ReceiverClock({.bias_limit_s = 4e-4}, 1, "c"), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
