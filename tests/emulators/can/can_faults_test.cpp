// Faults of wire, rates, stubs and intruders, and what the others make of them.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "can_test_nodes.h"
#include "emulators/can/can_bus.h"
#include "emulators/can/can_fault_schedule.h"
#include "emulators/random_bits.h"
#include "fault_period.h"
#include "protocols/can/bits.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using protocols::can::ErrorState;
using protocols::can::exact_bits;
using protocols::can::Frame;
using rigwire::test::FrameRecorder;
using test::Client;
using test::conserved;
using test::Counter;
using test::extended;
using test::Listener;
using test::standard;
using test::time_of;

constexpr Duration kCanFaultsBit = 4us;

CanFault fault(decltype(CanFault::what) what, Duration begin, Duration end) {
  return {between(begin, end), std::move(what)};
}

class CanFaults : public testing::Test {
 protected:
  FrameRecorder outside_;
  FrameRecorder intruders_;
  CanBusModel bus_{CanBusSettings{250'000, 16}};
  FrameOutput& a_ = bus_.add_node(outside_, {.name = "a"});
  FrameOutput& b_ = bus_.add_node(outside_, {.name = "b"});
  Listener device_a_;
  Listener device_b_;
  void SetUp() override {
    bus_.attach(a_, device_a_);
    bus_.attach(b_, device_b_);
  }
  /// Both send every 10 ms.
  void live(SimTime from, SimTime to) {
    for (SimTime now = from; now < to; now += 10ms) {
      bus_.advance(now);
      a_.send(now, standard(0x100));
      b_.send(now, standard(0x200));
    }
    bus_.advance(to);
  }
};

TEST_F(CanFaults, ShortedBusTakesASenderOffAtTheExactBitAndItComesBack) {
  bus_.set_faults({{fault(ShortCircuitFault{}, 0ms, 50ms)}}, intruders_);
  a_.send(kStart, standard(0x100));
  bus_.advance(kStart + 50ms);
  // Every dominant bit that reads recessive counts: start of frame and sixteen bits of error flags
  // make 136; a passive flag is undisturbed. Then 17 bits to the end of the intermission and eight
  // of suspension, and fifteen more attempts of one bit each.
  const auto first = 17 + 6 + 8 + 3 + 8;
  const SimTime off = kStart + (first + 14 * (1 + 6 + 8 + 3 + 8) + 1) * kCanFaultsBit;
  EXPECT_EQ(time_of(device_a_.reports, ErrorState::passive), kStart + 16 * kCanFaultsBit);
  EXPECT_EQ(time_of(device_a_.reports, ErrorState::bus_off), off);
  EXPECT_EQ(bus_.controller(b_).receive_errors, 0);  // It saw an idle bus.
  live(kStart + 200ms, kStart + 300ms);
  EXPECT_EQ(bus_.controller(a_).state, ErrorState::active);
  EXPECT_EQ(bus_.counters(a_).sent, 10U);
}

TEST_F(CanFaults, DisturbanceDestroysEveryFrameOfItsTimeAndNoOther) {
  bus_.set_faults({{fault(DisturbanceFault{}, 100ms, 103ms)}}, intruders_);
  live(kStart, kStart + 200ms);
  for (const auto& [time, frame] : outside_.frames) {
    const SimTime begin = time - (exact_bits(frame) - 4) * kCanFaultsBit;
    EXPECT_TRUE(time <= kStart + 100ms || begin >= kStart + 103ms - kCanFaultsBit)
        << to_seconds(time);
  }
  EXPECT_EQ(outside_.frames.size(), 40U);  // All were repeated in the end.
  EXPECT_GT(bus_.error_frames(), 5U);
}

TEST_F(CanFaults, BitErrorsComeAtTheirRate) {
  const CanFault noise = fault(BitErrorsFault{1e-4}, 0ms, 1h);
  bus_.set_faults({{noise}, 7}, intruders_);
  live(kStart, kStart + 100s);
  const double bits = 20'000.0 * (exact_bits(standard(0x100)) - 3);
  const double expected = bits * 1e-4;  // And those of repetitions, one in a hundred.
  EXPECT_NEAR(static_cast<double>(bus_.error_frames()), expected, 4.0 * std::sqrt(expected) + 5.0);
  EXPECT_EQ(bus_.counters(a_).sent, 10'000U);
  EXPECT_EQ(bus_.controller(a_).state, ErrorState::active);
}

TEST_F(CanFaults, SenderWithAnotherRateGoesOffAndTheOthersGoOn) {
  const CanFault wrong = fault(WrongRateFault{"b", 500'000}, 100ms, 5s);
  bus_.set_faults({{wrong}}, intruders_);
  live(kStart, kStart + 4s);
  EXPECT_GT(bus_.counters(b_).bus_offs, 0U);
  EXPECT_EQ(bus_.counters(b_).sent, 10U);  // Before it began.
  for (const auto& [time, frame] : outside_.frames) {
    EXPECT_TRUE(frame.id == 0x100 || time < kStart + 100ms);
  }
  EXPECT_GT(bus_.counters(a_).sent, 100U);
  EXPECT_GE(bus_.error_frames(), 32U);
  const auto before = bus_.counters(b_).sent;
  live(kStart + 5s, kStart + 7s);
  EXPECT_GT(bus_.counters(b_).sent, before + 150);
}

// It misreads the first three bits, and its flag falls into the identifier, which the sender takes
// for lost arbitration. The others' flags follow, so each attempt counts 1 + 8 for the culprit, and
// the fifteenth makes it passive.
TEST_F(CanFaults, QuickerReaderDestroysFramesUntilItIsPassive) {
  const CanFault wrong = fault(WrongRateFault{"b", 500'000}, 0ms, 5s);
  bus_.set_faults({{wrong}}, intruders_);
  a_.send(kStart, standard(0x155));
  bus_.advance(kStart + 1s);
  EXPECT_EQ(bus_.controller(b_).state, ErrorState::passive);
  EXPECT_TRUE(device_b_.heard.empty());
  EXPECT_EQ(bus_.counters(a_).sent, 1U);  // Thanks to the client's acknowledgement.
  EXPECT_EQ(bus_.counters(a_).arbitration_losses, 15U);
  EXPECT_EQ(bus_.controller(a_).transmit_errors, 0);
}

// Its flag lasts longer than what the others tolerate after their own: the sender pays.
TEST_F(CanFaults, SlowerReaderTakesTheSenderOff) {
  const CanFault wrong = fault(WrongRateFault{"b", 125'000}, 0ms, 5s);
  bus_.set_faults({{wrong}}, intruders_);
  a_.send(kStart, standard(0x155));
  bus_.advance(kStart + 1s);
  EXPECT_EQ(bus_.counters(a_).bus_offs, 1U);
  EXPECT_EQ(bus_.counters(a_).sent, 0U);
  EXPECT_TRUE(outside_.frames.empty());
}

TEST_F(CanFaults, BabblerWithAnUrgentIdentifierSilencesEverybody) {
  const IntruderFault babbler{"000#0000000000000000", 100us};
  bus_.set_faults({{fault(babbler, 1s, 2s)}}, intruders_);
  live(kStart, kStart + 3s);
  std::uint64_t within = 0;
  for (const auto& [time, frame] : outside_.frames) {
    within += time > kStart + 1002ms && time < kStart + 2s ? 1U : 0U;
  }
  EXPECT_EQ(within, 0U);
  EXPECT_GT(bus_.counters(a_).overflowed, 50U);
  const double second_bits = 250'000.0;
  EXPECT_NEAR(static_cast<double>(intruders_.frames.size()),
              second_bits / exact_bits(frame_of(babbler)), 2.0);
  EXPECT_TRUE(conserved(bus_.counters(a_)));
}

TEST_F(CanFaults, DuplicateOfAnIdentifierInUseMakesCollisions) {
  bus_.set_faults({{fault(IntruderFault{"100#00000000000000FF", 10ms}, 0s, 1s)}}, intruders_);
  live(kStart, kStart + 1s);
  EXPECT_GT(bus_.collisions(), 50U);
  EXPECT_GT(bus_.error_frames(), 50U);
  EXPECT_NE(time_of(device_a_.reports, ErrorState::passive), kNever);
}

TEST_F(CanFaults, DisconnectedNodeIsAloneAndTheOthersDoNotNotice) {
  const CanFault broken = fault(DisconnectedFault{"b"}, 100ms, 1s);
  bus_.set_faults({{broken}}, intruders_);
  live(kStart, kStart + 900ms);
  EXPECT_EQ(bus_.counters(b_).sent, 10U);
  EXPECT_EQ(bus_.controller(b_).state, ErrorState::passive);
  EXPECT_EQ(bus_.counters(b_).bus_offs, 0U);
  EXPECT_EQ(device_b_.heard.size(), 10U);
  EXPECT_EQ(bus_.counters(a_).sent, 90U);
  EXPECT_EQ(bus_.error_frames(), 0U);
  live(kStart + 1s, kStart + 2s);
  EXPECT_GE(bus_.counters(b_).sent, 110U);
  EXPECT_NE(bus_.controller(b_).state, ErrorState::passive);
}

TEST_F(CanFaults, ClientOnABrokenStubHearsNothing) {
  const CanFault broken = fault(DisconnectedFault{"client"}, 0ms, 1s);
  bus_.set_faults({{broken}}, intruders_);
  live(kStart, kStart + 990ms);
  EXPECT_TRUE(outside_.frames.empty());
  EXPECT_EQ(bus_.counters(a_).sent, 99U);  // The devices acknowledge each other.
  live(kStart + 1s, kStart + 2s);
  EXPECT_EQ(outside_.frames.size(), 200U);
}

TEST_F(CanFaults, AreCheckedAtSetUp) {
  const auto refused = [this](const CanFault& bad) {
    EXPECT_THROW(bus_.set_faults({{bad}}, intruders_), std::invalid_argument);
  };
  refused(fault(DisturbanceFault{}, 1s, 1s));
  refused(fault(BitErrorsFault{0.0}, 0s, 1s));
  refused(fault(DisconnectedFault{"c"}, 0s, 1s));
  refused(fault(WrongRateFault{"a", 5000}, 0s, 1s));
  refused(fault(IntruderFault{"800#", 1ms}, 0s, 1s));
  refused(fault(IntruderFault{"100#", 1us}, 0s, 1s));
  const CanFault first = fault(DisconnectedFault{"a"}, 0s, 2s);
  const CanFault second = fault(DisconnectedFault{"a"}, 1s, 3s);
  EXPECT_THROW(bus_.set_faults({{first, second}}, intruders_), std::invalid_argument);
  EXPECT_THROW((void)bus_.add_node(outside_, {.name = "a"}), std::invalid_argument);
}

TEST_F(CanFaults, OneEndedEarlyActsNoLongerAndStaysInTheList) {
  bus_.set_faults(
      {{fault(IntruderFault{"080#00", 10ms}, 100ms, 10s), fault(DisconnectedFault{"b"}, 100ms, 10s),
        fault(ShortCircuitFault{}, 5s, 10s)}},
      intruders_);
  live(kStart, kStart + 500ms);
  EXPECT_EQ(intruders_.frames.size(), 40U);
  EXPECT_EQ(bus_.counters(b_).sent, 10U);
  const auto list = bus_.faults().book().list();
  ASSERT_EQ(list.size(), 3U);
  for (const auto& entry : list) {
    EXPECT_TRUE(bus_.faults().end(entry.id, kStart + 500ms));
    EXPECT_FALSE(bus_.faults().end(entry.id, kStart + 500ms)) << "it is over";
  }
  EXPECT_FALSE(bus_.faults().end(99, kStart + 500ms)) << "no such fault";
  live(kStart + 500ms, kStart + 6s);
  EXPECT_EQ(intruders_.frames.size(), 40U);
  EXPECT_GE(bus_.counters(b_).sent, 560U);
  EXPECT_EQ(bus_.error_frames(), 0U);
  EXPECT_EQ(bus_.faults().book().list()[0].fault.when, between(100ms, 500ms));
}

TEST_F(CanFaults, OneOfANodeThatIsThereAlreadyIsRefusedInTheRunToo) {
  bus_.set_faults({{fault(DisconnectedFault{"b"}, 0s, 2s)}}, intruders_);
  live(kStart, kStart + 100ms);
  const auto refused = [this](const CanFault& bad) {
    EXPECT_THROW(bus_.faults().begin(bad), std::invalid_argument);
  };
  refused(fault(DisconnectedFault{"b"}, 1s, 3s));
  refused(fault(DisconnectedFault{"c"}, 3s, 4s));
  refused(fault(IntruderFault{"800#", 1ms}, 3s, 4s));
  EXPECT_EQ(bus_.faults().book().list().size(), 1U);
  bus_.faults().begin(fault(DisconnectedFault{"b"}, 2s, 3s));
  live(kStart + 100ms, kStart + 2900ms);
  EXPECT_EQ(bus_.counters(b_).sent, 0U) << "the second begins where the first ends";
  live(kStart + 3s, kStart + 4s);
  EXPECT_GE(bus_.counters(b_).sent, 90U);
}

/// A client of the control surface adds an intruder again and again.
TEST_F(CanFaults, AnIntrudersPlaceIsTakenByTheNext) {
  bus_.set_faults({}, intruders_);
  for (int i = 0; i < 200; ++i) {
    const Duration from = i * 20ms;
    bus_.faults().begin(fault(IntruderFault{"080#00", 5ms}, from, from + 10ms));
    live(kStart + from, kStart + from + 20ms);
  }
  EXPECT_EQ(intruders_.frames.size(), 400U) << "two of each";
  EXPECT_EQ(bus_.faults().intruders().size(), 1U);
  // Two at a time are two.
  bus_.faults().begin(fault(IntruderFault{"080#00", 5ms}, 4s, 5s));
  bus_.faults().begin(fault(IntruderFault{"081#00", 5ms}, 4s, 5s));
  live(kStart + 4s, kStart + 5s);
  EXPECT_EQ(intruders_.frames.size(), 800U);
  EXPECT_EQ(bus_.faults().intruders().size(), 2U);
}

struct Outcome {
  std::vector<std::pair<SimTime, Frame>> frames;
  std::vector<CanNodeCounters> counters;
  std::vector<protocols::can::ControllerReport> controllers;
  friend bool operator==(const Outcome&, const Outcome&) = default;
};

/// How the faults of a storm come about.
enum class Told { before_the_run, when_they_begin, when_they_begin_and_end };

/// Everything at once: random traffic of five nodes and the client, and every fault.
Outcome storm(bool by_events, Told told = Told::before_the_run, int disturbed_bit = -1) {
  const std::vector<CanFault> all{fault(BitErrorsFault{1e-3}, 0ms, 1h),
                                  fault(IntruderFault{"080#0000000000000000", 3ms}, 100ms, 1400ms),
                                  fault(WrongRateFault{"n1", 200'000}, 300ms, 500ms),
                                  fault(DisconnectedFault{"n2"}, 600ms, 900ms),
                                  fault(DisturbanceFault{disturbed_bit}, 1000ms, 1020ms),
                                  fault(ShortCircuitFault{}, 1200ms, 1210ms)};
  FrameRecorder outside;
  Client client;
  CanBusModel bus({250'000, 8});
  bus.set_outside(client);
  std::vector<FrameOutput*> nodes;
  for (int i = 0; i < 5; ++i) {
    CanNodeSettings settings;
    settings.name = "n" + std::to_string(i);
    settings.order = i % 2 == 0 ? CanQueueOrder::fifo : CanQueueOrder::priority;
    settings.one_shot = i == 3;
    settings.restart_after = 10ms;
    nodes.push_back(&bus.add_node(outside, settings));
  }
  // The number of a fault is its place among those that were told, and seeds what it draws.
  const bool live = told != Told::before_the_run;
  bus.set_faults({live ? std::vector<CanFault>{} : all, 3}, outside);
  std::vector<CanFaultSchedule::Book::Id> ids;
  RandomBits random(11);
  for (SimTime now = kStart; now < kStart + 1500ms; now += 100us) {
    if (by_events) {
      while (bus.next_event() < now) {
        bus.advance(bus.next_event());
      }
    } else {
      bus.advance(now - 1ns);
    }
    while (live && ids.size() < all.size() && all[ids.size()].when.begin() <= now) {
      CanFault next = all[ids.size()];
      if (told == Told::when_they_begin_and_end) {
        next.when.length.reset();
      }
      ids.push_back(bus.faults().begin(next));
    }
    for (std::size_t i = 0; told == Told::when_they_begin_and_end && i < ids.size(); ++i) {
      if (all[i].when.end() == now) {
        EXPECT_TRUE(bus.faults().end(ids[i], now));
      }
    }
    if (random.below(4) == 0) {
      nodes[random.below(5)]->send(now, extended(random.below(64) << 18U));
    }
    if (random.below(16) == 0) {
      bus.receive(now, standard(random.below(0x800)));
    }
    if (random.below(4000) == 0) {
      bus.set_client(now, {.present = random.below(4) != 0, .one_shot = random.below(2) == 0});
    }
    for (const CanNodeStatus& node : bus.nodes()) {
      EXPECT_TRUE(conserved(node.counters)) << node.name << " at " << to_seconds(now);
    }
  }
  // Every frame of the client was settled, or waits.
  const CanNodeCounters counters = bus.outside_counters();
  EXPECT_EQ(client.confirmed.size() + counters.queued,
            counters.sent + counters.abandoned + counters.overflowed + counters.queued);
  Outcome outcome;
  outcome.frames = outside.frames;
  for (const CanNodeStatus& node : bus.nodes()) {
    outcome.counters.push_back(node.counters);
    outcome.controllers.push_back(node.controller);
  }
  return outcome;
}

TEST(CanStorm, CountersConserveAndNothingDependsOnTheSteps) {
  const Outcome outcome = storm(true);
  EXPECT_EQ(outcome, storm(true));
  EXPECT_EQ(outcome, storm(false));
  EXPECT_EQ(outcome, storm(true, Told::when_they_begin));
  // The bit that a random disturbance takes depends on its end, which is not known beforehand.
  constexpr int kDisturbed = 30;
  EXPECT_EQ(storm(true, Told::before_the_run, kDisturbed),
            storm(true, Told::when_they_begin_and_end, kDisturbed));
  EXPECT_GT(outcome.frames.size(), 500U);
}

}  // namespace
}  // namespace rigwire::emulators
