#include "drivers/tcp_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "drivers/endpoint_news.h"

namespace rigwire::drivers {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using ::testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

class TcpServerTest : public ::testing::Test {
 protected:
  void open(TcpServerSettings settings = {}) {
    settings.port = 0;
    server_ = std::make_unique<TcpServer>(context_, settings);
    server_->start({[this](auto id) { connected_.push_back(id); },
                    [this](auto id, auto bytes) {
                      received_[id].insert(received_[id].end(), bytes.begin(), bytes.end());
                    },
                    [this](auto id) { disconnected_.push_back(id); }});
  }
  tcp::socket client() {
    tcp::socket socket(context_);
    socket.connect({asio::ip::address_v4::loopback(), server_->port()});
    return socket;
  }
  /// Runs the context until the condition holds; fails after 5 s.
  [[nodiscard]] bool run_until(const std::function<bool()>& condition) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(5);
    while (!condition()) {
      if (std::chrono::steady_clock::now() > deadline) {
        return false;
      }
      context_.restart();
      context_.run_one_for(std::chrono::milliseconds(20));
    }
    return true;
  }
  static std::string message_of(const std::function<void()>& open) {
    try {
      open();
    } catch (const EndpointError& error) {
      return error.what();
    }
    return "opened";
  }

  asio::io_context context_;
  std::unique_ptr<TcpServer> server_;
  std::vector<StreamServer::ConnectionId> connected_;
  std::vector<StreamServer::ConnectionId> disconnected_;
  std::map<StreamServer::ConnectionId, Bytes> received_;
};

TEST_F(TcpServerTest, CarriesBytesBothWays) {
  open();
  EXPECT_FALSE(server_->status().client_present);
  auto socket = client();
  asio::write(socket, asio::buffer("abc", 3));
  ASSERT_TRUE(run_until([&] { return received_[1].size() == 3; }));
  EXPECT_TRUE(server_->status().client_present);
  EXPECT_TRUE(server_->send(1, Bytes{1, 2, 3}));
  Bytes answer(3);
  asio::read(socket, asio::buffer(answer));
  EXPECT_EQ(answer, (Bytes{1, 2, 3}));
  socket.close();
  ASSERT_TRUE(run_until([&] { return !disconnected_.empty(); }));
  EXPECT_FALSE(server_->send(1, Bytes{1}));
  EXPECT_EQ(server_->clients(), 0U);
}

TEST_F(TcpServerTest, ServesThirtyTwoClientsAndGivesTheQuietestPlaceToTheNext) {
  open();
  std::vector<tcp::socket> sockets;
  for (std::size_t i = 0; i < 32; ++i) {
    sockets.push_back(client());
    ASSERT_TRUE(run_until([&] { return connected_.size() == i + 1; }));
  }
  for (std::size_t i = 0; i < 32; ++i) {
    if (i != 4) {  // the fifth stays silent
      asio::write(sockets[i], asio::buffer("x", 1));
    }
  }
  ASSERT_TRUE(run_until([&] { return received_.size() == 31; }));
  sockets.push_back(client());
  ASSERT_TRUE(run_until([&] { return connected_.size() == 33 && !disconnected_.empty(); }));
  EXPECT_THAT(disconnected_, ::testing::ElementsAre(5));
  EXPECT_EQ(server_->clients(), 32U);
}

TEST_F(TcpServerTest, CloseLetsWhatWasSentLeave) {
  open();
  auto socket = client();
  ASSERT_TRUE(run_until([&] { return !connected_.empty(); }));
  EXPECT_TRUE(server_->send(1, Bytes(1000, 7)));
  server_->close(1);
  EXPECT_TRUE(disconnected_.empty()) << "told from within close()";
  Bytes answer(1000);
  asio::read(socket, asio::buffer(answer));
  boost::system::error_code error;
  EXPECT_EQ(socket.read_some(asio::buffer(answer), error), 0U);
  EXPECT_EQ(error, asio::error::eof);
  ASSERT_TRUE(run_until([&] { return disconnected_.size() == 1; }));
}

