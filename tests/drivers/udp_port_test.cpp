// One contract for ports that answer whoever asks: the same tests over UDP on loopback and over the
// in-memory twin; and what only the system's port can do.
#include "drivers/udp_port.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "memory_datagram_port.h"
#include "run_until.h"

namespace rigwire::drivers {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Peer = DatagramPort::Peer;
using ::testing::HasSubstr;

constexpr std::uint32_t kFirst = 0x7F00'0102;   // 127.0.1.2
constexpr std::uint32_t kSecond = 0x7F00'0103;  // 127.0.1.3
constexpr std::uint32_t kClient = 0x7F00'0001;
constexpr std::uint32_t kEverybody = 0xFFFF'FFFF;
constexpr std::uint32_t kEverybodyHere = 0x7FFF'FFFF;

struct Loopback {
  explicit Loopback(boost::asio::io_context& the_context) : context(the_context) {
    // A number that was free a moment ago.
    number = UdpPort(context, {.address = kFirst}).local_port();
  }
  std::unique_ptr<DatagramPort> open(std::uint32_t address, std::uint16_t port, bool broadcasts) {
    auto made = std::make_unique<UdpPort>(
        context, UdpPortSettings{.address = address, .port = port, .broadcasts = broadcasts});
    ports.push_back({made.get(), {address, made->local_port()}});
    return made;
  }
  Peer end_of(const DatagramPort& port) {
    return std::ranges::find(ports, &port, &std::pair<const DatagramPort*, Peer>::first)->second;
  }
  boost::asio::io_context& context;
  std::uint16_t number = 0;
  std::vector<std::pair<const DatagramPort*, Peer>> ports;
};

struct Memory {
  explicit Memory(boost::asio::io_context& context) : network(context) {}
  std::unique_ptr<DatagramPort> open(std::uint32_t address, std::uint16_t port, bool broadcasts) {
    return network.open(address, port, broadcasts);
  }
  Peer end_of(const DatagramPort& port) { return MemoryDatagramNetwork::end_of(port); }
  MemoryDatagramNetwork network;
  std::uint16_t number = 3956;
};

struct Heard {
  Peer from;
  Bytes bytes;
  friend bool operator==(const Heard&, const Heard&) = default;
};

template <class Network>
class DatagramPortContract : public ::testing::Test {
 protected:
  static DatagramPort::Receiver into(std::vector<Heard>& heard) {
    return [&heard](const Peer& from, std::span<const std::uint8_t> datagram) {
      heard.push_back({from, {datagram.begin(), datagram.end()}});
    };
  }
  boost::asio::io_context context;
  Network network{context};
};

using Networks = ::testing::Types<Loopback, Memory>;
TYPED_TEST_SUITE(DatagramPortContract, Networks);

TYPED_TEST(DatagramPortContract, AnswersReachWhoAskedAndComeFromThePort) {
  std::vector<Heard> at_client;
  const auto port = this->network.open(kFirst, this->network.number, true);
  port->start([&](const Peer& from, std::span<const std::uint8_t> datagram) {
    EXPECT_TRUE(port->send(from, datagram, false));
  });
  const auto client = this->network.open(kClient, 0, false);
  client->start(this->into(at_client));
  EXPECT_FALSE(port->status().client_present);
  ASSERT_TRUE(client->send({kFirst, this->network.number}, Bytes{1, 2, 3}, false));
  ASSERT_TRUE(client->send({kFirst, this->network.number}, Bytes(1472, 7), true));
  ASSERT_TRUE(run_until(this->context, [&] { return at_client.size() == 2; }));
  const Peer end{kFirst, this->network.number};
  EXPECT_EQ(at_client[0], (Heard{end, {1, 2, 3}}));
  EXPECT_EQ(at_client[1], (Heard{end, Bytes(1472, 7)}));
  EXPECT_TRUE(port->status().client_present);
}

TYPED_TEST(DatagramPortContract, BroadcastsReachEveryPortThatHearsThemAndNoOther) {
  std::vector<Heard> at_first;
  std::vector<Heard> at_second;
  std::vector<Heard> at_deaf;
  const auto first = this->network.open(kFirst, this->network.number, true);
  const auto second = this->network.open(kSecond, this->network.number, true);
  const auto deaf = this->network.open(kSecond + 1, this->network.number, false);
  first->start(this->into(at_first));
  second->start(this->into(at_second));
  deaf->start(this->into(at_deaf));
  const auto client = this->network.open(kClient, 0, false);
  for (const std::uint32_t everybody : {kEverybody, kEverybodyHere}) {
    at_first.clear();
    at_second.clear();
    ASSERT_TRUE(client->send({everybody, this->network.number}, Bytes{9}, false)) << everybody;
    ASSERT_TRUE(run_until(this->context, [&] {
      return at_first.size() == 1 && at_second.size() == 1;
    })) << everybody;
    EXPECT_EQ(at_first[0], (Heard{this->network.end_of(*client), {9}}));
  }
  EXPECT_TRUE(at_deaf.empty());
}

TYPED_TEST(DatagramPortContract, PortThatIsOpenIsTaken) {
  const auto port = this->network.open(kFirst, this->network.number, true);
  EXPECT_THROW((void)this->network.open(kFirst, this->network.number, true), EndpointError);
  EXPECT_NO_THROW((void)this->network.open(kSecond, this->network.number, true));
}

TYPED_TEST(DatagramPortContract, SendingToNobodyAndThenToSomebodyWorks) {
  std::vector<Heard> heard;
  const auto port = this->network.open(kFirst, this->network.number, false);
  const auto gone = this->network.open(kClient, 0, false);
  const auto client = this->network.open(kClient, 0, false);
  client->start(this->into(heard));
  const Peer nobody{kClient, 9};
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(port->send(nobody, Bytes{1}, false));
    ASSERT_TRUE(port->send(this->network.end_of(*client), Bytes{2}, false));
  }
  EXPECT_TRUE(run_until(this->context, [&] { return heard.size() == 20; }));
}

TEST(UdpPort, RefusalNamesTheAddressAndTheMend) {
  boost::asio::io_context context;
  const UdpPort port(context, {.address = kFirst});
  const auto refusal = [&](const UdpPortSettings& settings) -> std::string {
    try {
      const UdpPort second(context, settings);
    } catch (const EndpointError& error) {
      return error.what();
    }
    return "accepted";
  };
  const std::string taken = refusal({.address = kFirst, .port = port.local_port()});
  EXPECT_THAT(taken, HasSubstr("127.0.1.2:" + std::to_string(port.local_port())));
  EXPECT_THAT(taken, HasSubstr("another address"));
  EXPECT_THAT(refusal({.address = 0xC633'6401, .port = 3956}), HasSubstr("198.51.100.1:3956"));
}

TEST(UdpPort, PacketThatMustNotBeFragmentedIsNotLongerThanThePath) {
  boost::asio::io_context context;
  UdpPort port(context, {.address = kFirst});
  const UdpPort client(context, {.address = kClient});
  const Peer to{kClient, client.local_port()};
  // Loopback carries 65536 bytes in one piece, with the headers of IP and UDP.
  EXPECT_TRUE(port.send(to, Bytes(16356 - 28), true));
  EXPECT_TRUE(port.send(to, Bytes(65507), false));
  EXPECT_FALSE(port.send(to, Bytes(65508), true));
}

}  // namespace
}  // namespace rigwire::drivers
