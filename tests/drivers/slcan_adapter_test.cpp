#include "drivers/slcan_adapter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/slcan_client.h"
#include "fake_line.h"

namespace rigwire::drivers {
namespace {

using protocols::can::Frame;
using testing::ElementsAre;

const Frame kSlope{0x0CF02980, true, false, 8, {0, 0, 0x7D, 0, 0, 0x7D, 0xCC, 0}};
constexpr const char* kSlopeLine = "T0CF02980800007D00007DCC00\r";

class Adapter : public testing::Test {
 protected:
  void SetUp() override {
    adapter_.on_client([this](const CanClient& client) { clients_.push_back(client); });
    adapter_.start([this](const Frame& frame) { received_.push_back(frame); });
  }
  std::string ask(std::string_view text) {
    line_.feed(text);
    return line_.take();
  }
  FakeLine line_;
  SlcanAdapter adapter_{line_, 250'000};
  std::vector<Frame> received_;
  std::vector<CanClient> clients_;
};

TEST_F(Adapter, KernelOpensAndClosesIt) {
  EXPECT_TRUE(adapter_.send(kSlope));
  EXPECT_EQ(ask("C\rS5\r"), "\r\r");
  EXPECT_EQ(ask("O\r"), "\r");
  EXPECT_TRUE(adapter_.status().client_present);
  EXPECT_TRUE(adapter_.send(kSlope));
  EXPECT_EQ(line_.take(), kSlopeLine);
  EXPECT_EQ(ask("C\r"), "\r");
  EXPECT_TRUE(adapter_.send(kSlope));
  EXPECT_EQ(line_.take(), "");
}

TEST_F(Adapter, PythonCanBurstWithTwoOpensStaysOpen) {
  EXPECT_EQ(ask("C\rS5\rO\rO\r"), "\r\r\r\r");
  EXPECT_EQ(ask("T18EAFFFE300EE00\r"), "\r");
  ASSERT_EQ(received_.size(), 1U);
  EXPECT_EQ(received_[0], (Frame{0x18EAFFFE, true, false, 3, {0x00, 0xEE, 0x00}}));
}

TEST_F(Adapter, FramesBeforeOpenAreRefused) {
  EXPECT_EQ(ask("t12320102\r"), "\a");
  EXPECT_TRUE(received_.empty());
}

TEST_F(Adapter, ListenOnlyHearsButDoesNotSpeak) {
  EXPECT_EQ(ask("L\rt12320102\r"), "\r\a");
  EXPECT_TRUE(adapter_.send(kSlope));
  EXPECT_TRUE(received_.empty());
}

TEST_F(Adapter, AnswersItsInformation) {
  EXPECT_EQ(ask("V\r"), "V1013\r");
  EXPECT_EQ(ask("v\r"), "v1014\r");
  EXPECT_EQ(ask("N\r").front(), 'N');
  EXPECT_EQ(ask("F\r"), "\a");
  EXPECT_EQ(ask("O\rF\r"), "\rF00\r");
}

TEST_F(Adapter, WhatItCannotHonourIsBell) {
  EXPECT_EQ(ask("s0000\r"), "\a");  // 2.67 Mbit/s
  EXPECT_EQ(ask("P\r"), "\a");
  EXPECT_EQ(ask("Q\r"), "\a");
  EXPECT_EQ(ask("Y2\r"), "\a");  // python-can asks for CAN FD's data rate
  EXPECT_EQ(ask("d12320102\r"), "\a");
  EXPECT_EQ(ask("O\rS5\rs011C\rM00000000\r"), "\r\a\a\a");
  EXPECT_EQ(adapter_.counters().refused_commands, 8U);
}

TEST_F(Adapter, TimeStampsAreMillisecondsOfTheMinute) {
  ask("Z1\rO\r");
  adapter_.deliver({0x123, false, false, 1, {0xAB}}, std::chrono::microseconds(61'234'999));
  EXPECT_EQ(line_.take(), "t1231AB04D2\r");  // 1234
  ask("Z0\r");
  adapter_.send({0x123, false, false, 1, {0xAB}});
  EXPECT_EQ(line_.take(), "t1231AB\r");
}

TEST_F(Adapter, AutoPollAnswersWithTheFrameType) {
  EXPECT_EQ(ask("X1\rO\rt1230\rT000001230\r"), "\r\rz\rZ\r");
}

TEST_F(Adapter, TellsWhatTheClientMakesOfItsController) {
  ask("O\rO\rC\rC\rS5\rO\rC\rL\rC\rS6\rO\rC\rs011C\rO\rC\rS9\rO\r");
  const CanClient closed;
  EXPECT_THAT(clients_, ElementsAre(CanClient{true, 0, false, false}, closed,  // the bus's own
                                    CanClient{true, 0, false, false}, closed,  // S5 is the bus's
                                    CanClient{true, 0, true, false}, closed,
                                    CanClient{true, 500'000, false, false}, closed,
                                    CanClient{true, 0, false, false}, closed,  // 250 kbit/s
                                    CanClient{true, 83'300, false, false}));
}

TEST_F(Adapter, ClientAtAnotherRateIsHandedNothingAndItsFramesAreTheBussAffair) {
  ask("S6\rO\r");
  EXPECT_TRUE(adapter_.send(kSlope));
  EXPECT_EQ(line_.take(), "");
  EXPECT_EQ(adapter_.counters().wrong_rate, 1U);
  EXPECT_EQ(ask("t1230\r"), "\r");
  EXPECT_EQ(received_.size(), 1U);
}

TEST_F(Adapter, ClientThatLeavesWithoutClosingLeavesNothingBehind) {
  ask("S6\rZ1\rM00000000\rm00000000\rO\rt12");
  line_.hang_up();
  EXPECT_THAT(clients_.back(), CanClient{});
  EXPECT_TRUE(adapter_.send(kSlope));
  EXPECT_EQ(line_.take(), "");
  EXPECT_EQ(ask("O\r"), "\r");
  EXPECT_TRUE(adapter_.send(kSlope));
  EXPECT_EQ(line_.take(), kSlopeLine);
}

TEST_F(Adapter, LinesArriveInAnyPieces) {
  for (const char c : std::string_view("O\rt1230\r")) {
    line_.feed(std::string_view(&c, 1));
  }
  EXPECT_EQ(received_.size(), 1U);
}

TEST_F(Adapter, FullLineNeverTearsALine) {
  ask("O\r");
  line_.room = 10;
  EXPECT_TRUE(adapter_.send(kSlope));   // ten bytes go, the rest is kept
  EXPECT_FALSE(adapter_.send(kSlope));  // refused whole
  line_.room = 5;
  EXPECT_FALSE(adapter_.send(kSlope));
  line_.room = 1000;
  EXPECT_TRUE(adapter_.send(kSlope));
  EXPECT_EQ(line_.take(), std::string(kSlopeLine) + kSlopeLine);
  EXPECT_EQ(adapter_.counters().backlogged, 2U);
}

TEST_F(Adapter, OneMegabyteLineIsOneBell) {
  EXPECT_EQ(ask("O\r"), "\r");
  EXPECT_EQ(ask(std::string(1'000'000, 'T') + "\r"), "\a");
  EXPECT_EQ(adapter_.counters().too_long_lines, 1U);
  EXPECT_EQ(ask("t1230\r"), "\r");
  EXPECT_EQ(received_.size(), 1U);
}

TEST_F(Adapter, FloodOfCommandsThatReadsNothingStaysBounded) {
  line_.room = 0;
  for (int i = 0; i < 10'000; ++i) {
    line_.feed("V\r");
  }
  line_.room = 1'000'000;
  EXPECT_LE(ask("\r").size(), 4096U);
}

TEST(SlcanAdapterSettings, ImpossibleRatesAreRefused) {
  FakeLine line;
  EXPECT_THROW(SlcanAdapter(line, 4'999), std::invalid_argument);
  EXPECT_THROW(SlcanAdapter(line, 1'000'001), std::invalid_argument);
  EXPECT_THROW(SlcanClient(line, 333'333), std::invalid_argument);
}

TEST(SlcanClient, OpensSendsReceivesAndCloses) {
  FakeLine line;
  {
    SlcanClient client(line, 250'000);
    std::vector<Frame> received;
    client.start([&received](const Frame& frame) { received.push_back(frame); });
    EXPECT_EQ(line.take(), "C\rS5\rO\r");
    EXPECT_FALSE(client.status().client_present);
    line.feed("\r\r\rz\r\a");
    EXPECT_TRUE(client.status().client_present);
    EXPECT_EQ(client.counters().refused, 1U);
    line.feed(kSlopeLine);
    line.feed("t1231AB04D2\r?\r");
    EXPECT_THAT(received, ElementsAre(kSlope, Frame{0x123, false, false, 1, {0xAB}}));
    EXPECT_EQ(client.counters().malformed, 1U);
    EXPECT_TRUE(client.send(kSlope));
    EXPECT_EQ(line.take(), kSlopeLine);
    line.feed("sp007128\re2as\r");
    EXPECT_EQ(client.controller().state, protocols::can::ErrorState::passive);
    EXPECT_EQ(client.controller().receive_errors, 7);
    EXPECT_EQ(client.controller().transmit_errors, 128);
    EXPECT_EQ(client.counters().bus_errors, 1U);
  }
  EXPECT_EQ(line.take(), "C\r");
}

}  // namespace
}  // namespace rigwire::drivers
