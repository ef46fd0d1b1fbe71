// What errors cost and where they lead, against bit counts worked by hand.
#include <gtest/gtest.h>

#include <vector>

#include "can_test_nodes.h"
#include "emulators/can/can_bus.h"
#include "fault_period.h"
#include "protocols/can/bits.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using protocols::can::BusError;
using protocols::can::ControllerReport;
using protocols::can::ErrorState;
using protocols::can::exact_bits;
using protocols::can::Frame;
using protocols::can::FrameField;
using rigwire::test::FrameRecorder;
using test::conserved;
using test::Listener;
using test::standard;
using test::time_of;
using test::worked_frame;

constexpr Duration kCanErrorsBit = 4us;  // at 250 kbit/s
constexpr SimTime kEnd = kStart + 1h;

/// Two devices and a client that is there.
class CanErrors : public testing::Test {
 protected:
  FrameRecorder outside_;
  CanBusModel bus_{CanBusSettings{250'000, 16}};
  FrameOutput& a_ = bus_.add_node(outside_, {.name = "a", .restart_after = std::nullopt});
  FrameOutput& b_ = bus_.add_node(outside_, {.name = "b"});
  Listener device_a_;
  Listener device_b_;
  void SetUp() override {
    bus_.attach(a_, device_a_);
    bus_.attach(b_, device_b_);
  }
  void invert(unsigned bit, Duration begin, Duration end) {
    bus_.set_faults({{{between(begin, end), DisturbanceFault{static_cast<int>(bit)}}}}, outside_);
  }
  /// One attempt of the worked frame is disturbed: after how many bits the next one begins.
  long bits_to_retransmission(unsigned bit) {
    invert(bit, 0us, (bit + 1) * kCanErrorsBit);
    a_.send(kStart, worked_frame());
    bus_.advance(kStart + 10ms);
    const Duration good = (exact_bits(worked_frame()) - 3) * kCanErrorsBit;
    return (outside_.frames.back().first - good - kStart) / kCanErrorsBit;
  }
};

TEST_F(CanErrors, ActiveFlagsOfTransmitterAndReceiversOverlap) {
  // Number 20 is read dominant. The transmitter signals in 21 .. 26; receivers have six dominant
  // bits at 25 and signal in 26 .. 31; delimiter to 39, intermission to 42.
  invert(20, 0us, 21 * kCanErrorsBit);
  a_.send(kStart, worked_frame());
  bus_.advance(kStart + 10ms);
  ASSERT_EQ(outside_.frames.size(), 1U);
  EXPECT_EQ(outside_.frames[0].first,
            kStart + (43 + exact_bits(worked_frame()) - 3) * kCanErrorsBit);
  const CanNodeCounters counters = bus_.counters(a_);
  EXPECT_EQ(counters.retransmissions, 1U);
  EXPECT_EQ(counters.errors.bit, 1U);
  EXPECT_EQ(bus_.counters(b_).errors.stuff, 1U);
  EXPECT_EQ(bus_.controller(a_).transmit_errors, 7);  // + 8 - 1
  EXPECT_EQ(bus_.controller(b_).receive_errors, 0);   // + 1 - 1
  ASSERT_EQ(device_a_.reports.size(), 1U);
  EXPECT_EQ(device_a_.reports[0].first, kStart + 21 * kCanErrorsBit);
  const ControllerReport& own = device_a_.reports[0].second;
  EXPECT_EQ(own.error, BusError::bit);
  EXPECT_EQ(own.bit, 20);
  EXPECT_EQ(own.field, FrameField::data);
  EXPECT_TRUE(own.transmitting);
  EXPECT_FALSE(own.dominant);
  EXPECT_EQ(own.transmit_errors, 8);
  ASSERT_EQ(device_b_.reports.size(), 1U);
  EXPECT_EQ(device_b_.reports[0].first, kStart + 26 * kCanErrorsBit);
  EXPECT_EQ(device_b_.reports[0].second.receive_errors, 1);
}

TEST_F(CanErrors, DominantBitsInFrontShortenTheSuperposedFlag) {
  // 17 and 18 are dominant, 19 is read so: six of them at 22, flags end at 28.
  EXPECT_EQ(bits_to_retransmission(19), 28 + 1 + 8 + 3);
}

TEST_F(CanErrors, InvertedStuffBitIsSeenByAllAtOnce) {
  // 11 .. 15 are dominant and 16 is read so: everybody signals in 17 .. 22.
  EXPECT_EQ(bits_to_retransmission(16), 22 + 1 + 8 + 3);
}

TEST_F(CanErrors, ErrorInTheCrcDelimiterIsSeenByAllAtOnce) {
  // 44 bits and three stuff bits up to the CRC are checked by the exact length: 13 bits follow it.
  const unsigned delimiter = exact_bits(worked_frame()) - 13;
  EXPECT_EQ(bits_to_retransmission(delimiter), delimiter + 6 + 1 + 8 + 3);
  EXPECT_EQ(bus_.counters(a_).errors.form, 1U);
  EXPECT_EQ(bus_.counters(b_).errors.form, 1U);
}

TEST_F(CanErrors, InvertedAcknowledgementConcernsEverybodyWhoSentIt) {
  const unsigned slot = exact_bits(worked_frame()) - 12;
  EXPECT_EQ(bits_to_retransmission(slot), slot + 6 + 1 + 8 + 3);
  EXPECT_EQ(bus_.counters(a_).errors.acknowledgement, 1U);
  EXPECT_EQ(bus_.counters(b_).errors.bit, 1U);
}

TEST_F(CanErrors, DominantLastBitMakesTheFrameArriveTwice) {
  const unsigned last = exact_bits(worked_frame()) - 4;
  EXPECT_EQ(bits_to_retransmission(last), last + 6 + 1 + 8 + 3);
  EXPECT_EQ(outside_.frames.size(), 2U);
  EXPECT_EQ(device_b_.heard.size(), 2U);
  EXPECT_EQ(bus_.counters(a_).sent, 1U);
  EXPECT_EQ(bus_.controller(b_).receive_errors, 0);
}

TEST_F(CanErrors, InvertedIdentifierBitLooksLikeLostArbitration) {
  // Number 2 is read dominant: nobody sends on, 3 .. 8 are six recessive bits, all signal in 9
  // .. 14.
  EXPECT_EQ(bits_to_retransmission(2), 14 + 1 + 8 + 3);
  EXPECT_EQ(bus_.controller(a_).transmit_errors, 0);
  EXPECT_EQ(bus_.counters(a_).arbitration_losses, 1U);
  EXPECT_EQ(bus_.counters(a_).retransmissions, 0U);
  EXPECT_EQ(bus_.counters(a_).errors.stuff, 1U);
}

TEST_F(CanErrors, UnseenStartOfFrameMakesTheFlagTwelveBitsLong) {
  // Receivers take the transmitter's flag, 1 .. 6, for a start of frame with five more bits.
  EXPECT_EQ(bits_to_retransmission(0), 12 + 1 + 8 + 3);
}

TEST_F(CanErrors, ThirtyTwoFailuresLeadThroughPassiveToBusOffAtTheExactBit) {
  invert(20, 0us, 1h);
  a_.send(kStart, worked_frame());
  a_.send(kStart, standard(0x123));
  bus_.advance(kStart + 100ms);
  // Sixteen times 43 bits while active. A passive flag leaves the bus recessive: receivers have six
  // bits at 26 and signal in 27 .. 32, which makes 44 bits; and the transmitter waits eight more.
  EXPECT_EQ(time_of(device_a_.reports, ErrorState::warning),
            kStart + (11 * 43 + 21) * kCanErrorsBit);
  EXPECT_EQ(time_of(device_a_.reports, ErrorState::passive),
            kStart + (15 * 43 + 21) * kCanErrorsBit);
  const SimTime off = kStart + (16 * 43 + 8 + 15 * (44 + 8) + 21) * kCanErrorsBit;
  EXPECT_EQ(time_of(device_a_.reports, ErrorState::bus_off), off);
  EXPECT_EQ(bus_.controller(a_).transmit_errors, 256);
  EXPECT_EQ(bus_.controller(b_).receive_errors, 32);
  EXPECT_EQ(bus_.error_frames(), 32U);
  EXPECT_EQ(bus_.counters(a_).bus_offs, 1U);
  EXPECT_EQ(bus_.counters(a_).abandoned, 2U);
  EXPECT_EQ(bus_.next_event(), kNever);  // It waits to be asked.
  a_.send(kStart + 101ms, standard(0x123));
  EXPECT_EQ(bus_.counters(a_).abandoned, 3U);
  EXPECT_TRUE(conserved(bus_.counters(a_)));
}

TEST_F(CanErrors, RecoveryTakes128TimesElevenBitsOfIdleBus) {
  invert(20, 0us, 50ms);
  b_.send(kStart, worked_frame());
  bus_.advance(kEnd);
  const SimTime off = time_of(device_b_.reports, ErrorState::bus_off);
  ASSERT_NE(off, kNever);
  ASSERT_EQ(device_b_.reports.back().first, off + 100ms + 128 * 11 * kCanErrorsBit);
  const ControllerReport& back = device_b_.reports.back().second;
  EXPECT_TRUE(back.restarted);
  EXPECT_TRUE(back.state_changed);
  EXPECT_EQ(back.state, ErrorState::active);
  EXPECT_EQ(back.transmit_errors, 0);
  b_.send(kEnd, worked_frame());
  bus_.advance(kEnd + 1s);
  EXPECT_EQ(outside_.frames.size(), 1U);
}

TEST_F(CanErrors, OnABusyBusEachFrameGivesOneOfTheSequences) {
  invert(20, 0us, 50ms);
  b_.send(kStart, worked_frame());
  const SimTime off = [&] {
    bus_.advance(kStart + 50ms);
    return time_of(device_b_.reports, ErrorState::bus_off);
  }();
  // Back to back from 90 ms on; recovery begins within the frame that is under way 100 ms after.
  const unsigned length = exact_bits(standard(0x55));
  const SimTime first = kStart + 90ms;
  for (SimTime now = first; now < kStart + 500ms; now += length * kCanErrorsBit) {
    bus_.advance(now - 1ns);
    a_.send(now, standard(0x55));
  }
  const auto under_way = (off + 100ms - first) / (length * kCanErrorsBit);
  EXPECT_EQ(device_b_.reports.back().first, first + (under_way + 128) * (length * kCanErrorsBit));
  EXPECT_TRUE(device_b_.reports.back().second.restarted);
}

TEST_F(CanErrors, OneShotNodeDoesNotRepeatWhatAnErrorEnded) {
  FrameRecorder outside;
  CanBusModel bus({});
  FrameOutput& a = bus.add_node(outside, {.one_shot = true});
  bus.set_faults({{{between(0us, 100us), DisturbanceFault{20}}}}, outside);
  a.send(kStart, worked_frame());
  a.send(kStart, standard(0x123));
  bus.advance(kStart + 1s);
  ASSERT_EQ(outside.frames.size(), 1U);
  EXPECT_EQ(outside.frames[0].second.id, 0x123U);
  EXPECT_EQ(bus.counters(a).abandoned, 1U);
  EXPECT_EQ(bus.counters(a).retransmissions, 0U);
}

TEST(CanAlone, NodeWithoutAnyOtherBecomesPassiveAndNeverBusOff) {
  FrameRecorder outside;
  CanBusModel bus({});
  FrameOutput& a = bus.add_node(outside);
  Listener device;
  bus.attach(a, device);
  bus.set_client(kStart, {.present = false});
  const Frame frame = standard(0x123);
  a.send(kStart, frame);
  bus.advance(kStart + 10s);
  // Length without intermission to the acknowledge slot's end, then flag 6, delimiter 8,
  // intermission 3: the exact length and six bits. Eight more once it is passive.
  const unsigned attempt = exact_bits(frame) + 6;
  const unsigned slot_end = exact_bits(frame) - 11;
  EXPECT_EQ(time_of(device.reports, ErrorState::warning),
            kStart + (11 * attempt + slot_end) * kCanErrorsBit);
  EXPECT_EQ(time_of(device.reports, ErrorState::passive),
            kStart + (15 * attempt + slot_end) * kCanErrorsBit);
  EXPECT_EQ(bus.controller(a).transmit_errors, 128);
  EXPECT_EQ(bus.controller(a).state, ErrorState::passive);
  EXPECT_EQ(bus.counters(a).bus_offs, 0U);
  EXPECT_EQ(bus.counters(a).sent, 0U);
  EXPECT_TRUE(outside.frames.empty());
  // The bus is full of it.
  EXPECT_NEAR(bus.load(kStart + 10s), double(attempt) / (attempt + 8), 1e-3);

  const auto attempts = bus.counters(a).errors.acknowledgement;
  const auto expected = (10s - 16 * attempt * kCanErrorsBit) / ((attempt + 8) * kCanErrorsBit);
  EXPECT_NEAR(double(attempts), double(expected + 16), 1.0);

  // Somebody comes: the very next attempt is acknowledged.
  bus.set_client(kStart + 10s, {});
  bus.advance(kStart + 11s);
  EXPECT_EQ(outside.frames.size(), 1U);
  EXPECT_EQ(bus.controller(a).state, ErrorState::warning);
  EXPECT_EQ(bus.controller(a).transmit_errors, 127);
}

// The flag of a passive transmitter cannot be told from the end of frame: who does not acknowledge
// still reads a good frame, again and again.
TEST(CanAlone, ListenersDoNotAcknowledgeWhatTheyHear) {
  FrameRecorder outside;
  CanBusModel bus({});
  FrameOutput& a = bus.add_node(outside);
  (void)bus.add_node(outside, {.listen_only = true});
  bus.set_client(kStart, {.listen_only = true});
  a.send(kStart, standard(0x123));
  bus.advance(kStart + 1s);
  EXPECT_EQ(bus.counters(a).sent, 0U);
  EXPECT_EQ(bus.controller(a).state, ErrorState::passive);
  EXPECT_EQ(bus.outside_controller().receive_errors, 0);
  const auto attempts = bus.counters(a).errors.acknowledgement;
  EXPECT_GE(outside.frames.size() + 1, attempts - 16);  // One may be under way.
}

TEST(CanAlone, PassiveTransmitterLeavesOthersEightBits) {
  // All attempts are disturbed. While it is passive the one waits after each, so the other goes,
  // whatever the identifiers say.
  FrameRecorder outside;
  CanBusModel bus({});
  FrameOutput& a = bus.add_node(outside);
  FrameOutput& b = bus.add_node(outside);
  Listener device;
  bus.attach(b, device);
  bus.set_faults({{{between(0ms, 100ms), DisturbanceFault{20}}}}, outside);
  a.send(kStart, standard(0x123));
  bus.advance(kStart + 3500us);  // Past sixteen attempts, before the thirty-second.
  ASSERT_EQ(bus.controller(a).state, ErrorState::passive);
  device.reports.clear();
  b.send(kStart + 3500us, standard(0x7FF));
  while (bus.counters(b).errors.bit == 0 && bus.next_event() < kStart + 10ms) {
    bus.advance(bus.next_event());
  }
  ASSERT_FALSE(device.reports.empty());
  EXPECT_TRUE(device.reports.back().second.transmitting);
  EXPECT_EQ(bus.counters(b).arbitration_losses, 0U);
}

TEST(CanCollision, DifferentDataIsABitErrorOfTheRecessiveOne) {
  FrameRecorder outside;
  CanBusModel bus({});
  FrameOutput& a = bus.add_node(outside);
  FrameOutput& b = bus.add_node(outside);
  Listener device_a;
  Listener device_b;
  bus.attach(a, device_a);
  bus.attach(b, device_b);
  // The worked frame, and the same with data 0xA8: they differ in number 26.
  Frame other = worked_frame();
  other.data[0] = 0xA8;
  a.send(kStart, worked_frame());
  b.send(kStart, other);
  bus.advance(kStart + 200us);
  ASSERT_EQ(device_a.reports.size(), 1U);
  EXPECT_EQ(device_a.reports[0].first, kStart + 27 * kCanErrorsBit);
  EXPECT_EQ(device_a.reports[0].second.error, BusError::bit);
  EXPECT_EQ(device_a.reports[0].second.bit, 26);
  EXPECT_FALSE(device_a.reports[0].second.dominant);
  // The other one's next recessive bit meets the flag.
  ASSERT_EQ(device_b.reports.size(), 1U);
  EXPECT_TRUE(device_b.reports[0].second.transmitting);
  EXPECT_GT(device_b.reports[0].second.bit, 26);
  EXPECT_EQ(bus.controller(a).transmit_errors, 8);
  EXPECT_EQ(bus.controller(b).transmit_errors, 8);
}

}  // namespace
}  // namespace rigwire::emulators
