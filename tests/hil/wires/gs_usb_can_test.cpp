#include "hil/wires/gs_usb_can.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "emulators/usb/usb_port.h"
#include "protocols/gs_usb/host_frame.h"
#include "protocols/gs_usb/requests.h"

namespace rigwire::hil {
namespace {

namespace gs_usb = protocols::gs_usb;
using protocols::can::Frame;
using protocols::usb::Setup;
using Stamp = drivers::CanBus::Stamp;

/// A bus with one socket, and the client that has its device.
class OneSocket final : public UsbBus, public emulators::UsbHost {
 public:
  Socket plug(emulators::UsbDevice& device, std::string_view name) override {
    EXPECT_EQ(name, "can");
    port_.emplace(device);
    return 1;
  }
  FaultBook<PlugFault>::Id begin(Socket, const PlugFault&) override { return 0; }
  bool end(Socket, FaultBook<PlugFault>::Id, SimTime) override { return false; }
  FaultBook<emulators::SupplyFault>::Id begin(Socket, const emulators::SupplyFault&) override {
    return 0;
  }
  bool end_outage(Socket, FaultBook<emulators::SupplyFault>::Id, SimTime) override { return false; }
  [[nodiscard]] bool imported(Socket) const override { return port_->attached(); }
  [[nodiscard]] std::string address(Socket) const override { return where; }
  [[nodiscard]] SimTime now() const override { return kStart; }

  void complete(SimTime, emulators::UsbTransfer, protocols::usb::Outcome,
                std::span<const std::uint8_t> data, std::size_t) override {
    if (data.size() == gs_usb::kStampedFrameBytes) {
      frames.push_back(*gs_usb::decode_frame(data, true));
    }
  }

  void attach() {
    port_->attach(kStart, *this);
    constexpr Setup kConfigure{0x00, 9, 1, 0, 0};
    port_->control(kStart, ++transfers_, kConfigure, {});
  }
  template <class Structure>
  void tell(gs_usb::Request number, const Structure& structure) {
    const auto bytes = gs_usb::encode(structure);
    port_->control(
        kStart, ++transfers_,
        {0x41, static_cast<std::uint8_t>(number), 0, 0, static_cast<std::uint16_t>(bytes.size())},
        bytes);
  }
  void start(std::uint32_t flags = 0) {
    tell(gs_usb::Request::bit_timing, gs_usb::BitTiming{6, 7, 2, 1, 12});
    tell(gs_usb::Request::mode,
         gs_usb::Mode{gs_usb::Mode::kStart, flags | gs_usb::Feature::kTimeStamp});
    for (int i = 0; i < 30; ++i) {
      port_->read(kStart, ++transfers_, gs_usb::kEndpointToHost, 24);
    }
  }
  void transmit(const Frame& frame) {
    gs_usb::HostFrame host_frame = gs_usb::from_can(frame);
    host_frame.echo = 0;
    port_->write(kStart, ++transfers_, gs_usb::kEndpointToDevice,
                 gs_usb::encode_frame(host_frame).span());
  }

  std::string where = "usb 127.0.0.1:3240 1-1";
  std::vector<gs_usb::HostFrame> frames;

 private:
  std::optional<emulators::UsbPort> port_;
  emulators::UsbTransfer transfers_ = 0;
};

class GsUsbCanTest : public testing::Test {
 protected:
  void start() {
    can_.on_client([this](const drivers::CanClient& client) { clients_.push_back(client); });
    can_.start([this](const Frame& frame) { received_.push_back(frame); });
  }
  boost::asio::io_context io_;
  OneSocket usb_;
  GsUsbCan can_{io_, usb_, {}};
  std::vector<drivers::CanClient> clients_;
  std::vector<Frame> received_;
};

const Frame kFrame{0x123, false, false, 2, {0xAA, 0x55}};

TEST_F(GsUsbCanTest, TheClientsInterfaceIsTheBussClient) {
  start();
  usb_.attach();
  EXPECT_TRUE(clients_.empty());
  EXPECT_FALSE(can_.status().client_present);
  usb_.start(gs_usb::Feature::kOneShot);
  ASSERT_EQ(clients_.size(), 1U);
  EXPECT_EQ(clients_[0], (drivers::CanClient{true, 250'000, false, true}));
  EXPECT_TRUE(can_.status().client_present);
  usb_.tell(gs_usb::Request::mode, gs_usb::Mode{});
  ASSERT_EQ(clients_.size(), 2U);
  EXPECT_EQ(clients_[1], drivers::CanClient{});
  EXPECT_EQ(can_.status().address, "gs_usb on usb 127.0.0.1:3240 1-1");
}

TEST_F(GsUsbCanTest, FramesGoBothWaysWithTheirTime) {
  start();
  usb_.attach();
  usb_.start();
  EXPECT_TRUE(can_.deliver(kFrame, std::chrono::microseconds{1234}));
  ASSERT_EQ(usb_.frames.size(), 1U);
  EXPECT_EQ(gs_usb::to_can(usb_.frames[0]), kFrame);
  EXPECT_EQ(usb_.frames[0].time_stamp_us, 1234U);
  usb_.transmit(kFrame);
  EXPECT_EQ(received_, std::vector{kFrame});
  can_.confirm(true, std::chrono::microseconds{2345});
  ASSERT_EQ(usb_.frames.size(), 2U);
  EXPECT_EQ(usb_.frames[1].echo, 0U);
  EXPECT_EQ(usb_.frames[1].time_stamp_us, 2345U);
}

TEST_F(GsUsbCanTest, StatesReachTheClient) {
  start();
  usb_.attach();
  usb_.start();
  protocols::can::ControllerReport report;
  report.state = protocols::can::ErrorState::bus_off;
  report.state_changed = true;
  EXPECT_TRUE(can_.report(report, Stamp{0}));
  ASSERT_EQ(usb_.frames.size(), 1U);
  EXPECT_EQ(usb_.frames[0].identifier & 0x20000040U, 0x20000040U);
}

TEST_F(GsUsbCanTest, FramesWithoutAClientAreForgotten) {
  start();
  EXPECT_TRUE(can_.send(kFrame));
  can_.confirm(true, Stamp{0});
  EXPECT_TRUE(can_.report({}, Stamp{0}));
  EXPECT_TRUE(usb_.frames.empty());
}

TEST(GsUsbCanAttach, OnlyToATcpServer) {
  boost::asio::io_context io;
  OneSocket usb;
  usb.where = "nowhere";
  GsUsbCanSettings settings;
  settings.attach = true;
  GsUsbCan can(io, usb, settings);
  can.start([](const Frame&) {});
  EXPECT_THAT(can.attach_error(), testing::HasSubstr("no TCP server"));
}

}  // namespace
}  // namespace rigwire::hil
