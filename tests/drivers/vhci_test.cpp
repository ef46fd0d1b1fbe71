// What needs no kernel module; attaching is tested in tests/kernel/cases.
#include "drivers/vhci.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <optional>
#include <string>

namespace rigwire::drivers {
namespace {

using testing::HasSubstr;

// Status as Linux 6.1 prints it, with one device attached.
constexpr const char* kStatus =
    "hub port sta spd dev      sockfd local_busid\n"
    "hs  0000 006 002 00010001 000003 1-1\n"
    "hs  0001 004 000 00000000 000000 0-0\n"
    "ss  0008 004 000 00000000 000000 0-0\n";

TEST(VhciStatus, TheFirstFreeHighSpeedPort) {
  EXPECT_EQ(free_vhci_port(kStatus), 1U);
}

TEST(VhciStatus, NoFreePort) {
  EXPECT_EQ(free_vhci_port("hub port sta spd dev      sockfd local_busid\n"
                           "hs  0000 006 002 00010001 000003 1-1\n"
                           "ss  0008 004 000 00000000 000000 0-0\n"),
            std::nullopt);
  EXPECT_EQ(free_vhci_port(""), std::nullopt);
  EXPECT_EQ(free_vhci_port("hs\nhs x y\n"), std::nullopt);
}

std::string attach(const std::string& address, std::uint16_t port) {
  boost::asio::io_context io;
  std::optional<std::string> told;
  const VhciAttachment attachment(io, address, port, "1-1",
                                  [&](const std::string& error) { told = error; });
  io.run();
  return told.value_or("nothing was told");
}

TEST(VhciAttachment, SaysWhenNobodyServes) {
  boost::asio::io_context io;
  // A port that is bound and not listened to refuses connections.
  boost::asio::ip::tcp::acceptor nobody(io);
  nobody.open(boost::asio::ip::tcp::v4());
  nobody.bind({boost::asio::ip::address_v4::loopback(), 0});
  EXPECT_THAT(attach("127.0.0.1", nobody.local_endpoint().port()),
              HasSubstr("USB device 1-1 cannot be attached"));
}

TEST(VhciAttachment, TakesNumericAddressesOnly) {
  EXPECT_THAT(attach("localhost", 3240), HasSubstr("no numeric address"));
}

TEST(VhciAttachment, SaysWhenTheServerRefuses) {
  boost::asio::io_context io;
  boost::asio::ip::tcp::acceptor server(io, {boost::asio::ip::address_v4::loopback(), 0});
  std::optional<std::string> told;
  const VhciAttachment attachment(io, "127.0.0.1", server.local_endpoint().port(), "1-1",
                                  [&](const std::string& error) { told = error; });
  boost::asio::ip::tcp::socket peer(io);
  const std::array<std::uint8_t, 8> refusal{0x01, 0x11, 0x00, 0x03, 0, 0, 0, 1};
  std::array<std::uint8_t, 40> request{};
  server.async_accept(peer, [&](const auto& accepted) {
    ASSERT_FALSE(accepted);
    boost::asio::async_read(peer, boost::asio::buffer(request), [&](const auto& read, std::size_t) {
      ASSERT_FALSE(read);
      boost::asio::write(peer, boost::asio::buffer(refusal));
    });
  });
  while (!told && io.run_one() > 0) {
  }
  EXPECT_EQ(request[8], '1');
  ASSERT_TRUE(told.has_value());
  EXPECT_THAT(*told, HasSubstr("does not give it away"));
}

TEST(VhciObstacle, IsEmptyOrHasItsMend) {
  const std::string obstacle = vhci_obstacle();
  if (!obstacle.empty()) {
    EXPECT_THAT(obstacle, HasSubstr("; "));
  }
}

}  // namespace
}  // namespace rigwire::drivers
