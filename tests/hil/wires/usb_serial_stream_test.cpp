#include "hil/wires/usb_serial_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "emulators/usb/cdc_acm.h"
#include "emulators/usb/usb_port.h"

namespace rigwire::hil {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Bytes = std::vector<std::uint8_t>;

/// A bus whose only client is the test.
class UsbSerialStreamOneSocket final : public UsbBus, public emulators::UsbHost {
 public:
  Socket plug(emulators::UsbDevice& device, std::string_view name) override {
    named = name;
    port = std::make_unique<emulators::UsbPort>(device);
    return 1;
  }
  FaultBook<PlugFault>::Id begin(Socket, const PlugFault&) override { return 0; }
  bool end(Socket, FaultBook<PlugFault>::Id, SimTime) override { return false; }
  FaultBook<emulators::SupplyFault>::Id begin(Socket, const emulators::SupplyFault&) override {
    return 0;
  }
  bool end_outage(Socket, FaultBook<emulators::SupplyFault>::Id, SimTime) override { return false; }
  bool imported(Socket /*socket*/) const override { return port->attached(); }
  std::string address(Socket /*socket*/) const override { return "usb test 1-1"; }
  SimTime now() const override { return kStart; }

  void complete(SimTime /*now*/, emulators::UsbTransfer /*transfer*/,
                protocols::usb::Outcome /*outcome*/, std::span<const std::uint8_t> data,
                std::size_t /*taken*/) override {
    answered.insert(answered.end(), data.begin(), data.end());
  }

  /// A client opens the line.
  void open() {
    port->attach(kStart, *this);
    port->control(kStart, ++number, {0x00, 9, 1, 0, 0}, {});
    set_lines(3);
  }
  void set_lines(std::uint16_t state) {
    port->control(kStart, ++number, {0x21, 0x22, state, 0, 0}, {});
  }
  void write(const Bytes& bytes) { port->write(kStart, ++number, 0x01, bytes); }
  void read() { port->read(kStart, ++number, 0x82, 64); }

  std::string named;
  std::unique_ptr<emulators::UsbPort> port;
  Bytes answered;
  emulators::UsbTransfer number = 0;
};

class UsbSerialStreamTest : public ::testing::Test {
 protected:
  UsbSerialStreamTest() {
    stream.on_client([this](const drivers::LineClient& client) {
      story.push_back(client.present ? "client" : "nobody");
    });
  }
  void start() {
    stream.start([this](std::span<const std::uint8_t> bytes) {
      story.emplace_back(bytes.begin(), bytes.end());
    });
  }
  void run() {
    io.restart();
    io.poll();
  }

  boost::asio::io_context io;
  UsbSerialStreamOneSocket bus;
  UsbSerialStream stream{io, bus, emulators::ublox_usb(7), "gnss"};
  std::vector<std::string> story;
};

TEST_F(UsbSerialStreamTest, NewsComesFromTheContextOnly) {
  start();
  bus.open();
  bus.write({'a', 'b'});
  EXPECT_THAT(story, IsEmpty());
  run();
  EXPECT_THAT(story, ElementsAre("client", "ab"));
  EXPECT_EQ(bus.named, "gnss");
  EXPECT_EQ(stream.status().address, "usb test 1-1");
  EXPECT_TRUE(stream.status().client_present);
}

TEST_F(UsbSerialStreamTest, WhoWroteAndLeftWasThere) {
  start();
  bus.open();
  bus.write({'x'});
  bus.set_lines(0);
  run();
  EXPECT_THAT(story, ElementsAre("client", "x", "nobody"));
}

TEST_F(UsbSerialStreamTest, AClientFromBeforeTheStartIsTold) {
  bus.open();
  bus.write({'y'});
  run();
  EXPECT_THAT(story, IsEmpty());
  start();
  run();
  EXPECT_THAT(story, ElementsAre("client", "y"));
}

TEST_F(UsbSerialStreamTest, AnUnplugIsAClientThatLeaves) {
  start();
  bus.open();
  run();
  bus.port->detach(kStart);
  run();
  EXPECT_THAT(story, ElementsAre("client", "nobody"));
}

TEST_F(UsbSerialStreamTest, WritingReachesTheClientOrIsForgotten) {
  start();
  EXPECT_EQ(stream.write(Bytes{1, 2}), 2U);
  bus.open();
  bus.read();
  EXPECT_EQ(stream.write(Bytes{3, 4}), 2U);
  EXPECT_THAT(bus.answered, ElementsAre(3, 4));
  EXPECT_EQ(stream.write(Bytes(4096)), 4096U);
  EXPECT_EQ(stream.write(Bytes(1)), 0U) << "nobody reads";
}

TEST_F(UsbSerialStreamTest, WhatNobodyTakesIsBounded) {
  start();
  bus.open();
  for (int i = 0; i < 3; ++i) {
    bus.write(Bytes(40'000, 'z'));
  }
  run();
  ASSERT_EQ(story.size(), 2U);
  EXPECT_EQ(story[1].size(), UsbSerialStream::kUnreadMaximum);
}

TEST(UsbSerialStream, ItsEndForgetsPendingNews) {
  boost::asio::io_context io;
  UsbSerialStreamOneSocket bus;
  {
    UsbSerialStream stream(io, bus, emulators::ublox_usb(7), "gnss");
    stream.start([](std::span<const std::uint8_t>) { FAIL(); });
    bus.open();
    bus.write({1});
  }
  io.poll();
}

}  // namespace
}  // namespace rigwire::hil
