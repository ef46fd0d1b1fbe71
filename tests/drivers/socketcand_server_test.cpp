#include "drivers/socketcand_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "memory_stream_server.h"
#include "run_until.h"

namespace rigwire::drivers {
namespace {

using namespace std::chrono_literals;
using protocols::can::ControllerReport;
using protocols::can::Frame;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const Frame kFrame{0x123, false, false, 2, {0x1A, 0x22}};

class SocketcandTest : public ::testing::Test {
 protected:
  void start(SocketcandSettings settings = {}) {
    settings.buses = {"can", "vcan0"};
    daemon_ = std::make_unique<SocketcandServer>(context_, tcp_, settings);
    daemon_->on_client([this](const CanClient& client) { clients_.push_back(client); });
    daemon_->start([this](const Frame& frame) { on_bus_.push_back(frame); });
  }
  StreamServer::ConnectionId connect() { return tcp_.client_connect(); }
  void tell(StreamServer::ConnectionId client, std::string_view text) {
    tcp_.client_send(client, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }
  std::string take(StreamServer::ConnectionId client) {
    const auto bytes = tcp_.client_take(client);
    return {bytes.begin(), bytes.end()};
  }
  std::string ask(StreamServer::ConnectionId client, std::string_view text) {
    tell(client, text);
    return take(client);
  }
  /// A client in raw mode that has read everything.
  StreamServer::ConnectionId raw_client() {
    const auto client = connect();
    EXPECT_EQ(ask(client, "< open can >< rawmode >"), "< hi >< ok >< ok >");
    EXPECT_EQ(ask(client, "< echo >"), "< echo >");
    return client;
  }
  StreamServer::ConnectionId bcm_client() {
    const auto client = connect();
    EXPECT_EQ(ask(client, "< open can >"), "< hi >< ok >");
    return client;
  }

  boost::asio::io_context context_;
  MemoryStreamServer tcp_;
  std::unique_ptr<SocketcandServer> daemon_;
  std::vector<Frame> on_bus_;
  std::vector<CanClient> clients_;
};

TEST_F(SocketcandTest, GreetsOpensAndSwitchesModes) {
  start();
  const auto client = connect();
  EXPECT_EQ(take(client), "< hi >");
  EXPECT_EQ(ask(client, "< open vcan0 >"), "< ok >");
  EXPECT_EQ(ask(client, "< rawmode >"), "< ok >");
  EXPECT_EQ(ask(client, "< rawmode >"), "< error unknown command >") << "it is in it";
  EXPECT_EQ(ask(client, "< bcmmode >"), "< ok >");
  EXPECT_EQ(ask(client, "< controlmode >"), "< ok >");
  EXPECT_EQ(ask(client, "< isotpmode >"), "< error unknown command >");
  EXPECT_EQ(ask(client, "< send 123 0 >"), "< error unknown command >") << "not in control mode";
}

TEST_F(SocketcandTest, WithoutABusEverythingElseEndsTheConnection) {
  start();
  for (const std::string_view text : {"< open can1 >", "< rawmode >", "< echo >", "< open >"}) {
    const auto client = connect();
    EXPECT_EQ(ask(client, text), "< hi >< error could not open bus >") << text;
    EXPECT_FALSE(tcp_.open(client));
  }
  EXPECT_TRUE(clients_.empty());
}

TEST_F(SocketcandTest, CommandsMayBeCutAnywhere) {
  start();
  const auto client = connect();
  for (const char c : std::string("< open can >< rawmode >< send 12")) {
    tell(client, {&c, 1});
  }
  EXPECT_EQ(take(client), "< hi >< ok >< ok >");
  tell(client, "3 2 1a 22 >");
  EXPECT_EQ(on_bus_, std::vector<Frame>{kFrame});
}

TEST_F(SocketcandTest, ARawClientHearsTheBusAndOtherClientsButNotItself) {
  start();
  const auto one = raw_client();
  const auto other = raw_client();
  EXPECT_TRUE(daemon_->deliver(kFrame, 1500ms));
  EXPECT_EQ(take(one), "< frame 123 1.500000 1A22 >");
  EXPECT_EQ(take(other), "< frame 123 1.500000 1A22 >");
  tell(one, "< send 18EAFFFE 3 0 ee 0 >");
  ASSERT_EQ(on_bus_.size(), 1U);
  EXPECT_EQ(on_bus_[0], (Frame{0x18EAFFFE, true, false, 3, {0x00, 0xEE, 0x00}}));
  EXPECT_EQ(take(other), "") << "not before it was on the bus";
  daemon_->confirm(true, 1600ms);
  EXPECT_EQ(take(one), "");
  EXPECT_EQ(take(other), "< frame 18EAFFFE 1.600000 00EE00 >");
}

TEST_F(SocketcandTest, AFrameThatNeverWentOutIsHeardByNobody) {
  start();
  const auto one = raw_client();
  const auto other = raw_client();
  tell(one, "< send 123 0 >");
  daemon_->confirm(false, 1ms);
  EXPECT_EQ(take(other), "");
}

TEST_F(SocketcandTest, StampsCountFrom1970) {
  start({.epoch = 1'780'000'000s});
  const auto client = raw_client();
  daemon_->deliver(kFrame, 2ms);
  EXPECT_EQ(take(client), "< frame 123 1780000000.002000 1A22 >");
}

// python-can takes "< ok >" and a frame that came with it for one thing that is not "< ok >".
TEST_F(SocketcandTest, FramesWaitUntilTheClientHasReadThatItIsInRawMode) {
  start();
  const auto client = connect();
  tell(client, "< open can >< rawmode >");
  daemon_->deliver(kFrame, 1ms);
  EXPECT_EQ(take(client), "< hi >< ok >< ok >");
  std::string heard;
  EXPECT_TRUE(run_until(context_, [&] { return !(heard += take(client)).empty(); }));
  EXPECT_EQ(heard, "< frame 123 0.001000 1A22 >") << "and are not lost";
  daemon_->deliver(kFrame, 2ms);
  EXPECT_EQ(take(client), "< frame 123 0.002000 1A22 >");

  const auto quick = connect();
  tell(quick, "< open can >< rawmode >");
  daemon_->deliver(kFrame, 3ms);
  take(quick);
  EXPECT_EQ(ask(quick, "< send 123 0 >"), "< frame 123 0.003000 1A22 >") << "who sends has read it";
}

TEST_F(SocketcandTest, RemoteRequestsAreSentAndNotPassedOn) {
  start();
  const auto client = raw_client();
  tell(client, "< send 40000123 2 0 0 >");
  ASSERT_EQ(on_bus_.size(), 1U);
  EXPECT_TRUE(on_bus_[0].remote);
  daemon_->deliver({0x123, false, true, 4, {}}, 1ms);
  EXPECT_EQ(take(client), "");
}

TEST_F(SocketcandTest, ErrorsArePassedOnByTheirMask) {
  ControllerReport passive;
  passive.state = protocols::can::ErrorState::passive;
  passive.state_changed = true;
  passive.transmit_errors = 128;
  start();
  const auto deaf = raw_client();
  daemon_->report(passive, 1s);
  EXPECT_EQ(take(deaf), "");
  tcp_.client_close(deaf);
  daemon_.reset();
  start({.error_mask = 0x4});
  const auto client = raw_client();
  daemon_->report(passive, 1s);
  EXPECT_THAT(take(client), StartsWith("< error 204 1.000000"));
}

TEST_F(SocketcandTest, TheControllerIsOpenWhileSomebodyHasTheBus) {
  start();
  const auto idle = connect();
  EXPECT_FALSE(daemon_->status().client_present);
  const auto one = bcm_client();
  const auto other = bcm_client();
  tcp_.client_close(one);
  EXPECT_EQ(clients_, std::vector<CanClient>{CanClient{.open = true}});
  EXPECT_TRUE(daemon_->status().client_present);
  tcp_.client_close(other);
  EXPECT_EQ(clients_.size(), 2U);
  EXPECT_FALSE(clients_.back().open);
  EXPECT_TRUE(tcp_.open(idle));
}

TEST_F(SocketcandTest, WhatAClientSentBeforeItLeftStillGoesOut) {
  start();
  const auto client = raw_client();
  tell(client, "< send 123 0 >");
  tcp_.client_close(client);
  EXPECT_TRUE(clients_.back().open);
  daemon_->confirm(true, 1ms);
  EXPECT_FALSE(clients_.back().open);
}

TEST_F(SocketcandTest, FramesBeyondTheBussQueueWaitAndBeyondThatEndTheConnection) {
  start({.transmit_queue_frames = 2, .waiting_frames = 3});
  const auto client = raw_client();
  for (int i = 0; i < 5; ++i) {
    tell(client, "< send " + std::to_string(100 + i) + " 0 >");
  }
  EXPECT_EQ(on_bus_.size(), 2U);
  EXPECT_TRUE(tcp_.open(client));
  daemon_->confirm(true, 1ms);
  ASSERT_EQ(on_bus_.size(), 3U);
  EXPECT_EQ(on_bus_[2].id, 0x102U);
  tell(client, "< send 105 0 >< send 106 0 >");
  EXPECT_FALSE(tcp_.open(client));
  for (int i = 0; i < 5; ++i) {
    daemon_->confirm(true, 2ms);
  }
  EXPECT_EQ(on_bus_.size(), 6U) << "what was taken goes out";
}

TEST_F(SocketcandTest, AnEndlessElementEndsTheConnection) {
  start();
  const auto client = bcm_client();
  tell(client, "<" + std::string(protocols::socketcand::kLongestElement + 1, 'x'));
  EXPECT_FALSE(tcp_.open(client));
}

TEST_F(SocketcandTest, ACommandWithoutSenseIsNotAnswered) {
  start();
  const auto client = raw_client();
  EXPECT_EQ(ask(client, "< send 123 9 >"), "");
  EXPECT_TRUE(on_bus_.empty());
  EXPECT_TRUE(tcp_.open(client));
}

// ---- The broadcast manager.

TEST_F(SocketcandTest, AJobSendsAtOnceAndThenAgainAndAgainUntilItIsDeleted) {
  start();
  const auto client = bcm_client();
  tell(client, "< add 0 5000 123 1 11 >");
  EXPECT_EQ(on_bus_.size(), 1U);
  EXPECT_TRUE(run_until(context_, [&] {
    daemon_->confirm(true, 1ms);
    return on_bus_.size() >= 4;
  }));
  tell(client, "< update 123 2 33 44 >");
  const std::size_t before = on_bus_.size();
  EXPECT_TRUE(run_until(context_, [&] {
    daemon_->confirm(true, 1ms);
    return on_bus_.size() > before;
  }));
  EXPECT_EQ(on_bus_.back(), (Frame{0x123, false, false, 2, {0x33, 0x44}}));
  tell(client, "< delete 123 >");
  const std::size_t last = on_bus_.size();
  run_for(context_, 30ms);
  EXPECT_EQ(on_bus_.size(), last);
}

TEST_F(SocketcandTest, JobsEndWithTheModeAndWithTheClient) {
  start();
  const auto client = bcm_client();
  tell(client, "< add 0 1000 123 0 >< rawmode >");
  const auto other = bcm_client();
  tell(other, "< add 0 1000 124 0 >");
  tcp_.client_close(other);
  const std::size_t last = on_bus_.size();
  run_for(context_, 20ms);
  EXPECT_EQ(on_bus_.size(), last);
}

TEST_F(SocketcandTest, ASubscriptionPassesOneIdentifierOn) {
  start();
  const auto client = bcm_client();
  daemon_->deliver(kFrame, 1ms);
  EXPECT_EQ(take(client), "") << "nothing without one";
  tell(client, "< subscribe 0 0 123 >");
  daemon_->deliver(kFrame, 2ms);
  daemon_->deliver({0x124, false, false, 0, {}}, 2ms);
  daemon_->deliver({0x123, true, false, 0, {}}, 2ms);
  EXPECT_EQ(take(client), "< frame 123 0.002000 1A 22  >");
  tell(client, "< unsubscribe 123 >");
  daemon_->deliver(kFrame, 3ms);
  EXPECT_EQ(take(client), "");
}

TEST_F(SocketcandTest, AFilterPassesChangesOfTheMaskedContentOn) {
  start();
  const auto client = bcm_client();
  tell(client, "< filter 0 0 123 1 F0 >");
  const auto heard = [&](std::uint8_t first, std::uint8_t second) {
    daemon_->deliver({0x123, false, false, 2, {first, second}}, 1ms);
    return !take(client).empty();
  };
  EXPECT_TRUE(heard(0x11, 0)) << "the first one";
  EXPECT_FALSE(heard(0x12, 5)) << "nothing that matters";
  EXPECT_TRUE(heard(0x22, 5));
}

TEST_F(SocketcandTest, AMultiplexedFilterKnowsTheContentsApart) {
  start();
  const auto client = bcm_client();
  tell(client,
       "< muxfilter 0 0 123 3 FF 00 00 00 00 00 00 00 33 FF 00 00 00 00 00 00 "
       "44 00 FF 00 00 00 00 00 >");
  const auto heard = [&](std::uint8_t which, std::uint8_t second, std::uint8_t third) {
    daemon_->deliver({0x123, false, false, 3, {which, second, third}}, 1ms);
    return !take(client).empty();
  };
  EXPECT_TRUE(heard(0x33, 1, 1));
  EXPECT_TRUE(heard(0x44, 1, 1));
  EXPECT_FALSE(heard(0x33, 1, 2));
  EXPECT_TRUE(heard(0x33, 2, 2));
  EXPECT_FALSE(heard(0x44, 2, 1));
  EXPECT_TRUE(heard(0x44, 2, 2));
  EXPECT_FALSE(heard(0x55, 9, 9)) << "not asked for";
}

TEST_F(SocketcandTest, AnIntervalHoldsFramesBackAndPassesTheNewestOn) {
  start();
  const auto client = bcm_client();
  tell(client, "< subscribe 0 20000 123 >");
  for (int i = 0; i < 5; ++i) {
    daemon_->deliver({0x123, false, false, 1, {static_cast<std::uint8_t>(i)}}, 1ms);
  }
  EXPECT_THAT(take(client), HasSubstr("00  >"));
  std::string later;
  EXPECT_TRUE(run_until(context_, [&] { return !(later += take(client)).empty(); }));
  EXPECT_EQ(later, "< frame 123 0.001000 04  >");
}

TEST_F(SocketcandTest, StatisticsComeEveryIntervalInControlMode) {
  start();
  const auto sender = raw_client();
  tell(sender, "< send 123 3 1 2 3 >");
  daemon_->confirm(true, 1ms);
  daemon_->deliver(kFrame, 1ms);
  const auto client = bcm_client();
  EXPECT_EQ(ask(client, "< controlmode >< statistics 10 >"), "< ok >");
  std::string heard;
  EXPECT_TRUE(run_until(context_, [&] { return !(heard += take(client)).empty(); }));
  EXPECT_EQ(heard, "< stat 2 1 3 1 >");
  tell(client, "< statistics 0 >");
  take(client);
  run_for(context_, 30ms);
  EXPECT_EQ(take(client), "");
}

TEST_F(SocketcandTest, ABusNeedsAName) {
  EXPECT_THROW(SocketcandServer(context_, tcp_, {.buses = {}}), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::drivers
