// What the transport sends, as its partner grants it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "transport_rig.h"

namespace rigwire::emulators {
namespace {

TEST_F(J1939TransportTest, BroadcastKeepsFiftyMillisecondsBetweenPackets) {
  ASSERT_TRUE(send_to(j1939::kGlobalAddress, 20));
  EXPECT_FALSE(send_to(j1939::kGlobalAddress, 20));
  run(1s);
  ASSERT_EQ(frames.size(), 4U);
  EXPECT_THAT(frames[0].second.payload(), ElementsAre(32, 20, 0, 3, 0xFF, 0xCA, 0xFE, 0));
  for (std::size_t i = 1; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].first, kStart + 50ms * i);
    EXPECT_EQ(frames[i].second.data[0], i);
  }
  EXPECT_EQ(transport.counters().sent, 1U);
  EXPECT_EQ(transport.next_event(), kNever);
}

TEST_F(J1939TransportTest, SendsInThePortionsThatAreGranted) {
  ASSERT_TRUE(send_to(kPeer, 30));  // 5 packets
  EXPECT_THAT(frames.back().second.payload(), ElementsAre(16, 30, 0, 5, 0xFF, 0xCA, 0xFE, 0));
  run(100ms);
  clear(2, 1);
  run(100ms);
  EXPECT_THAT(numbers(), ElementsAre(1, 2));
  clear(0, 0xFF);  // hold
  run(1s);
  EXPECT_THAT(numbers(), IsEmpty());
  clear(200, 3);  // more than there are
  run(100ms);
  EXPECT_THAT(numbers(), ElementsAre(3, 4, 5));
  TransportManagement end;
  end.control = TransportControl::end_of_message;
  end.size = 30;
  end.packets = 5;
  EXPECT_EQ(manage(end), J1939Reception::accepted);
  EXPECT_EQ(transport.counters().sent, 1U);
  EXPECT_FALSE(transport.is_sending(kPeer));
}

TEST_F(J1939TransportTest, NoGrantIsATimeoutAfterT3) {
  ASSERT_TRUE(send_to(kPeer, 9));
  frames.clear();
  run(1249ms);
  EXPECT_TRUE(frames.empty());
  run(1ms);
  expect_abort(AbortReason::timeout);
  EXPECT_EQ(transport.counters().abandoned, 1U);
}

TEST_F(J1939TransportTest, AHoldIsATimeoutAfterT4) {
  ASSERT_TRUE(send_to(kPeer, 9));
  run(10ms);
  clear(0, 0xFF);
  frames.clear();
  run(1049ms);
  EXPECT_TRUE(frames.empty());
  run(1ms);
  expect_abort(AbortReason::timeout);
}

TEST_F(J1939TransportTest, NoEndOfMessageIsATimeoutAfterT3) {
  ASSERT_TRUE(send_to(kPeer, 9));
  clear(2, 1);
  run(20ms);
  EXPECT_THAT(numbers(), ElementsAre(1, 2));
  run(1250ms);
  expect_abort(AbortReason::timeout);
}

TEST_F(J1939TransportTest, ClearWhileSendingAborts) {
  ASSERT_TRUE(send_to(kPeer, 100));
  clear(10, 1);
  run(20ms);
  frames.clear();
  clear(10, 1);
  expect_abort(AbortReason::clear_while_sending);
}

TEST_F(J1939TransportTest, PacketsAreSentAgainTwiceAtMost) {
  ASSERT_TRUE(send_to(kPeer, 21));
  for (int round = 0; round < 3; ++round) {
    frames.clear();
    clear(3, 1);
    run(100ms);
    EXPECT_THAT(numbers(), ElementsAre(1, 2, 3)) << round;
  }
  clear(3, 1);
  expect_abort(AbortReason::too_many_repetitions);
}

TEST_F(J1939TransportTest, GrantOfPacketsThatCannotBeAborts) {
  for (const std::uint8_t next :
       {std::uint8_t{0}, std::uint8_t{2}, std::uint8_t{4}, std::uint8_t{255}}) {
    ASSERT_TRUE(send_to(kPeer, 21));
    frames.clear();
    clear(1, next);
    expect_abort(AbortReason::bad_sequence);
  }
}

TEST_F(J1939TransportTest, AbortFromThePeerEndsTheSessionSilently) {
  ASSERT_TRUE(send_to(kPeer, 21));
  frames.clear();
  EXPECT_EQ(manage({}), J1939Reception::accepted);
  run(5s);
  EXPECT_TRUE(frames.empty());
  EXPECT_FALSE(transport.is_sending(kPeer));
}

TEST_F(J1939TransportTest, ASessionForEachOfFourDestinationsAndOneBroadcast) {
  for (std::uint8_t to = 1; to <= J1939Transport::kAddressedSending; ++to) {
    EXPECT_TRUE(send_to(to, 100));
    EXPECT_FALSE(send_to(to, 100));
  }
  EXPECT_FALSE(send_to(0x50, 100));
  EXPECT_TRUE(send_to(j1939::kGlobalAddress, 100));
  EXPECT_FALSE(send_to(0x50, 8));
  EXPECT_FALSE(send_to(0x50, 1786));
}

TEST(J1939TransportSettings, NamesWhatItRefuses) {
  const auto message_of = [](const J1939TransportSettings& settings) {
    try {
      validate(settings);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message_of({}), "");
  J1939TransportSettings settings;
  settings.broadcast_gap = 49ms;
  EXPECT_NE(message_of(settings).find("broadcast_gap is 0.049"), std::string::npos);
  settings = {};
  settings.packets_per_portion = 0;
  EXPECT_NE(message_of(settings).find("packets_per_portion is 0"), std::string::npos);
}

}  // namespace
}  // namespace rigwire::emulators
