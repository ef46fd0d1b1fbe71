// Order of sending: between nodes by the bits on the wire, within a node by its queue.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "can_test_nodes.h"
#include "emulators/can/can_bus.h"
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

TEST(CanArbitration, FollowsTheBitsOnTheWireForMixedFormats) {
  // Worked by hand: base identifier (11 bits), then RTR of an 11-bit frame or SRR = 1, then IDE,
  // 18 bits, RTR. Dominant 0 wins.
  const std::array<Frame, 12> order{{
      {0x000, false, false, 0, {}},                   // 000 0000 0000 0 0
      {0x000, false, true, 0, {}},                    // 000 0000 0000 1 0
      {0x00000000, true, false, 0, {}},               // 000 0000 0000 1 1 0...0 0
      {0x00000000, true, true, 0, {}},                // 000 0000 0000 1 1 0...0 1
      {0x00000001, true, false, 0, {}},               // 000 0000 0000 1 1 0...1 0
      {0x0003FFFF, true, true, 0, {}},                // 000 0000 0000 1 1 1...1 1
      {0x001, false, false, 0, {}},                   // 000 0000 0001 0 0
      {0x001U << 18U, true, false, 0, {}},            // 000 0000 0001 1 1 0...0 0
      {0x2AA, false, false, 0, {}},                   // 010 1010 1010 0 0
      {(0x2AAU << 18U) | 0x155, true, false, 0, {}},  // 010 1010 1010 1 1
      {0x7FF, false, false, 0, {}},                   // 111 1111 1111 0 0
      {0x1FFFFFFF, true, false, 0, {}},               // 111 1111 1111 1 1 1...1 0
  }};
  // In three orders of attachment, none of them the expected one.
  for (const std::size_t step : {5U, 7U, 11U}) {
    FrameRecorder outside;
    CanBusModel bus({});
    for (std::size_t i = 0; i < order.size(); ++i) {
      bus.add_node(outside).send(kStart, order[(i * step + 3) % order.size()]);
    }
    bus.advance(kStart + 1s);
    ASSERT_EQ(outside.frames.size(), order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      EXPECT_EQ(outside.frames[i].second, order[i]) << i;
    }
  }
}

TEST(CanArbitration, LosersAreCountedAndAreNotRetransmissions) {
  FrameRecorder outside;
  CanBusModel bus({});
  FrameOutput& a = bus.add_node(outside);
  FrameOutput& b = bus.add_node(outside);
  a.send(kStart, standard(0x100));
  a.send(kStart, standard(0x101));
  b.send(kStart, standard(0x200));
  bus.advance(kStart + 10ms);
  EXPECT_EQ(bus.counters(b).arbitration_losses, 2U);
  EXPECT_EQ(bus.counters(b).retransmissions, 0U);
  EXPECT_EQ(bus.counters(a).arbitration_losses, 0U);
  const unsigned before = exact_bits(standard(0x100)) + exact_bits(standard(0x101));
  EXPECT_EQ(bus.counters(b).longest_wait, before * 4us);
}

TEST(CanArbitration, OneShotNodeGivesUpWhatLost) {
  FrameRecorder outside;
  CanBusModel bus({});
  FrameOutput& a = bus.add_node(outside);
  FrameOutput& b = bus.add_node(outside, {.one_shot = true});
  Listener device;
  bus.attach(b, device);
  // 0x100 and 0x140 differ in identifier bit 6: 001 0 0.. against 001 0 1..: number 5 on the wire,
  // start of frame being 0.
  a.send(kStart, standard(0x100));
  b.send(kStart, standard(0x140));
  b.send(kStart, standard(0x300));
  bus.advance(kStart + 10ms);
  ASSERT_EQ(outside.frames.size(), 2U);
  EXPECT_EQ(outside.frames[1].second.id, 0x300U);
  EXPECT_EQ(bus.counters(b).abandoned, 1U);
  ASSERT_EQ(device.reports.size(), 1U);
  EXPECT_TRUE(device.reports[0].second.arbitration_lost);
  EXPECT_EQ(device.reports[0].second.bit, 5);
  EXPECT_EQ(device.reports[0].second.field, protocols::can::FrameField::identifier_28_21);
}

