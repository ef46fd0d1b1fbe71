// What every node does, with an application that has one short and one long group.
#include "emulators/j1939/j1939_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "emulators/can/can_bus.h"
#include "emulators/device.h"
#include "recorder.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using protocols::can::Frame;
using testing::ElementsAre;
using testing::IsEmpty;
namespace j1939 = protocols::j1939;

constexpr std::uint8_t kNodeAddress = 0x20;
constexpr std::uint8_t kPeerAddress = 0xF9;
constexpr std::uint32_t kShortGroup = 0xFE10;
constexpr std::uint32_t kLongGroup = 0xFEDA;
constexpr std::uint64_t kName = 0x1000;

/// A device with its node.
struct Unit : J1939Application, CanDevice {
  [[nodiscard]] std::vector<protocols::can::OwnedMessage> messages(
      std::string_view /*name*/) const override {
    return {};
  }
  Unit(const J1939NodeSettings& settings, FrameOutput& output) : node(settings, *this, output) {}

  J1939Answer answer(SimTime now, std::uint32_t pgn, std::uint8_t destination) override {
    if (pgn == kShortGroup) {
      node.send(now, {6, pgn, destination, 0}, std::array<std::uint8_t, 8>{1, 2, 3});
      return J1939Answer::sent;
    }
    if (pgn == kLongGroup) {
      const bool sent = node.send(now, {6, pgn, destination, 0}, std::array<std::uint8_t, 20>{7});
      return sent ? J1939Answer::sent : J1939Answer::busy;
    }
    return J1939Answer::unknown;
  }
  J1939Reception take(SimTime, const J1939Message& message) override {
    taken.emplace_back(message.identifier,
                       std::vector(message.payload.begin(), message.payload.end()));
    return J1939Reception::accepted;
  }
  void advance(SimTime now) override { node.advance(now); }
  [[nodiscard]] SimTime next_event() const override { return node.next_event(); }
  [[nodiscard]] SamplePlan sample_plan() const override { return {kNever, 1s}; }
  [[nodiscard]] ReceiveCounters received() const override { return node.received(); }
  [[nodiscard]] double nominal_rate_hz() const override { return 0.0; }
  [[nodiscard]] std::span<const Quantity> quantities() const override { return {}; }
  void receive(SimTime now, const Frame& frame) override { node.receive(now, frame); }
  void controller(SimTime now, const protocols::can::ControllerReport& report) override {
    node.controller(now, report);
  }

  J1939Node node;
  std::vector<std::pair<j1939::Identifier, std::vector<std::uint8_t>>> taken;
};

J1939NodeSettings settings(std::uint8_t address = kNodeAddress, std::uint64_t name = kName,
                           bool arbitrary = false) {
  J1939NodeSettings s;
  s.address.preferred = address;
  s.address.name = name;
  s.address.arbitrary_address = arbitrary;
  return s;
}

struct J1939NodeTest : testing::Test {
  void start(const J1939NodeSettings& with = settings()) {
    unit = std::make_unique<Unit>(with, output);
    run(300ms);
    output.frames.clear();
  }
  void run(Duration span) {
    now += span;
    unit->advance(now);
  }
  void give(const Frame& frame) { unit->receive(now, frame); }
  /// By a broadcast of its nine bytes.
  void command(std::uint64_t name, std::uint8_t address) {
    const auto bytes = j1939::encode_commanded_address({name, address});
    j1939::TransportManagement announce;
    announce.control = j1939::TransportControl::broadcast;
    announce.size = bytes.size();
    announce.packets = 2;
    announce.pgn = j1939::kCommandedAddressPgn;
    give(j1939::make_transport_management(kPeerAddress, j1939::kGlobalAddress, announce));
    give(j1939::make_transport_data(kPeerAddress, j1939::kGlobalAddress, bytes, 1));
    give(j1939::make_transport_data(kPeerAddress, j1939::kGlobalAddress, bytes, 2));
  }
  [[nodiscard]] std::vector<std::uint32_t> sent() const {
    std::vector<std::uint32_t> ids;
    for (const auto& [due, frame] : output.frames) {
      ids.push_back(frame.id);
    }
    return ids;
  }

  test::FrameRecorder output;
  std::unique_ptr<Unit> unit;
  SimTime now = kStart;
};

TEST_F(J1939NodeTest, AnswersWhatItHasAndRefusesWhatItHasNot) {
  start();
  give(j1939::make_request(kPeerAddress, kNodeAddress, kShortGroup));
  give(j1939::make_request(kPeerAddress, j1939::kGlobalAddress, kShortGroup));
  give(j1939::make_request(kPeerAddress, kNodeAddress, 0xFE11));
  give(j1939::make_request(kPeerAddress, j1939::kGlobalAddress, 0xFE11));
  give(j1939::make_request(kPeerAddress, 0x21, kShortGroup));
  EXPECT_THAT(sent(), ElementsAre(0x18FE1020U, 0x18FE1020U, 0x18E8FF20U));
  const auto refusal = j1939::decode_acknowledgement(output.frames.back().second);
  ASSERT_TRUE(refusal.ok());
  EXPECT_EQ(*refusal,
            (j1939::Acknowledgement{j1939::Acknowledge::negative, 0xFF, kPeerAddress, 0xFE11}));
}

