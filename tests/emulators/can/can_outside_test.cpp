// The client's controller: what it is told, and what it does to the others.
#include <gtest/gtest.h>

#include <vector>

#include "can_test_nodes.h"
#include "emulators/can/can_bus.h"
#include "fault_period.h"
#include "protocols/can/bits.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using protocols::can::ErrorState;
using protocols::can::exact_bits;
using rigwire::test::FrameRecorder;
using test::Client;
using test::conserved;
using test::Listener;
using test::standard;
using test::time_of;

constexpr Duration kCanOutsideBit = 4us;

class CanOutsideTest : public testing::Test {
 protected:
  FrameRecorder outside_;
  Client client_;
  CanBusModel bus_{CanBusSettings{250'000, 4}};
  FrameOutput& a_ = bus_.add_node(outside_, {.name = "a"});
  void SetUp() override { bus_.set_outside(client_); }
};

TEST_F(CanOutsideTest, FrameIsConfirmedAtItsEnd) {
  bus_.receive(kStart, standard(0x123));
  bus_.advance(kStart + 10ms);
  ASSERT_EQ(client_.confirmed.size(), 1U);
  EXPECT_EQ(client_.confirmed[0],
            std::pair(kStart + (exact_bits(standard(0x123)) - 3) * kCanOutsideBit, true));
  EXPECT_TRUE(client_.reports.empty());
}

TEST_F(CanOutsideTest, RefusedFramesAreSettledInTheirOrder) {
  for (std::uint32_t i = 0; i < 6; ++i) {
    bus_.receive(kStart, standard(i));  // The fifth and sixth find the queue full.
  }
  EXPECT_TRUE(client_.confirmed.empty());
  ASSERT_EQ(client_.reports.size(), 2U);
  EXPECT_TRUE(client_.reports[0].second.transmit_overflow);
  bus_.advance(kStart + 100us);
  bus_.receive(kStart + 100us, standard(6));  // The first is on the wire: there is room again.
  bus_.advance(kStart + 100ms);
  std::vector<bool> sent;
  for (const auto& [time, confirmed] : client_.confirmed) {
    sent.push_back(confirmed);
  }
  EXPECT_EQ(sent, (std::vector<bool>{true, true, true, true, false, false, true}));
  EXPECT_TRUE(conserved(bus_.outside_counters()));
}

TEST_F(CanOutsideTest, ClosingGivesUpWhatWaitsAndNobodyAcknowledgesAnyMore) {
  bus_.receive(kStart, standard(1));
  bus_.receive(kStart, standard(2));
  bus_.set_client(kStart, {.present = false});
  EXPECT_EQ(client_.confirmed.size(), 2U);
  bus_.receive(kStart + 1us, standard(3));
  ASSERT_EQ(client_.confirmed.size(), 3U);
  EXPECT_FALSE(client_.confirmed[2].second);
  a_.send(kStart + 1ms, standard(4));
  bus_.advance(kStart + 100ms);
  EXPECT_EQ(bus_.counters(a_).sent, 0U);
  EXPECT_EQ(bus_.controller(a_).state, ErrorState::passive);
  EXPECT_TRUE(conserved(bus_.outside_counters()));
}

TEST_F(CanOutsideTest, ListenerHearsButCannotSend) {
  (void)bus_.add_node(outside_);  // Somebody who acknowledges.
  bus_.set_client(kStart, {.listen_only = true});
  a_.send(kStart, standard(1));
  bus_.receive(kStart, standard(2));
  bus_.advance(kStart + 10ms);
  EXPECT_EQ(outside_.frames.size(), 1U);
  ASSERT_EQ(client_.confirmed.size(), 1U);
  EXPECT_FALSE(client_.confirmed[0].second);
}

TEST_F(CanOutsideTest, OneShotFailureIsConfirmedAsSuch) {
  FrameRecorder outside;
  Client client;
  CanBusModel bus({});
  bus.set_outside(client);
  bus.set_client(kStart, {.one_shot = true});
  bus.receive(kStart, standard(1));  // Nobody else is on the bus.
  bus.advance(kStart + 10ms);
  ASSERT_EQ(client.confirmed.size(), 1U);
  EXPECT_FALSE(client.confirmed[0].second);
  ASSERT_EQ(client.reports.size(), 1U);
  EXPECT_EQ(client.reports[0].second.error, protocols::can::BusError::acknowledgement);
}

TEST_F(CanOutsideTest, BusOffWaitsForTheClientToAsk) {
  bus_.set_client(kStart, {.restart_after = std::nullopt});
  bus_.set_faults({{{between(0ms, 50ms), DisturbanceFault{20}}}}, outside_);
  bus_.receive(kStart, standard(0x123));
  bus_.advance(kStart + 10s);
  EXPECT_NE(time_of(client_.reports, ErrorState::bus_off), kNever);
  ASSERT_EQ(client_.confirmed.size(), 1U);
  EXPECT_FALSE(client_.confirmed[0].second);
  EXPECT_EQ(client_.confirmed[0].first, time_of(client_.reports, ErrorState::bus_off));
  // Nothing reaches a client that is bus-off, and nobody acknowledges.
  a_.send(kStart + 10s, standard(1));
  bus_.advance(kStart + 11s);
  EXPECT_TRUE(outside_.frames.empty());
  bus_.restart_outside(kStart + 11s);
  bus_.advance(kStart + 12s);
  EXPECT_TRUE(client_.reports.back().second.restarted);
  EXPECT_EQ(outside_.frames.size(), 1U);
  EXPECT_EQ(bus_.outside_controller().state, ErrorState::active);
}

TEST_F(CanOutsideTest, ReopeningABusOffControllerBringsItBackAtOnce) {
  bus_.set_client(kStart, {.restart_after = std::nullopt});
  bus_.set_faults({{{between(0ms, 50ms), DisturbanceFault{20}}}}, outside_);
  bus_.receive(kStart, standard(0x123));
  bus_.advance(kStart + 1s);
  ASSERT_EQ(bus_.outside_controller().state, ErrorState::bus_off);
  bus_.set_client(kStart + 1s, {.present = false});
  bus_.set_client(kStart + 1s, {});
  EXPECT_EQ(client_.reports.back().second.state, ErrorState::active);
  bus_.receive(kStart + 1s, standard(0x124));
  bus_.advance(kStart + 2s);
  EXPECT_TRUE(client_.confirmed.back().second);
}

TEST_F(CanOutsideTest, OtherBitRateThatOnlyListensHasNoEffect) {
  (void)bus_.add_node(outside_);
  bus_.set_client(kStart, {.bit_rate_bps = 500'000, .listen_only = true});
  a_.send(kStart, standard(1));
  bus_.advance(kStart + 10ms);
  EXPECT_EQ(bus_.counters(a_).sent, 1U);
  EXPECT_TRUE(outside_.frames.empty());  // The client read nothing of it.
}

TEST_F(CanOutsideTest, TwoBitRatesAloneDeliverNothingEitherWay) {
  bus_.set_client(kStart, {.bit_rate_bps = 500'000});
  Listener device;
  bus_.attach(a_, device);
  for (int i = 0; i < 50; ++i) {
    bus_.advance(kStart + i * 10ms);
    a_.send(kStart + i * 10ms, standard(1));
    bus_.receive(kStart + i * 10ms, standard(2));
  }
  bus_.advance(kStart + 1s);
  EXPECT_TRUE(outside_.frames.empty());
  EXPECT_TRUE(device.heard.empty());
  EXPECT_EQ(bus_.counters(a_).sent, 0U);
  EXPECT_EQ(bus_.outside_counters().sent, 0U);
  EXPECT_GT(bus_.counters(a_).bus_offs, 0U);
  EXPECT_GT(bus_.outside_counters().bus_offs, 0U);
  EXPECT_TRUE(conserved(bus_.counters(a_)));
}

}  // namespace
}  // namespace rigwire::emulators
