#include "emulators/can/can_bus.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <utility>
#include <vector>

#include "can_test_nodes.h"
#include "protocols/can/bits.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using protocols::can::exact_bits;
using protocols::can::Frame;
using rigwire::test::FrameRecorder;
using test::extended;
using test::Listener;
using test::standard;

constexpr Duration kBit = 4us;  // at 250 kbit/s

class CanBus : public testing::Test {
 protected:
  FrameRecorder outside_;
  CanBusModel bus_{CanBusSettings{250'000, 4}};
  FrameOutput& a_ = bus_.add_node(outside_);
  FrameOutput& b_ = bus_.add_node(outside_);
  Listener device_a_;
  Listener device_b_;
  void SetUp() override {
    bus_.attach(a_, device_a_);
    bus_.attach(b_, device_b_);
  }
};

TEST_F(CanBus, FrameLeavesAtItsEndOfFrame) {
  const Frame frame = standard(0x123);
  a_.send(kStart + 1ms, frame);
  bus_.advance(kStart + 1ms);
  EXPECT_TRUE(outside_.frames.empty());
  bus_.advance(kStart + 10ms);
  const SimTime end = kStart + 1ms + (exact_bits(frame) - 3) * kBit;
  ASSERT_EQ(outside_.frames.size(), 1U);
  EXPECT_EQ(outside_.frames[0], std::pair(end, frame));
  ASSERT_EQ(device_b_.heard.size(), 1U);
  EXPECT_EQ(device_b_.heard[0], std::pair(end, frame));
  EXPECT_TRUE(device_a_.heard.empty());
}

TEST_F(CanBus, the_last_request_is_the_clients_last_frame_that_the_device_understood) {
  device_b_.understood = 0x123;
  a_.send(kStart, standard(0x123));  // another device's
  bus_.advance(kStart + 1ms);
  EXPECT_FALSE(bus_.last_request(b_).has_value());
  bus_.receive(kStart + 2ms, standard(0x123));
  bus_.receive(kStart + 2ms, standard(0x124));
  bus_.advance(kStart + 10ms);
  ASSERT_TRUE(bus_.last_request(b_).has_value());
  EXPECT_EQ(bus_.last_request(b_)->frame, standard(0x123));
  EXPECT_EQ(bus_.last_request(b_)->at, device_b_.heard[1].first);
  EXPECT_FALSE(bus_.last_request(a_).has_value());
}

TEST_F(CanBus, LowerIdentifierWinsAndTheLoserFollowsWithoutGap) {
  a_.send(kStart, standard(0x200));
  b_.send(kStart, standard(0x100));
  bus_.advance(kStart + 10ms);
  ASSERT_EQ(outside_.frames.size(), 2U);
  EXPECT_EQ(outside_.frames[0].second.id, 0x100U);
  EXPECT_EQ(outside_.frames[1].second.id, 0x200U);
  const unsigned both = exact_bits(standard(0x100)) + exact_bits(standard(0x200));
  EXPECT_EQ(outside_.frames[1].first, kStart + (both - 3) * kBit);
}

TEST_F(CanBus, FrameOnTheWireIsNotInterrupted) {
  a_.send(kStart, standard(0x7FF));
  b_.send(kStart + kBit, standard(0x000));  // one bit too late to join
  bus_.advance(kStart + 10ms);
  ASSERT_EQ(outside_.frames.size(), 2U);
  EXPECT_EQ(outside_.frames[0].second.id, 0x7FFU);
}

TEST_F(CanBus, WithinTheFirstBitANodeStillJoins) {
  a_.send(kStart, standard(0x7FF));
  bus_.advance(kStart);
  b_.send(kStart + kBit - 1ns, standard(0x000));
  bus_.advance(kStart + 10ms);
  EXPECT_EQ(outside_.frames.at(0).second.id, 0x000U);
}

TEST_F(CanBus, MixedFormatsFollowTheWireOrder) {
  a_.send(kStart, standard(0x101));
  b_.send(kStart, extended(0x100U << 18U));
  bus_.advance(kStart + 10ms);
  EXPECT_TRUE(outside_.frames.at(0).second.extended);
}

TEST_F(CanBus, OutsideFramesReachEveryDeviceButNotTheOutside) {
  bus_.receive(kStart, standard(0x321));
  bus_.advance(kStart + 10ms);
  EXPECT_EQ(device_a_.heard.size(), 1U);
  EXPECT_EQ(device_b_.heard.size(), 1U);
  EXPECT_TRUE(outside_.frames.empty());
  EXPECT_EQ(bus_.outside_counters().sent, 1U);
}

TEST_F(CanBus, FullQueueLosesTheNewFrameAndCounts) {
  for (std::uint32_t id = 1; id <= 7; ++id) {
    a_.send(kStart, standard(id));
  }
  bus_.advance(kStart + 100ms);
  EXPECT_EQ(outside_.frames.size(), 4U);
  EXPECT_EQ(bus_.counters(a_).overflowed, 3U);
  EXPECT_EQ(bus_.counters(a_).sent, 4U);
  EXPECT_EQ(bus_.counters(b_).overflowed, 0U);
}

TEST_F(CanBus, OwnFramesKeepTheirOrderWhateverTheirIdentifiers) {
  a_.send(kStart, standard(0x300));
  a_.send(kStart, standard(0x100));
  bus_.advance(kStart + 10ms);
  EXPECT_EQ(outside_.frames.at(0).second.id, 0x300U);
}

TEST_F(CanBus, EqualFramesOfTwoNodesAreBothSentAndHeardOnce) {
  a_.send(kStart, standard(0x100));
  b_.send(kStart, standard(0x100));
  bus_.advance(kStart + 10ms);
  EXPECT_EQ(outside_.frames.size(), 1U);
  EXPECT_EQ(bus_.counters(a_).sent, 1U);
  EXPECT_EQ(bus_.counters(b_).sent, 1U);
  EXPECT_EQ(bus_.outside_counters().received, 1U);
  EXPECT_EQ(bus_.frames(), 1U);
  EXPECT_EQ(bus_.collisions(), 1U);
}

TEST_F(CanBus, SteppingByEventsOrAtOnceGivesTheSame) {
  FrameRecorder other_outside;
  CanBusModel other(CanBusSettings{250'000, 4});
  FrameOutput& x = other.add_node(other_outside);
  FrameOutput& y = other.add_node(other_outside);
  for (int i = 0; i < 4; ++i) {
    a_.send(kStart + i * 300us, standard(0x200));
    x.send(kStart + i * 300us, standard(0x200));
    b_.send(kStart + i * 500us, extended(0x0CF02980));
    y.send(kStart + i * 500us, extended(0x0CF02980));
  }
  bus_.advance(kStart + 1s);
  while (other.next_event() != kNever) {
    other.advance(other.next_event());
  }
  EXPECT_EQ(outside_.frames, other_outside.frames);
  EXPECT_EQ(outside_.frames.size(), 8U);
}

TEST_F(CanBus, SaturatedBusGivesTheWinnerItsRate) {
  // Two nodes offer 100 % each; the lower identifier never waits longer than one frame.
  const unsigned length = exact_bits(standard(0x001));
  const Duration period = length * kBit;
  SimTime last = kStart;
  for (int i = 0; i < 100; ++i) {
    const SimTime now = kStart + i * period;
    a_.send(now, standard(0x700));
    b_.send(now, standard(0x001));
    bus_.advance(now);
    last = now;
  }
  bus_.advance(last + 10 * period);
  EXPECT_EQ(bus_.counters(b_).overflowed, 0U);
  EXPECT_EQ(bus_.counters(b_).sent, 100U);
  EXPECT_GT(bus_.counters(a_).overflowed, 80U);
}

TEST_F(CanBus, LoadCountsExactBitsOverTheLastSecond) {
  const Frame frame = standard(0x123);
  SimTime now = kStart;
  for (; now < kStart + 3s; now += 10ms) {
    bus_.advance(now);
    a_.send(now, frame);
  }
  bus_.advance(now);
  const double expected = 100.0 * exact_bits(frame) / 250'000.0;
  EXPECT_NEAR(bus_.load(now), expected, 1e-9);
  EXPECT_DOUBLE_EQ(bus_.load(now + 5s), 0.0);
  // And again after a long silence.
  a_.send(now + 100s, frame);
  bus_.advance(now + 101s);
  EXPECT_NEAR(bus_.load(now + 100s + 50ms), exact_bits(frame) / 250'000.0, 1e-9);
}

TEST(CanBusSettings, AreChecked) {
  FrameRecorder outside;
  EXPECT_THROW(CanBusModel(CanBusSettings{0, 4}), std::invalid_argument);
  EXPECT_THROW(CanBusModel(CanBusSettings{250'000, 0}), std::invalid_argument);
  CanBusModel bus(CanBusSettings{});
  EXPECT_THROW((void)bus.counters(outside), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::emulators