TEST_F(J1939NodeTest, LongAnswerGoesToTheRequesterOrToEverybody) {
  start();
  give(j1939::make_request(kPeerAddress, kNodeAddress, kLongGroup));
  give(j1939::make_request(kPeerAddress, j1939::kGlobalAddress, kLongGroup));
  EXPECT_THAT(sent(), ElementsAre(0x1CECF920U, 0x1CECFF20U));
  EXPECT_EQ(output.frames[0].second.data[0], 16);
  EXPECT_EQ(output.frames[1].second.data[0], 32);
}

TEST_F(J1939NodeTest, AskedAgainWhileItAnswersItIsBusy) {
  start();
  give(j1939::make_request(kPeerAddress, kNodeAddress, kLongGroup));
  give(j1939::make_request(kPeerAddress, kNodeAddress, kLongGroup));
  const auto busy = j1939::decode_acknowledgement(output.frames.back().second);
  ASSERT_TRUE(busy.ok());
  EXPECT_EQ(busy->control, j1939::Acknowledge::busy);
}

TEST_F(J1939NodeTest, MessagesOfOneFrameAndOfManyReachTheApplication) {
  start();
  give(j1939::make_frame({6, 0xEF00, kNodeAddress, kPeerAddress},
                         std::array<std::uint8_t, 3>{1, 2, 3}));
  give(j1939::make_frame({6, 0xEF00, 0x21, kPeerAddress}, std::array<std::uint8_t, 3>{1, 2, 3}));
  const std::array<std::uint8_t, 12> bytes{9, 8, 7};
  j1939::TransportManagement request;
  request.control = j1939::TransportControl::request_to_send;
  request.size = bytes.size();
  request.packets = 2;
  request.pgn = 0xEF00;
  give(j1939::make_transport_management(kPeerAddress, kNodeAddress, request));
  give(j1939::make_transport_data(kPeerAddress, kNodeAddress, bytes, 1));
  give(j1939::make_transport_data(kPeerAddress, kNodeAddress, bytes, 2));
  ASSERT_EQ(unit->taken.size(), 2U);
  EXPECT_THAT(unit->taken[0].second, ElementsAre(1, 2, 3));
  EXPECT_EQ(unit->taken[1].second, std::vector(bytes.begin(), bytes.end()));
  EXPECT_EQ(unit->taken[1].first.destination, kNodeAddress);
  const ReceiveCounters counters = unit->received();
  EXPECT_EQ(counters.accepted, 4U);
  EXPECT_EQ(counters.ignored, 1U);
}

TEST_F(J1939NodeTest, CommandedAddressMovesTheNodeThatIsMeant) {
  start();
  command(kName + 1, 0x90);
  EXPECT_EQ(unit->node.address(), kNodeAddress);
  command(kName, 0x90);
  EXPECT_EQ(unit->node.address(), 0x90);
  EXPECT_FALSE(unit->node.held());  // silent first, as 0x90 is no assigned address
  run(250ms);
  EXPECT_TRUE(unit->node.held());
  EXPECT_THAT(sent(), ElementsAre(0x18EEFF90U));
  command(kName, 254);
  command(kName, 255);
  EXPECT_EQ(unit->node.address(), 0x90);
}

TEST_F(J1939NodeTest, CommandedAddressRevivesANodeThatLostItsOwn) {
  start();
  give(j1939::make_address_claim(kNodeAddress, 1));
  EXPECT_FALSE(unit->node.held());
  command(kName, 0x22);
  EXPECT_TRUE(unit->node.held());
  EXPECT_EQ(unit->node.address(), 0x22);
  EXPECT_THAT(sent(), ElementsAre(0x18EEFF22U));  // "cannot claim" is no longer true
}