TEST_F(TcpServerTest, AClientThatClosedItsSendingHalfIsStillGivenWhatIsDue) {
  std::vector<StreamServer::ConnectionId> half_closed;
  open();
  server_->start({[this](auto id) { connected_.push_back(id); }, [](auto, auto) {},
                  [this](auto id) { disconnected_.push_back(id); },
                  [&](auto id) { half_closed.push_back(id); }});
  auto socket = client();
  asio::write(socket, asio::buffer("abc", 3));
  socket.shutdown(tcp::socket::shutdown_send);
  ASSERT_TRUE(run_until([&] { return half_closed.size() == 1; }));
  EXPECT_TRUE(disconnected_.empty());
  EXPECT_TRUE(server_->send(half_closed[0], Bytes{1, 2, 3}));
  server_->close(half_closed[0]);
  Bytes answer(3);
  asio::read(socket, asio::buffer(answer));
  EXPECT_EQ(answer, (Bytes{1, 2, 3}));
  boost::system::error_code error;
  EXPECT_EQ(socket.read_some(asio::buffer(answer), error), 0U);
  EXPECT_EQ(error, asio::error::eof) << "and no reset";
  ASSERT_TRUE(run_until([&] { return disconnected_.size() == 1; }));
}

TEST_F(TcpServerTest, WhoDoesNotAskForHalfClosedClientsEndsThemWhenAllHasLeft) {
  TcpServerSettings settings;
  settings.backlog_bytes = 16U << 20U;
  open(settings);
  auto socket = client();
  ASSERT_TRUE(run_until([&] { return !connected_.empty(); }));
  const Bytes much(8U << 20U, 7);  // more than the system's buffers hold
  ASSERT_TRUE(server_->send(1, much));
  socket.shutdown(tcp::socket::shutdown_send);
  socket.non_blocking(true);
  std::size_t got = 0;
  Bytes block(65536);
  boost::system::error_code error;
  ASSERT_TRUE(run_until([&] {
    while (true) {
      const std::size_t size = socket.read_some(asio::buffer(block), error);
      got += size;
      if (error) {
        return error != asio::error::would_block;
      }
    }
  }));
  EXPECT_EQ(error, asio::error::eof);
  EXPECT_EQ(got, much.size());
  ASSERT_TRUE(run_until([&] { return disconnected_.size() == 1; }));
}

TEST_F(TcpServerTest, AClientThatDoesNotReadIsCutOffWhenItsBacklogIsFull) {
  TcpServerSettings settings;
  settings.backlog_bytes = 4096;
  open(settings);
  auto socket = client();
  ASSERT_TRUE(run_until([&] { return !connected_.empty(); }));
  const Bytes block(1024, 1);
  bool taken = true;
  for (int i = 0; i < 100000 && taken; ++i) {
    taken = server_->send(1, block);
  }
  EXPECT_FALSE(taken);
  ASSERT_TRUE(run_until([&] { return disconnected_.size() == 1; }));
}

TEST_F(TcpServerTest, OfClientsThatAreCutOffTheFirstIsReportedAndAllAreCounted) {
  std::vector<std::string> news;
  endpoint_news(context_).on_news([&](const std::string& text) { news.push_back(text); });
  TcpServerSettings settings;
  settings.backlog_bytes = 4096;
  open(settings);
  const Bytes block(1024, 1);
  std::vector<tcp::socket> sockets;
  for (std::size_t i = 1; i <= 2; ++i) {
    sockets.push_back(client());
    ASSERT_TRUE(run_until([&] { return connected_.size() == i; }));
    while (server_->send(i, block)) {
    }
    ASSERT_TRUE(run_until([&] { return disconnected_.size() == i; }));
  }
  EXPECT_EQ(server_->status().cut_off, 2U);
  ASSERT_EQ(news.size(), 1U);
  EXPECT_THAT(news[0], HasSubstr("tcp 127.0.0.1:" + std::to_string(server_->port())));
  EXPECT_THAT(news[0], HasSubstr("allowed 4096"));
}

