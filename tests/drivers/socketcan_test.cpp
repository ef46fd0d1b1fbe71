#include "drivers/socketcan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

namespace rigwire::drivers {
namespace {

using protocols::can::Frame;
using testing::HasSubstr;
constexpr const char* kInterface = "vcan0";

TEST(SocketCan, MissingInterfaceNamesTheMend) {
  boost::asio::io_context context;
  try {
    SocketCanBus bus(context, "nocan7");
    FAIL() << "opened an interface that cannot exist";
  } catch (const EndpointError& error) {
    EXPECT_THAT(error.what(), HasSubstr("nocan7"));
    EXPECT_THAT(error.what(),
                HasSubstr("ip link add dev nocan7 type vcan && ip link set nocan7 up"));
  }
}

TEST(SocketCan, NameThatCannotBeAnInterfaceIsRefused) {
  boost::asio::io_context context;
  EXPECT_THROW(SocketCanBus(context, ""), EndpointError);
  EXPECT_THROW(SocketCanBus(context, std::string(64, 'x')), EndpointError);
}

TEST(SocketCan, AvailabilityOfAnInterfaceNeedsTheKernelToo) {
  EXPECT_FALSE(socketcan_available("nocan7"));
  if (!socketcan_available()) {
    EXPECT_FALSE(socketcan_available("lo"));
  }
}

/// Needs a kernel with CAN and vcan0 up; tests/kernel runs it where the host has none.
class OnVcan : public testing::Test {
 protected:
  void SetUp() override {
    if (!socketcan_available(kInterface)) {
      GTEST_SKIP() << "no " << kInterface << " here; tests/kernel runs this in a virtual machine";
    }
  }
  void run_until(const std::vector<Frame>& heard, std::size_t count) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(5);
    while (heard.size() < count && std::chrono::steady_clock::now() < end) {
      context_.run_for(std::chrono::milliseconds(10));
      context_.restart();
    }
  }
  boost::asio::io_context context_;
};

TEST_F(OnVcan, FramesOfEveryShapePass) {
  SocketCanBus sender(context_, kInterface);
  SocketCanBus receiver(context_, kInterface);
  std::vector<Frame> heard;
  receiver.start([&heard](const Frame& frame) { heard.push_back(frame); });
  const std::vector<Frame> frames = {{0x0CF02980, true, false, 8, {1, 2, 3, 4, 5, 6, 7, 8}},
                                     {0x123, false, false, 0, {}},
                                     {0x7FF, false, true, 4, {}},
                                     {0x1FFFFFFF, true, true, 0, {}}};
  for (const Frame& frame : frames) {
    EXPECT_TRUE(sender.send(frame));
  }
  run_until(heard, frames.size());
  EXPECT_EQ(heard, frames);
  EXPECT_TRUE(receiver.status().client_present);
  EXPECT_FALSE(sender.status().client_present);
}

}  // namespace
}  // namespace rigwire::drivers