TEST_F(J1939NodeTest, ANodeThatIsNotCommandableStays) {
  J1939NodeSettings fixed = settings();
  fixed.takes_commanded_address = false;
  start(fixed);
  command(kName, 0x22);
  EXPECT_EQ(unit->node.address(), kNodeAddress);
  EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(J1939NodeTest, SessionsEndWithTheAddress) {
  start();
  give(j1939::make_request(kPeerAddress, kNodeAddress, kLongGroup));
  give(j1939::make_address_claim(kNodeAddress, 1));
  output.frames.clear();
  run(5s);
  EXPECT_THAT(sent(), ElementsAre(0x18EEFFFEU));  // "cannot claim" alone
  EXPECT_EQ(unit->node.transport_counters().abandoned, 1U);
}

TEST_F(J1939NodeTest, SecondNodeWithTheSameNameEndsInSilenceNotInAStorm) {
  start(settings(kNodeAddress, kName, true));
  give(j1939::make_address_claim(kNodeAddress, kName));
  EXPECT_FALSE(unit->node.held());
  run(1s);
  EXPECT_THAT(sent(), ElementsAre(0x18EEFFFEU));
}

TEST_F(J1939NodeTest, RepeatedClaimsOfOthersChangeNothing) {
  start();
  for (int i = 0; i < 1000; ++i) {
    give(j1939::make_address_claim(0x21, kName + 7));
  }
  EXPECT_THAT(sent(), IsEmpty());
  EXPECT_TRUE(unit->node.held());
}

TEST_F(J1939NodeTest, StormOfLowerNamesIsAnsweredOncePerLossAndEnds) {
  start(settings(kNodeAddress, kName, true));
  // Whoever it is takes each address that the node moves to.
  unsigned losses = 0;
  for (std::uint64_t name = 1; unit->node.address() != j1939::kNullAddress; ++name, ++losses) {
    give(j1939::make_address_claim(unit->node.address(), name));
    ASSERT_LE(losses, 256U);
  }
  EXPECT_EQ(losses, 1U + (247U - 128U + 1U));
  run(1s);
  EXPECT_EQ(output.frames.size(), losses);  // a claim for each move, "cannot claim" at last
  EXPECT_EQ(output.frames.back().second.id, 0x18EEFFFEU);
}

TEST_F(J1939NodeTest, LateJoinerHearsTheClaimThatIsThere) {
  start();
  give(j1939::make_request(j1939::kNullAddress, j1939::kGlobalAddress, j1939::kAddressClaimedPgn));
  EXPECT_THAT(sent(), ElementsAre(0x18EEFF20U));
  give(j1939::make_address_claim(kNodeAddress, kName + 1));
  EXPECT_EQ(output.frames.size(), 2U);  // and is told again
  EXPECT_TRUE(unit->node.held());
}

TEST(J1939Nodes, ManyOfOneKindShareABus) {
  NullFrameOutput outside;
  CanBusModel bus(CanBusSettings{});
  std::vector<std::unique_ptr<Unit>> units;
  for (std::uint64_t i = 0; i < 8; ++i) {  // all want the same address at once
    FrameOutput& output = bus.add_node(outside);
    units.push_back(std::make_unique<Unit>(settings(kNodeAddress, kName + i, true), output));
    bus.attach(output, *units.back());
  }
  for (SimTime now = kStart; now < kStart + 3s; now += 100us) {
    for (const auto& unit : units) {
      unit->advance(now);
    }
    bus.advance(now);
  }
  std::vector<std::uint8_t> addresses;
  for (const auto& unit : units) {
    EXPECT_TRUE(unit->node.held());
    addresses.push_back(unit->node.address());
  }
  EXPECT_EQ(addresses[0], kNodeAddress);
  std::ranges::sort(addresses);
  EXPECT_EQ(std::ranges::adjacent_find(addresses), addresses.end());
}

TEST(J1939Nodes, LongMessageCrossesTheBusBothWaysAtOnce) {
  NullFrameOutput outside;
  CanBusModel bus(CanBusSettings{});
  FrameOutput& first_output = bus.add_node(outside);
  FrameOutput& second_output = bus.add_node(outside);
  Unit first(settings(0x01, 1), first_output);
  Unit second(settings(0x02, 2), second_output);
  bus.attach(first_output, first);
  bus.attach(second_output, second);
  std::array<std::uint8_t, 1785> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::uint8_t>(i * 7);
  }
  const auto run = [&](SimTime from, SimTime to) {
    for (SimTime now = from; now < to; now += 500us) {
      first.advance(now);
      second.advance(now);
      bus.advance(now);
    }
  };
  run(kStart, kStart + 10ms);
  ASSERT_TRUE(first.node.send(kStart + 10ms, {6, 0xEF00, 0x02, 0}, bytes));
  ASSERT_TRUE(second.node.send(kStart + 10ms, {6, 0xEF00, 0x01, 0}, bytes));
  ASSERT_TRUE(second.node.send(kStart + 10ms, {6, 0xFF00, j1939::kGlobalAddress, 0}, bytes));
  run(kStart + 10ms, kStart + 14s);  // 255 packets, 50 ms apart
  ASSERT_EQ(second.taken.size(), 1U);
  ASSERT_EQ(first.taken.size(), 2U);
  const std::vector<std::uint8_t> expected(bytes.begin(), bytes.end());
  EXPECT_EQ(second.taken[0].second, expected);
  EXPECT_EQ(first.taken[0].second, expected);
  EXPECT_EQ(first.taken[1].second, expected);
}

}  // namespace
}  // namespace rigwire::emulators
