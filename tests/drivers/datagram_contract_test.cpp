// One contract for datagrams: the same tests over UDP on loopback and over the in-memory twin.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <vector>

#include "drivers/udp_socket.h"
#include "memory_datagram.h"
#include "run_until.h"

namespace rigwire::drivers {
namespace {

using Bytes = std::vector<std::uint8_t>;

struct LoopbackLink {
  explicit LoopbackLink(boost::asio::io_context& the_context) : context(the_context) {
    // A port that was free a moment ago.
    port = UdpSocket(context, {.bind = UdpEndpoint{}}).local_port();
    sending.emplace(context, UdpSettings{.destination = UdpEndpoint{.port = port}});
  }
  DatagramSocket& sender() { return *sending; }
  std::unique_ptr<DatagramSocket> open_listener() {
    return std::make_unique<UdpSocket>(context, UdpSettings{.bind = UdpEndpoint{.port = port}});
  }
  boost::asio::io_context& context;
  std::uint16_t port = 0;
  std::optional<UdpSocket> sending;
};

struct MemoryLink {
  explicit MemoryLink(boost::asio::io_context& context) : link(context) {}
  DatagramSocket& sender() { return link.sender(); }
  std::unique_ptr<DatagramSocket> open_listener() { return link.open_listener(); }
  MemoryDatagramLink link;
};

template <class Link>
class DatagramContract : public ::testing::Test {
 protected:
  boost::asio::io_context context;
  Link link{context};
  std::vector<Bytes> received;
  DatagramSocket::Receiver sink = [this](std::span<const std::uint8_t> datagram) {
    received.emplace_back(datagram.begin(), datagram.end());
  };
};

using Links = ::testing::Types<LoopbackLink, MemoryLink>;
TYPED_TEST_SUITE(DatagramContract, Links);

TYPED_TEST(DatagramContract, DatagramsArriveWholeAndInOrder) {
  const auto listener = this->link.open_listener();
  listener->start(this->sink);
  std::vector<Bytes> sent;
  for (std::size_t size : {1206U, 512U, 1U, 0U, 1472U}) {
    sent.emplace_back(size, static_cast<std::uint8_t>(size));
    ASSERT_TRUE(this->link.sender().send(sent.back()));
  }
  EXPECT_TRUE(run_until(this->context, [&] { return this->received.size() == sent.size(); }));
  EXPECT_EQ(this->received, sent);
}

TYPED_TEST(DatagramContract, SendingToNobodySucceedsAndSaysSo) {
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(this->link.sender().send(Bytes(1206))) << i;
  }
  EXPECT_FALSE(this->link.sender().status().client_present);
}

TYPED_TEST(DatagramContract, NothingSentMeansNobodyHasListened) {
  const auto listener = this->link.open_listener();
  EXPECT_FALSE(this->link.sender().status().client_present);
}

TYPED_TEST(DatagramContract, ListenerThatLeavesIsNoticedAndOneThatComesIsServed) {
  auto listener = this->link.open_listener();
  listener->start(this->sink);
  this->link.sender().send(Bytes{1});
  ASSERT_TRUE(run_until(this->context, [&] { return this->received.size() == 1; }));
  EXPECT_TRUE(this->link.sender().status().client_present);
  listener.reset();
  this->link.sender().send(Bytes{2});
  EXPECT_FALSE(this->link.sender().status().client_present);
  // The very first datagram after the listener came back arrives.
  listener = this->link.open_listener();
  listener->start(this->sink);
  ASSERT_TRUE(this->link.sender().send(Bytes{3}));
  ASSERT_TRUE(run_until(this->context, [&] { return this->received.size() == 2; }));
  EXPECT_EQ(this->received.back(), Bytes{3});
  EXPECT_TRUE(run_until(this->context, [&] {
    this->link.sender().send(Bytes{4});
    return this->link.sender().status().client_present;
  }));
}

TYPED_TEST(DatagramContract, ListenerThatDoesNotReadLosesTheNewestAndNeverBlocksTheSender) {
  const auto listener = this->link.open_listener();  // start() comes late
  for (std::uint32_t i = 0; i < 20000; ++i) {
    Bytes datagram(1206);
    datagram[0] = static_cast<std::uint8_t>(i >> 8U);
    datagram[1] = static_cast<std::uint8_t>(i);
    ASSERT_TRUE(this->link.sender().send(datagram)) << i;
  }
  listener->start(this->sink);
  ASSERT_TRUE(run_until(this->context, [&] { return this->received.size() > 50; }));
  EXPECT_EQ(this->received.front()[0], 0);
  EXPECT_EQ(this->received.front()[1], 0);
  run_for(this->context, std::chrono::milliseconds(20));
  EXPECT_LT(this->received.size(), 20000U);
}

TYPED_TEST(DatagramContract, PortWithAListenerIsTaken) {
  const auto listener = this->link.open_listener();
  EXPECT_THROW((void)this->link.open_listener(), EndpointError);
}

TYPED_TEST(DatagramContract, ListenerCannotSend) {
  const auto listener = this->link.open_listener();
  EXPECT_FALSE(listener->send(Bytes{1}));
}

}  // namespace
}  // namespace rigwire::drivers
