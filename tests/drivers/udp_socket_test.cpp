#include "drivers/udp_socket.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstring>
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

TEST_F(UdpSocketTest, SendersOfOneMachineShareASourcePortWhereBothAgree) {
  UdpSocket first(context, {.bind = UdpEndpoint{}, .shares_source = true});
  const UdpEndpoint same{.port = first.local_port()};
  const UdpSocket second(context, {.bind = same, .shares_source = true});
  EXPECT_EQ(second.local_port(), first.local_port());
  EXPECT_THAT(refusal({.bind = same}), HasSubstr("Address already in use"));
}

TEST_F(UdpSocketTest, HeaderHasTheTimeToLiveOfTheSettings) {
  const int receiver = ::socket(AF_INET, SOCK_DGRAM, 0);
  const int on = 1;
  ASSERT_EQ(::setsockopt(receiver, IPPROTO_IP, IP_RECVTTL, &on, sizeof(on)), 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  ASSERT_EQ(::bind(receiver, reinterpret_cast<sockaddr*>(&address), size), 0);
  ASSERT_EQ(::getsockname(receiver, reinterpret_cast<sockaddr*>(&address), &size), 0);
  for (const std::uint8_t wanted : {std::uint8_t{128}, std::uint8_t{255}}) {
    UdpSocket sender(context, {.destination = UdpEndpoint{.port = ntohs(address.sin_port)},
                               .time_to_live = wanted,
                               .dont_fragment = true});
    ASSERT_TRUE(sender.send(std::vector<std::uint8_t>{1, 2, 3}));
    std::array<char, 16> bytes{};
    alignas(cmsghdr) std::array<char, 64> control{};
    iovec piece{bytes.data(), bytes.size()};
    msghdr message{};
    message.msg_iov = &piece;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    ASSERT_EQ(::recvmsg(receiver, &message, 0), 3);
    const cmsghdr* head = CMSG_FIRSTHDR(&message);
    ASSERT_NE(head, nullptr);
    int found = 0;
    std::memcpy(&found, CMSG_DATA(head), sizeof(found));
    EXPECT_EQ(found, wanted);
  }
  ::close(receiver);
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

class UdpRetargetTest : public UdpSocketTest {
 protected:
  /// What a listener has heard, and from which port it came.
  struct Listener {
    explicit Listener(boost::asio::io_context& context, const std::string& address = "127.0.0.1")
        : socket(context, {.bind = UdpEndpoint{.address = address}}) {
      socket.start([this](std::span<const std::uint8_t> bytes) { heard.push_back(bytes[0]); });
    }
    UdpSocket socket;
    std::vector<int> heard;
  };
  void send(UdpSocket& sender, std::uint8_t value) {
    EXPECT_TRUE(sender.send(std::vector<std::uint8_t>{value}));
  }
  [[nodiscard]] bool wait(const std::function<bool()>& done) { return run_until(context, done); }
};

TEST_F(UdpRetargetTest, DatagramsGoToTheNewDestination) {
  Listener first(context);
  Listener second(context, "127.0.0.2");
  UdpSocket sender(context, {.destination = UdpEndpoint{.port = first.socket.local_port()}});
  send(sender, 1);
  EXPECT_EQ(sender.retarget({"127.0.0.2", second.socket.local_port()}), std::nullopt);
  send(sender, 2);
  EXPECT_TRUE(wait([&] { return first.heard.size() + second.heard.size() == 2; }));
  EXPECT_EQ(first.heard, std::vector<int>{1});
  EXPECT_EQ(second.heard, std::vector<int>{2});
  EXPECT_THAT(sender.status().address, HasSubstr("udp 127.0.0.2:"));
}

TEST_F(UdpRetargetTest, SourceAddressAndPortStay) {
  Listener first(context);
  Listener second(context);
  UdpSocket sender(context, {.destination = UdpEndpoint{.port = first.socket.local_port()},
                             .bind = UdpEndpoint{"127.0.0.5", 0}});
  const std::uint16_t port = sender.local_port();
  EXPECT_EQ(sender.retarget({"127.0.0.1", second.socket.local_port()}), std::nullopt);
  EXPECT_EQ(sender.local_port(), port);
  // A socket that only listens to that source hears it.
  UdpSocket picky(context, {.destination = UdpEndpoint{"127.0.0.5", port}, .bind = UdpEndpoint{}});
  int heard = 0;
  picky.start([&](std::span<const std::uint8_t>) { ++heard; });
  EXPECT_EQ(sender.retarget({"127.0.0.1", picky.local_port()}), std::nullopt);
  send(sender, 3);
  EXPECT_TRUE(wait([&] { return heard == 1; }));
}

TEST_F(UdpRetargetTest, SourcePortFollowsTheDestinationsWhereItIsAsked) {
  Listener first(context);
  Listener second(context);
  UdpSettings settings{.destination = UdpEndpoint{.port = first.socket.local_port()},
                       .bind = UdpEndpoint{"127.0.0.5", 0}};
  settings.source_port_follows = true;
  UdpSocket sender(context, settings);
  EXPECT_EQ(sender.local_port(), first.socket.local_port());
  EXPECT_EQ(sender.retarget({"127.0.0.1", second.socket.local_port()}), std::nullopt);
  EXPECT_EQ(sender.local_port(), second.socket.local_port());
  send(sender, 4);
  EXPECT_TRUE(wait([&] { return second.heard.size() == 1; }));
  EXPECT_EQ(sender.retarget({"127.0.0.2", second.socket.local_port()}), std::nullopt);
  EXPECT_EQ(sender.local_port(), second.socket.local_port());
}

TEST_F(UdpRetargetTest, OldDestinationStaysWhenTheNewOneIsRefused) {
  Listener first(context);
  UdpSocket sender(context, {.destination = UdpEndpoint{.port = first.socket.local_port()},
                             .bind = UdpEndpoint{}});
  EXPECT_THAT(sender.retarget({"127.0.0.1", 0}).value_or(""), HasSubstr("port is 0"));
  EXPECT_THAT(sender.retarget({"nowhere", 1}).value_or(""), HasSubstr("not an IPv4 address"));
  EXPECT_THAT(sender.retarget({"255.255.255.255", 1}).value_or(""), HasSubstr("asked for"));
  send(sender, 5);
  EXPECT_TRUE(wait([&] { return first.heard == std::vector<int>{5}; }));
}

TEST_F(UdpRetargetTest, LoopbackHasABroadcastAddressToo) {
  Listener everyone(context, "0.0.0.0");
  UdpSettings settings{.destination = UdpEndpoint{"127.255.255.255", everyone.socket.local_port()}};
  settings.broadcast = true;
  UdpSocket sender(context, settings);
  send(sender, 6);
  EXPECT_TRUE(wait([&] { return everyone.heard == std::vector<int>{6}; }));
}

TEST_F(UdpRetargetTest, ReceiverThatNeverReadsStallsNobody) {
  UdpSettings deaf{.bind = UdpEndpoint{}};
  deaf.receive_buffer_bytes = 4096;
  UdpSocket listener(context, deaf);  // never started
  UdpSocket sender(context, {.destination = UdpEndpoint{.port = listener.local_port()}});
  const std::vector<std::uint8_t> packet(1206);
  for (int i = 0; i < 5000; ++i) {
    ASSERT_TRUE(sender.send(packet));
  }
}

}  // namespace
}  // namespace rigwire::drivers