/// An urgent frame behind one that everybody else beats.
std::size_t place_of_urgent(CanQueueOrder order) {
  FrameRecorder outside;
  CanBusModel bus({});
  FrameOutput& a = bus.add_node(outside, {.order = order});
  FrameOutput& b = bus.add_node(outside);
  a.send(kStart, standard(0x700));
  a.send(kStart, standard(0x001));
  for (std::uint32_t i = 0; i < 10; ++i) {
    b.send(kStart, standard(0x100 + i));
  }
  bus.advance(kStart + 1s);
  const auto found =
      std::ranges::find(outside.frames, 0x001U, [](const auto& entry) { return entry.second.id; });
  return static_cast<std::size_t>(found - outside.frames.begin());
}

TEST(CanArbitration, AQueueInOrderOfArrivalInvertsPriorities) {
  EXPECT_EQ(place_of_urgent(CanQueueOrder::fifo), 11U);     // Behind 0x700, which waits for all.
  EXPECT_EQ(place_of_urgent(CanQueueOrder::priority), 0U);  // At once.
}

TEST(CanArbitration, AFrameOnTheWireIsFinishedBeforeAMoreUrgentOneOfItsNode) {
  FrameRecorder outside;
  CanBusModel bus({});
  FrameOutput& a = bus.add_node(outside, {.order = CanQueueOrder::priority});
  a.send(kStart, standard(0x700));
  bus.advance(kStart + 10us);
  a.send(kStart + 20us, standard(0x001));
  bus.advance(kStart + 10ms);
  ASSERT_EQ(outside.frames.size(), 2U);
  EXPECT_EQ(outside.frames[0].second.id, 0x700U);
}

TEST(CanArbitration, AllIdentifiersEqualAndAllFramesEqual) {
  FrameRecorder outside;
  CanBusModel bus({});
  std::vector<FrameOutput*> nodes;
  for (int i = 0; i < 8; ++i) {
    nodes.push_back(&bus.add_node(outside));
    for (int k = 0; k < 20; ++k) {
      nodes.back()->send(kStart, extended(0x18FEF100));
    }
  }
  bus.advance(kStart + 1s);
  EXPECT_EQ(outside.frames.size(), 20U);
  for (const FrameOutput* node : nodes) {
    EXPECT_EQ(bus.counters(*node).sent, 20U);
  }
  EXPECT_EQ(bus.error_frames(), 0U);
}

// Only receivers acknowledge (ISO 11898-1), so that both see an acknowledgement error, wait
// for the same time and meet again; a passive sender no longer counts these errors.
TEST(CanArbitration, EqualFramesOfBothNodesMeetForeverUntilAThirdNodeAcknowledges) {
  for (const bool third : {false, true}) {
    FrameRecorder outside;
    CanBusModel bus({});
    FrameOutput& node = bus.add_node(outside);
    if (third) {
      (void)bus.add_node(outside);
    }
    node.send(kStart, extended(0x0CF02A80));
    bus.receive(kStart, extended(0x0CF02A80));
    bus.advance(kStart + 60s);
    EXPECT_EQ(bus.counters(node).sent, third ? 1U : 0U);
    EXPECT_EQ(bus.counters(node).queued, third ? 0U : 1U);
    EXPECT_NE(bus.controller(node).state, protocols::can::ErrorState::bus_off);
  }
}

TEST(CanArbitration, AllIdentifiersEqualWithDifferentDataEndsInErrorsAndAllArrive) {
  FrameRecorder outside;
  CanBusModel bus({});
  std::vector<FrameOutput*> nodes;
  for (std::uint8_t i = 0; i < 4; ++i) {
    nodes.push_back(&bus.add_node(outside));
    Frame frame = extended(0x18EEFF80);
    frame.data[0] = i;
    nodes.back()->send(kStart, frame);
  }
  bus.advance(kStart + 1s);
  // Active nodes destroy each other's frames until they are passive; passive ones yield to the
  // dominant bit, so the smallest data go first.
  EXPECT_EQ(bus.error_frames(), 16U);
  ASSERT_EQ(outside.frames.size(), 4U);
  for (std::uint8_t i = 0; i < 4; ++i) {
    EXPECT_EQ(outside.frames[i].second.data[0], i);
    EXPECT_EQ(bus.counters(*nodes[i]).sent, 1U);
    EXPECT_NE(bus.controller(*nodes[i]).state, protocols::can::ErrorState::bus_off);
  }
}

}  // namespace
}  // namespace rigwire::emulators
