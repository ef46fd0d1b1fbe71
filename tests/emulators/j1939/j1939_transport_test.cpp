// Sessions of the transport protocol against a peer that is written out frame by frame.
#include "emulators/j1939/j1939_transport.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "protocols/j1939/message.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using protocols::can::Frame;
using testing::ElementsAre;
using testing::IsEmpty;
namespace j1939 = protocols::j1939;
using j1939::AbortReason;
using j1939::TransportControl;
using j1939::TransportManagement;

constexpr std::uint8_t kOwn = 0x27;
constexpr std::uint8_t kPeer = 0x80;
constexpr std::uint8_t kOther = 0x81;
constexpr std::uint32_t kGroup = 0xFECA;

using Bytes = std::vector<std::uint8_t>;

Bytes message(std::size_t size) {
  Bytes bytes(size);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{1});
  return bytes;
}

struct J1939TransportTest : testing::Test, J1939TransportSink, FrameOutput {
  void transported(SimTime, const J1939Message& received) override {
    messages.emplace_back(received.identifier,
                          Bytes(received.payload.begin(), received.payload.end()));
  }
  void send(SimTime due, const Frame& frame) override {
    EXPECT_GE(due, last);
    last = due;
    frames.emplace_back(due, frame);
  }

  J1939Reception give(const Frame& frame) {
    return transport.receive(now, *j1939::identify(frame), frame.payload(), kOwn);
  }
  J1939Reception manage(TransportManagement management, std::uint8_t from = kPeer,
                        std::uint8_t to = kOwn) {
    management.pgn = management.pgn == 0 ? kGroup : management.pgn;
    return give(j1939::make_transport_management(from, to, management));
  }
  J1939Reception request(std::size_t size, std::uint8_t from = kPeer, std::uint32_t pgn = kGroup,
                         std::uint8_t limit = 0xFF) {
    TransportManagement m;
    m.control = TransportControl::request_to_send;
    m.size = static_cast<std::uint16_t>(size);
    m.packets = j1939::packets_of(size);
    m.limit = limit;
    m.pgn = pgn;
    return manage(m, from);
  }
  J1939Reception announce(std::size_t size, std::uint8_t from = kPeer) {
    TransportManagement m;
    m.control = TransportControl::broadcast;
    m.size = static_cast<std::uint16_t>(size);
    m.packets = j1939::packets_of(size);
    return manage(m, from, j1939::kGlobalAddress);
  }
  J1939Reception clear(std::uint8_t packets, std::uint8_t next, std::uint8_t from = kPeer) {
    TransportManagement m;
    m.control = TransportControl::clear_to_send;
    m.packets = packets;
    m.next = next;
    return manage(m, from);
  }
  J1939Reception data(std::size_t size, std::uint8_t number, std::uint8_t from = kPeer,
                      std::uint8_t to = kOwn) {
    return give(j1939::make_transport_data(from, to, message(size), number));
  }
  void run(Duration span) {
    now += span;
    transport.advance(now);
  }
  /// The frames since the last call, as the management or data they are.
  [[nodiscard]] std::vector<TransportManagement> management() {
    std::vector<TransportManagement> found;
    for (const auto& [due, frame] : std::exchange(frames, {})) {
      if (j1939::identify(frame)->pgn == j1939::kTransportManagementPgn) {
        found.push_back(*j1939::decode_transport_management(frame.payload()));
      }
    }
    return found;
  }
  [[nodiscard]] Bytes numbers() {
    Bytes found;
    for (const auto& [due, frame] : std::exchange(frames, {})) {
      if (j1939::identify(frame)->pgn == j1939::kTransportDataPgn) {
        found.push_back(frame.data[0]);
      }
    }
    return found;
  }
  void expect_abort(AbortReason reason) {
    const auto found = management();
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].control, TransportControl::abort);
    EXPECT_EQ(found[0].reason, reason);
    EXPECT_EQ(found[0].pgn, kGroup);
  }
  bool send_to(std::uint8_t destination, std::size_t size) {
    return transport.send(now, {6, kGroup, destination, kOwn}, message(size));
  }

  SimTime now = kStart;
  SimTime last = kStart;
  std::vector<std::pair<SimTime, Frame>> frames;
  std::vector<std::pair<j1939::Identifier, Bytes>> messages;
  J1939Transport transport{J1939TransportSettings{}, *this, *this};
};

// ---- sending

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

// ---- receiving

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
