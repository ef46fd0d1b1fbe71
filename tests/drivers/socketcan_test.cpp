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

TEST_F(OnVcan, NewsOfTheControllerArriveAsErrorFrames) {
  SocketCanBus device(context_, kInterface);
  SocketCanBus field(context_, kInterface);
  std::vector<Frame> heard;
  std::vector<protocols::can::ControllerReport> reports;
  field.on_report([&](const auto& report) { reports.push_back(report); });
  field.start([&heard](const Frame& frame) { heard.push_back(frame); });
  protocols::can::ControllerReport passive;
  passive.state = protocols::can::ErrorState::passive;
  passive.state_changed = true;
  passive.transmit_errors = 128;
  passive.receive_errors = 5;
  EXPECT_TRUE(device.report(passive, {}));
  EXPECT_TRUE(device.send({0x123, false, false, 0, {}}));
  run_until(heard, 1);
  EXPECT_EQ(heard.size(), 1U) << "an error frame is no frame";
  EXPECT_THAT(reports, testing::ElementsAre(passive));
  EXPECT_EQ(field.counters().error_frames, 1U);
}

TEST_F(OnVcan, ReaderThatIsTooSlowLearnsWhatItMissed) {
  SocketCanBus sender(context_, kInterface);
  SocketCanBus receiver(context_, kInterface);
  std::vector<Frame> heard;
  receiver.start([&heard](const Frame& frame) { heard.push_back(frame); });
  constexpr std::uint64_t kFrames = 20'000;
  for (std::uint64_t i = 0; i < kFrames; ++i) {
    EXPECT_TRUE(sender.send({0x123, false, false, 0, {}}));  // vcan refuses nothing
  }
  run_until(heard, 1);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  // The kernel tells the losses with the next frame that fits.
  while (heard.size() + receiver.counters().dropped < kFrames + 1 &&
         std::chrono::steady_clock::now() < end) {
    EXPECT_TRUE(sender.send({0x124, false, false, 0, {}}));
    run_until(heard, heard.size() + 1);
  }
  EXPECT_GT(receiver.counters().dropped, 0U);
  EXPECT_GE(heard.size() + receiver.counters().dropped, kFrames);
}

}  // namespace
}  // namespace rigwire::drivers
