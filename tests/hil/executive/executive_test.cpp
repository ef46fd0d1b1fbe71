// The executive with a kind of sensor that it has never heard of.
#include "hil/executive/executive.h"

#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <thread>
#include <utility>
#include <vector>

#include "emulators/device.h"
#include "hil/wires/outlets.h"
#include "made_up_kind.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;

/// Moist as much as seconds have passed, wherever a probe is; remembers what it was asked.
class MoistGround final : public TruthSource {
 public:
  [[nodiscard]] Duration slice() const override { return 2ms; }

  std::optional<std::string> advance(const TruthRequests& requests, SampleBatch& batch) override {
    if (const auto* plans = requests.find<SamplePlan>(kStation); plans && !plans->empty()) {
      plan_ = plans->back();
    }
    if (const auto* commands = requests.find<test::HeaterCommand>(kStation)) {
      for (const test::HeaterCommand& command : *commands) {
        heated.push_back({frontier_, command.power_w});
      }
    }
    if (fails_at && frontier_ >= *fails_at) {
      return "boom angle is not a number";
    }
    batch.clear();
    batch.from = frontier_;
    batch.until = frontier_ + slice();
    SimTime at = frontier_ == kStart ? plan_.first : plan_.next_after(frontier_);
    for (; at <= batch.until; at = plan_.next_after(at)) {
      batch.samples.of<test::MoistureSample>(kStation).push_back({at, to_seconds(at)});
    }
    if (stranger_at && frontier_ >= *stranger_at) {
      batch.samples.of<int>(kStation).push_back(1);
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

  struct Heated {
    SimTime at;
    double power_w;
  };
  std::vector<Heated> heated;
  std::optional<SimTime> fails_at;
  std::optional<SimTime> stranger_at;
  std::optional<Duration> slow;

 private:
  static constexpr StationIndex kStation = 1;
  SimTime frontier_ = kStart;
  SamplePlan plan_;
  std::vector<StateQuantity> quantities_;
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

/// A probe behind a station of its own index, not the first.
struct Rig {
  explicit Rig(Duration period = 10ms)
      : outlet(stream, statistics),
        probe(period, outlet),
        station(probe, probe),
        executive(io, truth) {
    deaf.plan.first = kNever;
    executive.add(deaf_station);
    EXPECT_EQ(executive.add(station), 1U);
    executive.add(outlet);
  }
  boost::asio::io_context io;
  MoistGround truth;
  RecordingStream stream;
  WireStatistics statistics;
  StreamOutlet outlet;
  emulators::NullByteOutput nowhere;
  test::MoistureProbe deaf{1ms, nowhere};
  test::MoistureProbe probe;
  StationOf<test::MoistureBackend> deaf_station{deaf, deaf};
  StationOf<test::MoistureBackend> station;
  Executive executive;
};

TEST(Executive, FreeRunDeliversEverySampleAtItsOwnInstant) {
  Rig rig(7ms);
  const RunOutcome outcome = rig.executive.run_free(kStart + 1s);
  EXPECT_EQ(outcome.reached, kStart + 1s);
  ASSERT_EQ(rig.probe.samples.size(), 143U);  // 0, 7, ... 994 ms
  for (std::size_t i = 0; i < rig.probe.samples.size(); ++i) {
    EXPECT_EQ(rig.probe.samples[i].time, kStart + static_cast<int>(i) * 7ms);
    EXPECT_EQ(rig.probe.samples[i].share, to_seconds(rig.probe.samples[i].time));
  }
  EXPECT_FALSE(rig.probe.went_back);
  EXPECT_TRUE(rig.deaf.samples.empty());
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

TEST(Executive, SaysThatNoStationTakesASample) {
  Rig rig;
  rig.truth.stranger_at = kStart + 100ms;
  const RunOutcome outcome = rig.executive.run_free(kStart + 1s);
  ASSERT_TRUE(outcome.fault.has_value());
  EXPECT_NE(outcome.fault->find("1 samples that no station takes"), std::string::npos)
      << *outcome.fault;
}

TEST(Executive, ACommandReachesTheTruthOnceAtItsFrontier) {
  Rig rig;
  rig.probe.heats_from = kStart + 50ms;
  rig.executive.run_free(kStart + 200ms);
  ASSERT_EQ(rig.truth.heated.size(), 1U);
  EXPECT_EQ(rig.truth.heated[0].at, kStart + 50ms);
  EXPECT_EQ(rig.truth.heated[0].power_w, 20.0);
}

TEST(Executive, PacedACommandReachesTheTruthOnce) {
  Rig rig;
  rig.probe.heats_from = kStart + 50ms;
  PacedSettings settings;
  settings.overrun_limit = 10s;
  rig.executive.run_paced(settings, kStart + 200ms);
  ASSERT_EQ(rig.truth.heated.size(), 1U);
  EXPECT_GE(rig.truth.heated[0].at, kStart + 50ms);
  EXPECT_EQ(rig.truth.heated[0].power_w, 20.0);
}

TEST(Executive, APacedRunIsTheSameRunFreelyWhenItIsHandedOverAsThen) {
  Rig paced;
  paced.probe.heats_from = kStart + 50ms;
  std::vector<RequestHandover> handovers;
  paced.executive.on_handover([&](const RequestHandover& one) { handovers.push_back(one); });
  PacedSettings settings;
  settings.overrun_limit = 10s;
  paced.executive.run_paced(settings, kStart + 200ms);
  ASSERT_EQ(handovers.size(), 1U) << "the plan of the start is no news";
  Rig again;
  again.probe.heats_from = kStart + 50ms;
  again.executive.hand_over_as(handovers);
  again.executive.run_free(kStart + 200ms);
  ASSERT_EQ(again.truth.heated.size(), 1U);
  EXPECT_EQ(again.truth.heated[0].at, paced.truth.heated[0].at);
  EXPECT_EQ(again.statistics.hash.value(), paced.statistics.hash.value());
}

TEST(Executive, WhatIsHandedOverLaterIsFollowedThenAndWhatIsNeverAskedNever) {
  const auto heated = [](const std::vector<RequestHandover>& plan) {
    Rig rig;
    rig.probe.heats_from = kStart + 50ms;
    rig.executive.hand_over_as(plan);
    rig.executive.run_free(kStart + 100ms);
    rig.executive.run_free(kStart + 200ms);
    return rig.truth.heated;
  };
  // Between two slices, at one's end, across two calls.
  for (const auto& [asked, taken] : std::vector<std::pair<Duration, Duration>>{
           {50ms + 1ns, 56ms}, {52ms, 52ms}, {61ms, 150ms}}) {
    const auto at = heated({{kStart + asked, kStart + taken}});
    ASSERT_EQ(at.size(), 1U);
    EXPECT_EQ(at[0].at, kStart + taken);
  }
  EXPECT_TRUE(heated({{kStart + 49ms, kStart + 56ms}}).empty()) << "asked before it wanted";
  EXPECT_TRUE(heated({}).empty());
}

TEST(Executive, WhatWasPromisedIsPromisedAgainOnceAtItsInstant) {
  Rig rig;
  rig.executive.hand_over_as({{kStart, kStart + 6ms, true}, {kStart, kStart + 8ms, true}});
  EXPECT_EQ(rig.executive.soonest_request(), kStart + 6ms);
  EXPECT_EQ(rig.executive.soonest_request(), kStart + 8ms);
  EXPECT_EQ(rig.executive.soonest_request(), kStart + 1ns) << "as that of a free run";
  EXPECT_EQ(rig.executive.soonest_request(kStart + 2ms), kStart + 1ns);
}

TEST(Executive, ADeviceThatDoesNotMoveOnEndsTheRunInsteadOfHanging) {
  Rig rig;
  rig.probe.stuck = true;
  const RunOutcome outcome = rig.executive.run_free(kStart + 1s);
  ASSERT_TRUE(outcome.fault.has_value());
  EXPECT_NE(outcome.fault->find("does not move on"), std::string::npos);
}

TEST(Executive, PacedRunKeepsWallTimeAndSendsTheSameBytesAsAFreeRun) {
  Rig free_rig;
  free_rig.executive.run_free(kStart + 400ms);
  Rig rig;
  PacedSettings settings;
  settings.overrun_limit = 10s;  // a loaded test machine must not shift the clock
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
  settings.overrun_limit = 10s;
  const RunOutcome outcome = rig.executive.run_paced(settings, kStart + 2s);
  EXPECT_GE(outcome.wall_s, 0.2);
  EXPECT_EQ(rig.statistics.units, 200U);
}

TEST(Executive, AStalledHostMakesTheClockSlipInsteadOfBursting) {
  Rig rig;
  rig.truth.slow = 20ms;  // ten times slower than real time
  PacedSettings settings;
  settings.overrun_limit = 10ms;
  const RunOutcome outcome = rig.executive.run_paced(settings, kStart + 60ms);
  EXPECT_EQ(outcome.reached, kStart + 60ms);
  EXPECT_GT(outcome.slips, 0U);
  EXPECT_GT(outcome.slipped, 100ms);
  EXPECT_EQ(outcome.overruns, outcome.slips);
}

TEST(Executive, WhatAClientSendsWhileTheHostHoldsTheWiresUpArrivesInTheMiddle) {
  using Clock = std::chrono::steady_clock;
  Rig rig(1ms);
  PacedSettings settings;
  settings.lead = 500ms;  // The truth is not what is late.
  settings.overrun_limit = 10s;
  SimTime before{};
  SimTime after{};
  Duration held_up{};
  boost::asio::steady_timer timer(rig.io, 20ms);
  timer.async_wait([&](const boost::system::error_code&) {
    before = rig.executive.arrive();
    const auto begin = Clock::now();
    std::this_thread::sleep_for(60ms);
    boost::asio::post(rig.io, [&, begin] {
      held_up = Clock::now() - begin;
      after = rig.executive.arrive();
      rig.executive.stop();
    });
  });
  const RunOutcome outcome = rig.executive.run_paced(settings, kNever);
  EXPECT_GT(after - before, held_up / 4);
  EXPECT_LT(after - before, held_up * 3 / 4);
  EXPECT_EQ(outcome.slips, 0U);
}

TEST(Executive, AWireThreadThatIsHeldUpBeyondTheLimitMakesTheClockSlip) {
  Rig rig(1ms);
  PacedSettings settings;
  settings.lead = 1s;
  settings.overrun_limit = 100ms;
  SimTime before{};
  SimTime after{};
  boost::asio::steady_timer timer(rig.io, 20ms);
  timer.async_wait([&](const boost::system::error_code&) {
    before = rig.executive.arrive();
    std::this_thread::sleep_for(300ms);
    boost::asio::post(rig.io, [&] {
      after = rig.executive.arrive();
      rig.executive.stop();
    });
  });
  const RunOutcome outcome = rig.executive.run_paced(settings, kNever);
  EXPECT_LT(after - before, 100ms) << "a time-out of a client would see the host's stall";
  EXPECT_GE(outcome.slipped, 200ms);
  EXPECT_EQ(outcome.slips, 1U);
}

TEST(Executive, EveryOverrunIsToldWithWhenAndHowFar) {
  Rig rig;
  rig.truth.slow = 20ms;
  PacedSettings settings;
  settings.overrun_limit = 10ms;
  std::vector<Overrun> told;
  settings.on_overrun = [&](const Overrun& overrun) { told.push_back(overrun); };
  const RunOutcome outcome = rig.executive.run_paced(settings, kStart + 60ms);
  EXPECT_EQ(outcome.overruns, told.size());
  EXPECT_EQ(outcome.first_overruns, told);
  Duration slipped{0};
  SimTime last = kNever;
  for (const Overrun& overrun : told) {
    EXPECT_GT(overrun.lag, 10ms);
    EXPECT_LE(overrun.at, kStart + 60ms);
    EXPECT_NE(overrun.at, last) << "a stall is told once, however often the clock slips in it";
    last = overrun.at;
    slipped += overrun.lag;
  }
  EXPECT_EQ(slipped, outcome.slipped);
}

TEST(Executive, ARunThatOnlyWarnsKeepsItsClockAndTellsOnce) {
  Rig rig;
  rig.truth.slow = 20ms;
  PacedSettings settings;
  settings.overrun = OverrunPolicy::warn;
  settings.overrun_limit = 10ms;
  const RunOutcome outcome = rig.executive.run_paced(settings, kStart + 60ms);
  EXPECT_EQ(outcome.reached, kStart + 60ms);
  EXPECT_EQ(outcome.slips, 0U);
  EXPECT_EQ(outcome.slipped, 0ms);
  EXPECT_EQ(outcome.overruns, 1U) << "it is behind from the first slice to the last";
  EXPECT_FALSE(outcome.fault.has_value());
}

TEST(Executive, ARunThatMustKeepTimeEndsWhenItCannot) {
  Rig rig;
  rig.truth.slow = 20ms;
  PacedSettings settings;
  settings.overrun = OverrunPolicy::stop;
  settings.overrun_limit = 10ms;
  const RunOutcome outcome = rig.executive.run_paced(settings, kStart + 10s);
  EXPECT_LT(outcome.reached, kStart + 1s);
  ASSERT_TRUE(outcome.fault.has_value());
  EXPECT_NE(outcome.fault->find("behind the wall clock, allowed 10 ms"), std::string::npos);
  EXPECT_EQ(outcome.overruns, 1U);
}

TEST(Executive, StopFromAnotherThreadEndsAPacedRunThatWaits) {
  Rig rig(10s);
  std::thread stopper([&] { rig.executive.stop(); });
  const RunOutcome outcome = rig.executive.run_paced({}, kNever);
  stopper.join();
  EXPECT_FALSE(outcome.fault.has_value());
}

/// Lets time stand at instants of its own.
class Halts final : public EventSource {
 public:
  Halts(Executive& executive, std::vector<SimTime> instants)
      : executive_(executive), instants_(std::move(instants)) {
    executive.add(*this);
  }
  [[nodiscard]] SimTime next_event() const override {
    return next_ < instants_.size() ? instants_[next_] : kNever;
  }
  [[nodiscard]] SimTime next_wakeup() const override { return next_event(); }
  void advance(SimTime /*now*/) override {
    ++next_;
    executive_.pause();
  }

 private:
  Executive& executive_;
  std::vector<SimTime> instants_;
  std::size_t next_ = 0;
};

/// Calls `then` as often as time stands, and lets it go on.
class WheneverPaused {
 public:
  WheneverPaused(Rig& rig, std::function<void()> then)
      : rig_(rig), then_(std::move(then)), timer_(rig.io) {
    look();
  }

 private:
  void look() {
    timer_.expires_after(200us);
    timer_.async_wait([this](const boost::system::error_code& error) {
      if (error) {
        return;
      }
      if (rig_.executive.paused()) {
        then_();
        rig_.executive.resume();
      }
      look();
    });
  }

  Rig& rig_;
  std::function<void()> then_;
  boost::asio::steady_timer timer_;
};

/// Something that never happens, and counts how often the loop asks when it will.
class NeverDue final : public EventSource {
 public:
  [[nodiscard]] SimTime next_event() const override { return kNever; }
  [[nodiscard]] SimTime next_wakeup() const override {
    ++turns;
    return kNever;
  }
  void advance(SimTime /*now*/) override {}
  mutable int turns = 0;
};

// 50 slices, three of them a lead: each one woke the wire thread, which had nothing to do.
TEST(Executive, SlicesThatAreAheadWakeNobody) {
  Rig rig(10s);
  NeverDue never;
  rig.executive.add(never);
  PacedSettings settings;
  settings.factor = 0.1;
  EXPECT_FALSE(rig.executive.run_paced(settings, kStart + 100ms).fault.has_value());
  EXPECT_GT(never.turns, 5);
  EXPECT_LT(never.turns, 40);
}

TEST(Executive, TimeStandsAtAnInstantWithAllBeforeItDoneAndNothingBehindIt) {
  Rig whole;
  whole.executive.run_free(kStart + 400ms);
  for (const bool paced : {false, true}) {
    Rig rig;
    Halts halts(rig.executive, {kStart + 1ns, kStart + 33'333'333ns, kStart + 200ms});
    std::vector<std::pair<SimTime, std::uint64_t>> stood;
    const WheneverPaused onlooker(
        rig, [&] { stood.emplace_back(rig.executive.now(), rig.statistics.units); });
    PacedSettings settings;
    settings.overrun_limit = 10s;
    const RunOutcome outcome = paced ? rig.executive.run_paced(settings, kStart + 400ms)
                                     : rig.executive.run_free(kStart + 400ms);
    EXPECT_EQ(outcome.reached, kStart + 400ms);
    EXPECT_EQ(outcome.slips, 0U);
    // Each sample leaves 3 ms after it was taken.
    EXPECT_EQ(stood, (std::vector<std::pair<SimTime, std::uint64_t>>{
                         {kStart + 1ns, 0}, {kStart + 33'333'333ns, 4}, {kStart + 200ms, 20}}));
    EXPECT_EQ(rig.statistics.hash.value(), whole.statistics.hash.value());
  }
}

TEST(Executive, ARunThatIsPausedBeforeItBeginsHasSentNothing) {
  for (const bool paced : {false, true}) {
    Rig rig;
    rig.executive.pause();
    boost::asio::steady_timer timer(rig.io, 50ms);
    timer.async_wait([&](const boost::system::error_code&) {
      EXPECT_EQ(rig.executive.now(), kStart);
      EXPECT_EQ(rig.statistics.units, 0U);
      rig.executive.stop();
    });
    const RunOutcome outcome =
        paced ? rig.executive.run_paced({}, kNever) : rig.executive.run_free(kNever);
    EXPECT_EQ(outcome.reached, kStart);
  }
}

TEST(Executive, AnotherPaceIsTakenWhileItRuns) {
  Rig rig;
  boost::asio::post(rig.io, [&] { rig.executive.set_factor(1000.0); });
  PacedSettings settings;
  settings.overrun_limit = 10s;
  const RunOutcome outcome = rig.executive.run_paced(settings, kStart + 60s);
  EXPECT_LT(outcome.wall_s, 30.0);
  EXPECT_EQ(rig.statistics.units, 6000U);
}

/// Events at every millisecond, which may not come before the gate opens.
TEST(Executive, AFreeRunThatWaitsGoesOnWhenItsClientsHaveTakenAll) {
  boost::asio::io_context io;
  MoistGround truth;
  Executive executive(io, truth);
  int refusals = 3;
  int expiries = 0;
  std::vector<SimTime> asked;
  ClientPatience clients;
  clients.patience = 10s;
  clients.taken = [&] {
    asked.push_back(executive.now());
    return refusals-- <= 0;
  };
  clients.expired = [&] { ++expiries; };
  const RunOutcome outcome = executive.run_free(kStart + 6ms, clients);
  EXPECT_EQ(asked, (std::vector<SimTime>{kStart + 2ms, kStart + 2ms, kStart + 2ms, kStart + 2ms,
                                         kStart + 4ms, kStart + 6ms}));
  EXPECT_EQ(expiries, 0);
  EXPECT_EQ(outcome.expiries, 0U);
  EXPECT_GT(outcome.waited_s, 0.0);
}

/// There is always one more handler that is ready.
TEST(Executive, ClientsThatAskWithoutEndDoNotKeepTimeFromMovingOn) {
  for (const bool paced : {false, true}) {
    Rig rig;
    std::uint64_t asked = 0;
    std::function<void()> ask = [&] {
      ++asked;
      rig.executive.arrive();
      boost::asio::post(rig.io, ask);
    };
    boost::asio::post(rig.io, ask);
    PacedSettings settings;
    settings.overrun_limit = 10s;
    const RunOutcome outcome = paced ? rig.executive.run_paced(settings, kStart + 50ms)
                                     : rig.executive.run_free(kStart + 50ms);
    EXPECT_GE(outcome.reached, kStart + 50ms);  // A client may come in the turn that ends it.
    EXPECT_EQ(rig.statistics.units, 5U);
    EXPECT_GT(asked, 0U) << "they are served, too";
  }
}

TEST(Executive, APatienceThatExpiresIsCountedAndTheRunGoesOn) {
  boost::asio::io_context io;
  MoistGround truth;
  Executive executive(io, truth);
  int expiries = 0;
  ClientPatience clients;
  clients.patience = 1ms;
  clients.taken = [&] { return false; };
  clients.expired = [&] { ++expiries; };
  const RunOutcome outcome = executive.run_free(kStart + 6ms, clients);
  EXPECT_EQ(outcome.reached, kStart + 6ms);
  EXPECT_EQ(expiries, 3);
  EXPECT_EQ(outcome.expiries, 3U);
}

}  // namespace
}  // namespace rigwire::hil