TEST_F(TcpServerTest, AClientThatAsksAndNeverReadsIsHeldWhileAnotherIsServed) {
  open();
  std::size_t heard = 0;
  server_->start({[this](auto id) { connected_.push_back(id); },
                  [&](auto id, auto bytes) {
                    heard += id == 1 ? bytes.size() : 0;
                    static_cast<void>(server_->send(id, Bytes(2 * bytes.size(), 7)));
                  },
                  [this](auto id) { disconnected_.push_back(id); }});
  auto flood = client();
  flood.non_blocking(true);
  ASSERT_TRUE(run_until([&] { return connected_.size() == 1; }));
  // Until nothing moves any more: the system's buffers are full, and the server reads nothing.
  constexpr std::size_t kMost = 256U << 20U;
  const Bytes block(65536, 1);
  std::size_t sent = 0;
  for (int still = 0; still < 100 && sent < kMost;) {
    boost::system::error_code error;
    const std::size_t size = flood.write_some(asio::buffer(block), error);
    sent += size;
    context_.restart();
    const std::size_t ran = context_.run_one_for(std::chrono::milliseconds(2));
    still = size == 0 && ran == 0 ? still + 1 : 0;
  }
  EXPECT_LT(sent, kMost);
  EXPECT_TRUE(disconnected_.empty());
  EXPECT_EQ(server_->status().cut_off, 0U);

  auto other = client();
  ASSERT_TRUE(run_until([&] { return connected_.size() == 2; }));
  asio::write(other, asio::buffer("abc", 3));
  other.non_blocking(true);
  std::size_t answered = 0;
  Bytes answer(65536);
  ASSERT_TRUE(run_until([&] {
    boost::system::error_code error;
    answered += other.read_some(asio::buffer(answer), error);
    return answered == 6;
  }));

  // It is heard again when it reads.
  const std::size_t heard_before = heard;
  ASSERT_TRUE(run_until([&] {
    boost::system::error_code error;
    static_cast<void>(flood.read_some(asio::buffer(answer), error));
    return heard > heard_before;
  }));
}

TEST_F(TcpServerTest, ABacklogIsDeliveredWhenTheClientReadsAgain) {
  TcpServerSettings settings;
  settings.backlog_bytes = 16U << 20U;
  open(settings);
  auto socket = client();
  socket.non_blocking(true);
  ASSERT_TRUE(run_until([&] { return !connected_.empty(); }));
  Bytes sent(8U << 20U);
  for (std::size_t i = 0; i < sent.size(); ++i) {
    sent[i] = static_cast<std::uint8_t>(i * 31 >> 4U);
  }
  for (std::size_t i = 0; i < sent.size(); i += 65536) {
    ASSERT_TRUE(server_->send(1, std::span(sent).subspan(i, 65536)));
  }
  Bytes got(sent.size());
  std::size_t had = 0;
  ASSERT_TRUE(run_until([&] {
    boost::system::error_code error;
    had += socket.read_some(asio::buffer(got.data() + had, got.size() - had), error);
    return had == got.size();
  }));
  EXPECT_EQ(got, sent);
}

TEST_F(TcpServerTest, APortInUseIsNamedWithTheMend) {
  open();
  TcpServerSettings same;
  same.port = server_->port();
  const std::string message = message_of([&] { TcpServer second(context_, same); });
  EXPECT_THAT(message, HasSubstr("tcp 127.0.0.1:" + std::to_string(same.port)));
  EXPECT_THAT(message, HasSubstr("in use"));
  EXPECT_THAT(message, HasSubstr("choose another port"));
}

TEST_F(TcpServerTest, ThePortIsFreeAgainAtOnceAfterTheServerIsGone) {
  open();
  auto socket = client();
  ASSERT_TRUE(run_until([&] { return !connected_.empty(); }));
  TcpServerSettings same;
  same.port = server_->port();
  server_.reset();  // with a client connected
  EXPECT_EQ(message_of([&] { TcpServer second(context_, same); }), "opened");
}

TEST_F(TcpServerTest, AddressesBeyondLoopbackNeedTheOptIn) {
  TcpServerSettings everywhere;
  everywhere.port = 0;
  everywhere.address = "0.0.0.0";
  EXPECT_THAT(message_of([&] { TcpServer server(context_, everywhere); }),
              HasSubstr("allow_remote"));
  everywhere.allow_remote = true;
  EXPECT_EQ(message_of([&] { TcpServer server(context_, everywhere); }), "opened");
}

TEST_F(TcpServerTest, AddressesThatAreNoneOrElsewhereAreNamed) {
  TcpServerSettings settings;
  settings.address = "localhost";
  EXPECT_THAT(message_of([&] { TcpServer server(context_, settings); }), HasSubstr("numeric"));
  settings.address = "192.0.2.1";  // documentation range: nobody has it
  settings.allow_remote = true;
  EXPECT_THAT(message_of([&] { TcpServer server(context_, settings); }), HasSubstr("ip addr"));
}

TEST_F(TcpServerTest, SettingsOutOfRangeAreRefused) {
  TcpServerSettings settings;
  settings.clients_max = 0;
  EXPECT_THROW(TcpServer(context_, settings), std::invalid_argument);
  settings = {};
  settings.backlog_bytes = 10;
  EXPECT_THROW(TcpServer(context_, settings), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::drivers
