// A node's own clock: exact conversion, what a device does by it, and that the phases of two nodes
// of a bus pass over each other, as they do on every real one.
#include "emulators/own_clock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include "emulators/iso_valve/iso_valves.h"
#include "emulators/xsens/mti_600.h"
#include "recorder.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using protocols::can::Frame;

/// A unit of which only the sample time and one vector are on, every 10 ms.
MtiSettings two_messages() {
  MtiSettings settings;
  for (MtiOutput& output : settings.outputs) {
    using protocols::xsens::MessageId;
    output.divider =
        output.id == MessageId::sample_time || output.id == MessageId::acceleration ? 4 : 0;
  }
  return settings;
}

/// One unit on a clock of its own, as the run sees it.
struct Node {
  Node(double error, Duration jitter, std::uint64_t seed = 1)
      : clock(error, kStart, Mti600::kTick),
        output(clock, jitter, seed, wire),
        unit(two_messages(), calendar, output),
        node(clock, unit) {}

  void run(SimTime end) {
    const SamplePlan plan = node.sample_plan();
    for (SimTime next = plan.first; next <= end; next = plan.next_after(next)) {
      ImuSample sample;
      sample.time = next;
      sample.specific_force_mps2 = {0.0, 0.0, 9.80665};
      node.update(sample);
    }
    node.advance(end);
  }

  /// Due times of the message that begins each set.
  [[nodiscard]] std::vector<SimTime> sets() const {
    std::vector<SimTime> result;
    for (const auto& [due, frame] : wire.frames) {
      if (frame.id == static_cast<std::uint32_t>(protocols::xsens::MessageId::sample_time)) {
        result.push_back(due);
      }
    }
    return result;
  }

  Calendar calendar{UtcTime{2026, 6, 1, 8, 0, 0, 0}};
  test::FrameRecorder wire;
  OwnClock clock;
  OwnClockOutput output;
  Mti600 unit;
  OnOwnClock<Mti600, ImuBackend> node;
};

