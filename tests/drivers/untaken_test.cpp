// What the kernel tells of bytes that nobody has read yet.
#include "drivers/untaken.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>

#include "drivers/descriptor.h"
#include "drivers/pty.h"

namespace rigwire::drivers {
namespace {

TEST(Untaken, ATerminalSaysNothingWaitsOnlyWhenItsClientHasReadAll) {
  boost::asio::io_context io;
  Pty pty(io, {});
  const Descriptor client(::open(pty.slave_name().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
  ASSERT_TRUE(client.open());
  EXPECT_EQ(untaken_bytes(pty.slave_name()), 0U);
  const std::array<std::uint8_t, 300> bytes{};
  std::array<char, 100> read{};
  // Each look right behind the write: what is on its way in the kernel counts.
  for (int i = 0; i < 200; ++i) {
    ASSERT_EQ(pty.write(bytes), bytes.size());
    std::size_t taken = 0;
    while (untaken_bytes(pty.slave_name()).value_or(0) != 0) {
      const ssize_t count = ::read(client.get(), read.data(), read.size());
      taken += static_cast<std::size_t>(std::max<ssize_t>(count, 0));
    }
    ASSERT_EQ(taken, bytes.size()) << "turn " << i;
  }
}

TEST(Untaken, NothingIsSaidOfWhatIsNoTerminal) {
  EXPECT_FALSE(untaken_bytes("/dev/null").has_value());
  EXPECT_FALSE(untaken_bytes("/nowhere/at/all").has_value());
}

TEST(Untaken, APortTellsWhatItsReaderHasNotRead) {
  const Descriptor reader(::socket(AF_INET, SOCK_DGRAM, 0));
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  auto* const address = reinterpret_cast<sockaddr*>(&own);
  ASSERT_EQ(::bind(reader.get(), address, sizeof own), 0);
  socklen_t size = sizeof own;
  ASSERT_EQ(::getsockname(reader.get(), address, &size), 0);
  const IpEnd end{0x7F00'0001, ntohs(own.sin_port)};
  EXPECT_EQ(untaken_datagrams(end), 0U);
  const std::array<char, 1206> packet{};
  const Descriptor sender(::socket(AF_INET, SOCK_DGRAM, 0));
  ASSERT_EQ(::sendto(sender.get(), packet.data(), packet.size(), 0, address, sizeof own), 1206);
  EXPECT_GE(untaken_datagrams(end).value_or(0), packet.size());
  EXPECT_FALSE(untaken_datagrams({0x7F00'0002, end.port}).has_value()) << "another address";
  std::array<char, 2000> read{};
  ASSERT_EQ(::recv(reader.get(), read.data(), read.size(), 0), 1206);
  EXPECT_EQ(untaken_datagrams(end), 0U);
}

TEST(Untaken, ASocketOfIpv6ThatTakesIpv4Tells) {
  if (!Descriptor(::socket(AF_INET6, SOCK_DGRAM, 0)).open()) {
    GTEST_SKIP() << "no IPv6 here";
  }
  const int only = 0;
  for (const bool mapped : {false, true}) {
    const Descriptor socket(::socket(AF_INET6, SOCK_DGRAM, 0));
    (void)::setsockopt(socket.get(), IPPROTO_IPV6, IPV6_V6ONLY, &only, sizeof only);
    sockaddr_in6 own{};
    own.sin6_family = AF_INET6;
    if (mapped) {
      ASSERT_EQ(::inet_pton(AF_INET6, "::ffff:127.0.0.1", &own.sin6_addr), 1);
    }
    auto* const address = reinterpret_cast<sockaddr*>(&own);
    ASSERT_EQ(::bind(socket.get(), address, sizeof own), 0);
    socklen_t size = sizeof own;
    ASSERT_EQ(::getsockname(socket.get(), address, &size), 0);
    const IpEnd end{0x7F00'0001, ntohs(own.sin6_port)};
    EXPECT_EQ(untaken_datagrams(end), 0U);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = own.sin6_port;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const std::array<char, 1206> packet{};
    const Descriptor sender(::socket(AF_INET, SOCK_DGRAM, 0));
    ASSERT_EQ(::sendto(sender.get(), packet.data(), packet.size(), 0,
                       reinterpret_cast<const sockaddr*>(&to), sizeof to),
              1206);
    EXPECT_GE(untaken_datagrams(end).value_or(0), packet.size()) << mapped;
    EXPECT_EQ(untaken_datagrams({0x7F00'0002, end.port}).has_value(), !mapped);
    std::array<char, 2000> read{};
    ASSERT_EQ(::recv(socket.get(), read.data(), read.size(), 0), 1206);
    EXPECT_EQ(untaken_datagrams(end), 0U);
  }
}

}  // namespace
}  // namespace rigwire::drivers
