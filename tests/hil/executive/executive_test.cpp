#include "hil/executive/executive.h"

#include <gtest/gtest.h>

#include <array>
#include <thread>
#include <vector>

#include "hil/wires/outlets.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;

/// Samples every planned device with its own time as the reading; remembers what it was asked.
class CountingTruth final : public TruthSource {
 public:
  [[nodiscard]] Duration slice() const override { return 2ms; }

  std::optional<std::string> advance(const TruthRequests& requests, SampleBatch& batch) override {
    for (const auto& plan : requests.plans) {
      plans_.push_back(plan);
    }
    for (const auto& command : requests.valve_commands) {
      commands.push_back({frontier_, command.content.opening[0]});
    }
    if (fails_at && frontier_ >= *fails_at) {
      return "boom angle is not a number";
    }
    batch.clear();
    batch.from = frontier_;
    batch.until = frontier_ + slice();
    const bool first = frontier_ == kStart;
    for (const auto& plan : plans_) {
      SimTime at = first ? plan.content.first : plan.content.next_after(frontier_);
      for (; at <= batch.until; at = plan.content.next_after(at)) {
        batch.imu.push_back({plan.device, {at, {to_seconds(at), 0.0, 0.0}, {}, 25.0}});
      }
    }
    frontier_ = batch.until;
    if (slow) {
      std::this_thread::sleep_for(slow.value());
    }
    return std::nullopt;
  }

  [[nodiscard]] const std::vector<StateQuantity>& state_quantities() const override {
    return quantities_;
  }
  [[nodiscard]] TruthStages stages() const override { return {}; }

  struct Commanded {
    SimTime at;
    double opening;
  };
  std::vector<Commanded> commands;
  std::optional<SimTime> fails_at;
  std::optional<Duration> slow;

 private:
  SimTime frontier_ = kStart;
  std::vector<Addressed<SamplePlan>> plans_;
  std::vector<StateQuantity> quantities_;
};

/// Sends one byte per sample, 3 ms after it.
class Echo final : public emulators::Device, public emulators::ImuBackend {
 public:
  Echo(Duration period, emulators::ByteOutput& output) : period_(period), output_(output) {}

  void advance(SimTime now) override {
    ASSERT_GE(now, time_);
    time_ = now;
  }
  [[nodiscard]] SimTime next_event() const override { return stuck ? time_ : kNever; }
  [[nodiscard]] SamplePlan sample_plan() const override { return {kStart, period_}; }
  [[nodiscard]] emulators::ReceiveCounters received() const override { return {}; }
  [[nodiscard]] double nominal_rate_hz() const override { return 1.0 / to_seconds(period_); }
  [[nodiscard]] std::span<const emulators::Quantity> quantities() const override { return {}; }
  void update(const ImuSample& sample) override {
    ASSERT_GE(sample.time, time_);
    time_ = sample.time;
    times.push_back(sample.time);
    const std::array<std::uint8_t, 1> byte{static_cast<std::uint8_t>(times.size())};
    output_.send(sample.time + 3ms, byte);
  }

  std::vector<SimTime> times;
  bool stuck = false;

 private:
  Duration period_;
  emulators::ByteOutput& output_;
  SimTime time_ = kStart;
};

class RecordingStream final : public drivers::ByteStream {
 public:
  void start(Receiver) override {}
  std::size_t write(std::span<const std::uint8_t> bytes) override {
    if (refuses) {
      return 0;
    }
    written.insert(written.end(), bytes.begin(), bytes.end());
    return bytes.size();
  }
  [[nodiscard]] drivers::EndpointStatus status() const override { return {"recording", true}; }

  std::vector<std::uint8_t> written;
  bool refuses = false;
};

struct Rig {
  explicit Rig(Duration period = 10ms)
      : outlet(stream, statistics),
        echo(period, outlet),
        station(echo, echo),
        executive(io, truth) {
    executive.add(station);
    executive.add(outlet);
  }
  boost::asio::io_context io;
  CountingTruth truth;
  RecordingStream stream;
  WireStatistics statistics;
  StreamOutlet outlet;
  Echo echo;
  ImuStation station;
  Executive executive;
};