TEST(OwnClock, ConvertsBothWaysWithoutDrift) {
  const SimTime start = kStart + 1234567ns;
  for (const double error : {0.0, 37e-6, -37e-6, 1e-3, -1e-3}) {
    const OwnClock clock(error, start, 10ms);
    EXPECT_NEAR(clock.error(), error, 1e-7) << "rounded to 1 ns of 10 ms";
    SimTime before = kStart;
    for (std::int64_t i = 0; i < 200'000; ++i) {
      const SimTime own{Duration{i * 999'983 / 7}};
      const SimTime run = clock.run_time(own);
      ASSERT_GE(run, before);
      before = run;
      const Duration back = clock.own_time(run) - own;
      ASSERT_TRUE(back == 0ns || back == 1ns) << error << ' ' << i;
    }
    // After a year it is off by its error, to the nanosecond.
    const SimTime year = start + Duration{std::chrono::hours{24 * 365}};
    const auto periods = Duration{std::chrono::hours{24 * 365}} / Duration{10ms};
    EXPECT_EQ(clock.run_time(year) - start,
              periods * (clock.run_time(start + 10ms) - clock.run_time(start)));
  }
}

TEST(OwnClock, ShowsTheRunsTimeUntilItsSupplyComes) {
  const OwnClock clock(100e-6, kStart + 5s, 10ms);
  EXPECT_EQ(clock.own_time(kStart + 4s), kStart + 4s);
  EXPECT_EQ(clock.run_time(kStart + 5s), kStart + 5s);
  EXPECT_EQ(clock.run_time(kNever), kNever);
  EXPECT_EQ(clock.own_time(kNever), kNever);
  EXPECT_NEAR(to_seconds(clock.own_time(kStart + 15s)), 15.001, 1e-6);
}

TEST(OwnClock, WithoutErrorAndJitterChangesNothing) {
  Node node(0.0, 0ns);
  node.run(kStart + 1s);
  test::FrameRecorder wire;
  Mti600 bare(two_messages(), node.calendar, wire);
  for (SimTime next = kStart; next <= kStart + 1s; next += Mti600::kTick) {
    ImuSample sample;
    sample.time = next;
    sample.specific_force_mps2 = {0.0, 0.0, 9.80665};
    bare.update(sample);
  }
  EXPECT_EQ(node.wire.frames, wire.frames);
}

TEST(OwnClock, PhasesOfTwoNodesPassOverEachOther) {
  // 50 ppm against each other: 2 ms in 40 s, so that every coincidence within 2 ms is met.
  Node fast(30e-6, 0ns);
  Node slow(-20e-6, 0ns);
  fast.run(kStart + 40s);
  slow.run(kStart + 40s);
  const auto a = fast.sets();
  const auto b = slow.sets();
  ASSERT_GE(a.size(), 4000U);
  ASSERT_GE(b.size(), 3999U);
  EXPECT_NEAR(to_seconds(b[0] - a[0]), 0.0, 1e-6);
  EXPECT_NEAR(to_seconds(b[3998] - a[3998]), 50e-6 * 39.98, 1e-5);
  std::set<std::int64_t> tenths_of_ms;
  for (std::size_t i = 0; i < 3999; ++i) {
    tenths_of_ms.insert((b[i] - a[i]) / 100us);
  }
  EXPECT_GE(tenths_of_ms.size(), 19U) << "some coincidences are never met";
}

TEST(OwnClock, DrawsItsErrorFromWithinTheTolerance) {
  std::set<double> errors;
  double sum = 0.0;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    const double error = drawn_clock_error({.tolerance = 40e-6, .error = 10e-6}, seed);
    EXPECT_GE(error, -30e-6);
    EXPECT_LE(error, 50e-6);
    errors.insert(error);
    sum += error;
  }
  EXPECT_EQ(errors.size(), 1000U);
  EXPECT_NEAR(sum / 1000.0, 10e-6, 3e-6);  // 4 sigma
  EXPECT_EQ(drawn_clock_error({.tolerance = 0.0, .error = 23e-6}, 7), 23e-6);
}

TEST(OwnClock, DeviceWritesItsOwnTimeIntoItsMessages) {
  Node node(1000e-6, 0ns);
  node.run(kStart + 20s);
  const auto reading = protocols::xsens::decode([&] {
    Frame last;
    for (const auto& [due, frame] : node.wire.frames) {
      last = frame.id == static_cast<std::uint32_t>(protocols::xsens::MessageId::sample_time)
                 ? frame
                 : last;
    }
    return last;
  }());
  ASSERT_TRUE(reading.ok());
  // It has counted 2002 periods of 10 ms in the run's 20 s.
  EXPECT_EQ(node.sets().size(), 2003U);
  EXPECT_EQ(reading->values[0], 200'200.0);
}

TEST(OwnClock, JitterDelaysSetsAndKeepsTheirOrder) {
  constexpr Duration kJitter = 300us;
  Node even(0.0, 0ns);
  Node late(0.0, kJitter);
  even.run(kStart + 10s);
  late.run(kStart + 10s);
  ASSERT_EQ(even.wire.frames.size(), late.wire.frames.size());
  double sum_s = 0.0;
  double squares_s2 = 0.0;
  for (std::size_t i = 0; i < even.wire.frames.size(); ++i) {
    EXPECT_EQ(even.wire.frames[i].second, late.wire.frames[i].second);
    const Duration by = late.wire.frames[i].first - even.wire.frames[i].first;
    EXPECT_GE(by, 0ns);
    EXPECT_LE(by, kJitter);
    sum_s += to_seconds(by);
    squares_s2 += to_seconds(by) * to_seconds(by);
    if (i % 2 == 1) {
      EXPECT_EQ(late.wire.frames[i].first, late.wire.frames[i - 1].first) << "a set was torn";
    }
  }
  const auto count = static_cast<double>(even.wire.frames.size());
  const double mean_s = sum_s / count;
  EXPECT_NEAR(mean_s, 150e-6, 15e-6);
  EXPECT_NEAR(std::sqrt(squares_s2 / count - mean_s * mean_s), 300e-6 / std::sqrt(12.0), 8e-6);
}

TEST(OwnClock, SameSeedGivesTheSameJitter) {
  Node one(0.0, 100us, 5);
  Node same(0.0, 100us, 5);
  Node other(0.0, 100us, 6);
  for (Node* node : {&one, &same, &other}) {
    node->run(kStart + 1s);
  }
  EXPECT_EQ(one.wire.frames, same.wire.frames);
  EXPECT_NE(one.wire.frames, other.wire.frames);
}

TEST(OwnClock, TimersOfADeviceRunByIt) {
  // The valve block's ticks are its own; samples have nothing to do with them.
  const OwnClock clock(-500e-6, kStart, 10ms);
  test::FrameRecorder wire;
  OwnClockOutput output(clock, 0ns, 1, wire);
  IsoValves block(IsoValveSettings{}, output);
  OnOwnClock<IsoValves, ValveBackend> node(clock, block);
  node.advance(kStart + 20s);
  SimTime first = kNever;
  SimTime last = kNever;
  int count = 0;
  for (const auto& [due, frame] : wire.frames) {
    if ((frame.id & 0x00FFFF00U) == 0x00FE1000U) {  // estimated flow of valve 0
      first = count++ == 0 ? due : first;
      last = due;
    }
  }
  ASSERT_GT(count, 100);
  EXPECT_NEAR(to_seconds(last - first) / (count - 1), 0.1 / (1.0 - 500e-6), 1e-8);
}

}  // namespace
}  // namespace rigwire::emulators
