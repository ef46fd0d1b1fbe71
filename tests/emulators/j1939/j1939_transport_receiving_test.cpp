// What the transport makes of the packets of others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "transport_rig.h"

namespace rigwire::emulators {
namespace {

TEST_F(J1939TransportTest, ReceivesABroadcast) {
  EXPECT_EQ(announce(16), J1939Reception::accepted);
  for (std::uint8_t number = 1; number <= 3; ++number) {
    run(50ms);
    EXPECT_EQ(data(16, number, kPeer, j1939::kGlobalAddress), J1939Reception::accepted);
  }
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(messages[0].first.pgn, kGroup);
  EXPECT_EQ(messages[0].first.source, kPeer);
  EXPECT_EQ(messages[0].second, message(16));
  EXPECT_TRUE(frames.empty());  // nobody answers a broadcast
  EXPECT_EQ(data(16, 3, kPeer, j1939::kGlobalAddress), J1939Reception::ignored);
}

TEST_F(J1939TransportTest, LongestMessageArrivesInPortions) {
  request(1785);
  for (unsigned number = 1; number <= 255; ++number) {
    if (number % 16 == 1) {
      const auto grants = management();
      ASSERT_EQ(grants.size(), 1U) << number;
      EXPECT_EQ(grants[0].control, TransportControl::clear_to_send);
      EXPECT_EQ(grants[0].next, number);
      EXPECT_EQ(grants[0].packets, std::min(16U, 255U - number + 1U));
    }
    run(10ms);
    data(1785, static_cast<std::uint8_t>(number));
  }
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(messages[0].second, message(1785));
  const auto end = management();
  ASSERT_EQ(end.size(), 1U);
  EXPECT_EQ(end[0].control, TransportControl::end_of_message);
  EXPECT_EQ(end[0].size, 1785);
  EXPECT_EQ(end[0].packets, 255);
}

TEST_F(J1939TransportTest, GrantsNoMoreThanTheSenderCanSendAtOnce) {
  request(100, kPeer, kGroup, 4);
  EXPECT_EQ(management().at(0).packets, 4);
}

TEST_F(J1939TransportTest, PacketThatIsMissingIsAskedForAgain) {
  request(28);
  frames.clear();
  data(28, 1);
  data(28, 3);
  EXPECT_TRUE(frames.empty());
  data(28, 4);
  auto again = management();
  ASSERT_EQ(again.size(), 1U);
  EXPECT_EQ(again[0].control, TransportControl::clear_to_send);
  EXPECT_EQ(again[0].next, 2);
  EXPECT_EQ(again[0].packets, 3);
  for (std::uint8_t number = 2; number <= 4; ++number) {
    data(28, number);
  }
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(messages[0].second, message(28));
}

TEST_F(J1939TransportTest, PacketThatNeverComesEndsInTooManyRepetitions) {
  request(21);
  for (int round = 0; round < 3; ++round) {
    frames.clear();
    data(21, 1);
    data(21, 3);
  }
  expect_abort(AbortReason::too_many_repetitions);
  EXPECT_TRUE(messages.empty());
}

TEST_F(J1939TransportTest, DuplicatesAreLeftOut) {
  request(14);
  data(14, 1);
  data(14, 1);
  data(14, 2);
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(messages[0].second, message(14));
  announce(14);
  data(14, 1, kPeer, j1939::kGlobalAddress);
  data(14, 1, kPeer, j1939::kGlobalAddress);
  data(14, 2, kPeer, j1939::kGlobalAddress);
  EXPECT_EQ(messages.size(), 2U);
}

TEST_F(J1939TransportTest, NumbersThatCannotBeEndTheSession) {
  request(300);
  frames.clear();
  data(300, 17);  // beyond the portion
  expect_abort(AbortReason::bad_sequence);
  request(300);
  frames.clear();
  Frame zero = j1939::make_transport_data(kPeer, kOwn, message(300), 1);
  zero.data[0] = 0;
  give(zero);
  expect_abort(AbortReason::bad_sequence);
}

TEST_F(J1939TransportTest, BroadcastWithAGapIsDroppedSilently) {
  announce(21);
  data(21, 1, kPeer, j1939::kGlobalAddress);
  data(21, 3, kPeer, j1939::kGlobalAddress);
  EXPECT_EQ(data(21, 2, kPeer, j1939::kGlobalAddress), J1939Reception::ignored);
  EXPECT_TRUE(messages.empty());
  EXPECT_TRUE(frames.empty());
  EXPECT_EQ(transport.next_event(), kNever);
}

TEST_F(J1939TransportTest, SessionsThatAreNeverFinishedTimeOut) {
  request(14);
  frames.clear();
  run(1249ms);
  EXPECT_TRUE(frames.empty());
  run(1ms);  // T2: no packet after the grant
  expect_abort(AbortReason::timeout);
  request(14);
  data(14, 1);
  frames.clear();
  run(749ms);
  EXPECT_TRUE(frames.empty());
  run(1ms);  // T1: the next one is missing
  expect_abort(AbortReason::timeout);
  announce(14);
  run(750ms);
  EXPECT_TRUE(frames.empty());
  EXPECT_EQ(data(14, 1, kPeer, j1939::kGlobalAddress), J1939Reception::ignored);
  EXPECT_EQ(transport.counters().abandoned, 3U);
}

TEST_F(J1939TransportTest, RepeatedRequestBeginsAnewAndAnotherGroupIsRefused) {
  request(14);
  data(14, 1);
  frames.clear();
  request(21);
  EXPECT_EQ(management().at(0).control, TransportControl::clear_to_send);
  request(14, kPeer, 0xFEDA);
  const auto refused = management();
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_EQ(refused[0].control, TransportControl::abort);
  EXPECT_EQ(refused[0].reason, AbortReason::busy);
  EXPECT_EQ(refused[0].pgn, 0xFEDAU);
  for (std::uint8_t number = 1; number <= 3; ++number) {
    data(21, number);
  }
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(messages[0].second, message(21));
}

TEST_F(J1939TransportTest, TooLongAndImpossibleSizesAreRefused) {
  TransportManagement m;
  m.control = TransportControl::request_to_send;
  m.size = 1786;
  m.packets = 255;
  manage(m);
  expect_abort(AbortReason::too_long);
  m.size = 8;
  m.packets = 2;
  EXPECT_EQ(manage(m), J1939Reception::malformed);
  m.size = 20;
  EXPECT_EQ(manage(m), J1939Reception::malformed);
  EXPECT_TRUE(frames.empty());
}

TEST_F(J1939TransportTest, ANinthSessionIsRefusedForLackOfMemory) {
  for (std::uint8_t from = 1; from <= J1939Transport::kReceiving; ++from) {
    request(100, from);
  }
  frames.clear();
  request(100, kOther);
  expect_abort(AbortReason::no_resources);
  EXPECT_EQ(announce(100, kOther), J1939Reception::ignored);
  EXPECT_TRUE(frames.empty());
}

TEST_F(J1939TransportTest, InterleavedSessionsDoNotDisturbEachOther) {
  request(30);
  announce(30);  // the same source may broadcast meanwhile
  request(30, kOther);
  announce(30, kOther);
  send_to(kPeer, 30);
  for (std::uint8_t number = 1; number <= 5; ++number) {
    data(30, number);
    data(30, number, kOther, j1939::kGlobalAddress);
    data(30, number, kPeer, j1939::kGlobalAddress);
    data(30, number, kOther);
  }
  ASSERT_EQ(messages.size(), 4U);
  for (const auto& [identifier, bytes] : messages) {
    EXPECT_EQ(bytes, message(30));
  }
  EXPECT_TRUE(transport.is_sending(kPeer));
}

TEST_F(J1939TransportTest, FramesAboutNoSessionDoNothing) {
  EXPECT_EQ(data(14, 1), J1939Reception::ignored);
  EXPECT_EQ(clear(1, 1), J1939Reception::ignored);
  EXPECT_EQ(manage({}), J1939Reception::ignored);
  EXPECT_TRUE(frames.empty());
  // Dialogues with everybody and broadcasts to one are no transport.
  TransportManagement m;
  m.control = TransportControl::request_to_send;
  m.size = 14;
  m.packets = 2;
  EXPECT_EQ(manage(m, kPeer, j1939::kGlobalAddress), J1939Reception::malformed);
  m.control = TransportControl::broadcast;
  EXPECT_EQ(manage(m, kPeer, kOwn), J1939Reception::malformed);
  EXPECT_EQ(request(14, j1939::kNullAddress), J1939Reception::ignored);
  EXPECT_EQ(request(14, kOwn), J1939Reception::ignored);
}

TEST_F(J1939TransportTest, ResetForgetsEverythingWithoutAWord) {
  request(100);
  send_to(kPeer, 100);
  frames.clear();
  transport.reset();
  run(10s);
  EXPECT_TRUE(frames.empty());
  EXPECT_EQ(transport.next_event(), kNever);
  EXPECT_EQ(transport.counters().abandoned, 2U);
}

}  // namespace
}  // namespace rigwire::emulators
