#include "drivers/udp_socket.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "run_until.h"

namespace rigwire::drivers {
namespace {

using ::testing::HasSubstr;

class UdpSocketTest : public ::testing::Test {
 protected:
  std::string refusal(const UdpSettings& settings) {
    try {
      const UdpSocket socket(context, settings);
    } catch (const EndpointError& error) {
      return error.what();
    }
    return "no EndpointError";
  }
  boost::asio::io_context context;
};

TEST_F(UdpSocketTest, RefusesAPortThatIsTakenAndNamesIt) {
  const UdpSocket holder(context, {.bind = UdpEndpoint{}});
  const std::string name = "127.0.0.1:" + std::to_string(holder.local_port());
  EXPECT_THAT(refusal({.bind = UdpEndpoint{.port = holder.local_port()}}),
              HasSubstr("cannot bind " + name + ": Address already in use"));
}

TEST_F(UdpSocketTest, RefusesWhatIsNoAddress) {
  EXPECT_THAT(refusal({.destination = UdpEndpoint{"localhost", 2368}}),
              HasSubstr("udp localhost:2368: the destination is not an IPv4 address"));
  EXPECT_THAT(refusal({.bind = UdpEndpoint{"127.0.0.1.5", 1}}), HasSubstr("not an IPv4 address"));
  EXPECT_THAT(refusal({.destination = UdpEndpoint{"127.0.0.1", 0}}), HasSubstr("port is 0"));
  EXPECT_THAT(refusal({}), HasSubstr("neither a destination nor"));
}

TEST_F(UdpSocketTest, RefusesAnAddressOfAnotherMachine) {
  EXPECT_THAT(refusal({.bind = UdpEndpoint{"192.0.2.1", 2368}}), HasSubstr("cannot bind"));
}

TEST_F(UdpSocketTest, BroadcastMustBeAskedFor) {
  EXPECT_THAT(refusal({.destination = UdpEndpoint{"255.255.255.255", 2368}}),
              HasSubstr("must be asked for"));
}

TEST_F(UdpSocketTest, SendsFromThePortThatItIsBoundTo) {
  UdpSocket listener(context, {.bind = UdpEndpoint{}});
  UdpSocket sender(
      context, {.destination = UdpEndpoint{.port = listener.local_port()}, .bind = UdpEndpoint{}});
  UdpSocket answerer(context, {.destination = UdpEndpoint{.port = sender.local_port()}});
  bool answered = false;
  sender.start([&](std::span<const std::uint8_t>) { answered = true; });
  // Connected: what comes from anybody but the destination is not for this socket.
  const std::vector<std::uint8_t> datagram{1};
  answerer.send(datagram);
  run_for(context, std::chrono::milliseconds(30));
  EXPECT_FALSE(answered);
}

}  // namespace
}  // namespace rigwire::drivers
