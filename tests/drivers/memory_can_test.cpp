#include "memory_can.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace rigwire::drivers {
namespace {

using protocols::can::Frame;

TEST(MemoryCan, FramesArriveAtTheOtherEndInOrder) {
  boost::asio::io_context context;
  MemoryCan bus(context);
  std::vector<std::uint32_t> heard;
  bus.field().start([&heard](const Frame& frame) { heard.push_back(frame.id); });
  for (std::uint32_t id = 1; id <= 3; ++id) {
    EXPECT_TRUE(bus.device().send({id, false, false, 0, {}}));
  }
  EXPECT_TRUE(heard.empty());
  context.poll();
  EXPECT_EQ(heard, (std::vector<std::uint32_t>{1, 2, 3}));
  EXPECT_TRUE(bus.device().status().client_present);
  EXPECT_FALSE(bus.field().status().client_present);
}

TEST(MemoryCan, FullQueueRefusesAndRecovers) {
  boost::asio::io_context context;
  MemoryCan bus(context, 2);
  bus.device().start([](const Frame&) {});
  EXPECT_TRUE(bus.field().send({}));
  EXPECT_TRUE(bus.field().send({}));
  EXPECT_FALSE(bus.field().send({}));
  context.poll();
  EXPECT_TRUE(bus.field().send({}));
}

TEST(MemoryCan, FramesOnTheirWayDoNotOutliveTheBus) {
  boost::asio::io_context context;
  {
    MemoryCan bus(context);
    bus.field().start([](const Frame&) { FAIL(); });
    EXPECT_TRUE(bus.device().send({}));
  }
  context.poll();
}

TEST(MemoryCan, ControllerOfTheFieldIsHeardOfOnBothSides) {
  boost::asio::io_context context;
  MemoryCan bus(context);
  std::vector<CanClient> clients;
  std::vector<std::string> heard;
  bus.device().on_client([&](const CanClient& client) { clients.push_back(client); });
  bus.on_confirm([&](bool sent) { heard.emplace_back(sent ? "sent" : "unsent"); });
  bus.on_report([&](const auto&) { heard.emplace_back("report"); });
  bus.field().start([&](const Frame&) { heard.emplace_back("frame"); });
  bus.set_client({true, 500'000, false, false});
  bus.set_client({true, 500'000, false, false});
  bus.device().confirm(true, {});
  EXPECT_TRUE(bus.device().report({}, {}));
  EXPECT_TRUE(bus.device().deliver({}, {}));
  bus.device().confirm(false, {});
  context.poll();
  EXPECT_EQ(clients, (std::vector<CanClient>{{true, 500'000, false, false}}));
  EXPECT_EQ(heard, (std::vector<std::string>{"sent", "report", "frame", "unsent"}));
}

}  // namespace
}  // namespace rigwire::drivers