TEST(Executive, FreeRunDeliversEverySampleAtItsOwnInstant) {
  Rig rig(7ms);
  const RunOutcome outcome = rig.executive.run_free(kStart + 1s);
  EXPECT_EQ(outcome.reached, kStart + 1s);
  ASSERT_EQ(rig.echo.times.size(), 143U);  // 0, 7, ... 994 ms
  for (std::size_t i = 0; i < rig.echo.times.size(); ++i) {
    EXPECT_EQ(rig.echo.times[i], kStart + static_cast<int>(i) * 7ms);
  }
  EXPECT_EQ(rig.stream.written.size(), 143U);  // the last one is due at 997 ms
  EXPECT_EQ(rig.statistics.units, 143U);
  EXPECT_EQ(rig.statistics.lateness.count(), 0U);
}

TEST(Executive, SameRunHasTheSameHashWhateverTheConsumerDoes) {
  Rig first;
  Rig second;
  second.stream.refuses = true;
  first.executive.run_free(kStart + 500ms);
  second.executive.run_free(kStart + 500ms);
  EXPECT_EQ(first.statistics.hash.value(), second.statistics.hash.value());
  EXPECT_EQ(second.statistics.dropped, first.statistics.units);
}

TEST(Executive, StopsWithTheTruthsFault) {
  Rig rig;
  rig.truth.fails_at = kStart + 100ms;
  const RunOutcome outcome = rig.executive.run_free(kNever);
  ASSERT_TRUE(outcome.fault.has_value());
  EXPECT_NE(outcome.fault->find("boom angle"), std::string::npos);
  EXPECT_EQ(outcome.reached, kStart + 100ms);
}

TEST(Executive, ADeviceThatDoesNotMoveOnEndsTheRunInsteadOfHanging) {
  Rig rig;
  rig.echo.stuck = true;
  const RunOutcome outcome = rig.executive.run_free(kStart + 1s);
  ASSERT_TRUE(outcome.fault.has_value());
  EXPECT_NE(outcome.fault->find("does not move on"), std::string::npos);
}

TEST(Executive, PacedRunKeepsWallTimeAndSendsTheSameBytesAsAFreeRun) {
  Rig free_rig;
  free_rig.executive.run_free(kStart + 400ms);
  Rig rig;
  PacedSettings settings;
  settings.slip_limit = 10s;  // a loaded test machine must not shift the clock
  const RunOutcome outcome = rig.executive.run_paced(settings, kStart + 400ms);
  EXPECT_FALSE(outcome.fault.has_value());
  EXPECT_EQ(outcome.reached, kStart + 400ms);
  EXPECT_GE(outcome.wall_s, 0.4);
  EXPECT_EQ(rig.statistics.hash.value(), free_rig.statistics.hash.value());
  EXPECT_EQ(rig.statistics.lateness.count(), rig.statistics.units);
}

TEST(Executive, ScaledClockRunsFaster) {
  Rig rig;
  PacedSettings settings;
  settings.factor = 10.0;
  settings.slip_limit = 10s;
  const RunOutcome outcome = rig.executive.run_paced(settings, kStart + 2s);
  EXPECT_GE(outcome.wall_s, 0.2);
  EXPECT_EQ(rig.statistics.units, 200U);
}

TEST(Executive, AStalledHostMakesTheClockSlipInsteadOfBursting) {
  Rig rig;
  rig.truth.slow = 20ms;  // ten times slower than real time
  PacedSettings settings;
  settings.slip_limit = 10ms;
  const RunOutcome outcome = rig.executive.run_paced(settings, kStart + 60ms);
  EXPECT_EQ(outcome.reached, kStart + 60ms);
  EXPECT_GT(outcome.slips, 0U);
  EXPECT_GT(outcome.slipped, 100ms);
}

TEST(Executive, StopFromAnotherThreadEndsAPacedRunThatWaits) {
  Rig rig(10s);
  std::thread stopper([&] { rig.executive.stop(); });
  const RunOutcome outcome = rig.executive.run_paced({}, kNever);
  stopper.join();
  EXPECT_FALSE(outcome.fault.has_value());
}

}  // namespace
}  // namespace rigwire::hil
