#include "hil/wires/rig_usb.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <optional>
#include <string>
#include <vector>

#include "emulators/usb/hid_joystick.h"
#include "protocols/usbip/commands.h"
#include "protocols/usbip/operations.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
namespace asio = boost::asio;
namespace usbip = protocols::usbip;
using Bytes = std::vector<std::uint8_t>;

/// Nothing but time.
class EmptyTruth final : public TruthSource {
 public:
  Duration slice() const override { return 1ms; }
  std::optional<std::string> advance(const TruthRequests& /*requests*/,
                                     SampleBatch& batch) override {
    batch.clear();
    batch.from = until_;
    until_ += slice();
    batch.until = until_;
    return std::nullopt;
  }
  const std::vector<StateQuantity>& state_quantities() const override { return none_; }
  TruthStages stages() const override { return {}; }

 private:
  SimTime until_ = kStart;
  std::vector<StateQuantity> none_;
};

/// A client over the system's TCP; the server's side runs between its steps.
class Client {
 public:
  Client(asio::io_context& io, std::uint16_t port) : io_(io), socket_(io) {
    socket_.connect({asio::ip::address_v4::loopback(), port});
  }
  void send(std::span<const std::uint8_t> bytes) {
    asio::write(socket_, asio::buffer(bytes.data(), bytes.size()));
  }
  /// Reads exactly `size` bytes; fewer when the server has closed.
  Bytes take(std::size_t size) {
    Bytes bytes(size);
    std::size_t had = 0;
    bool ended = false;
    asio::async_read(socket_, asio::buffer(bytes),
                     [&](const boost::system::error_code&, std::size_t got) {
                       had = got;
                       ended = true;
                     });
    while (!ended) {
      io_.restart();
      io_.run_one();
    }
    bytes.resize(had);
    return bytes;
  }
  std::optional<usbip::ImportReply> import() {
    usbip::ImportRequest request;
    request.bus_id = {'1', '-', '1'};
    send(usbip::encode_request(request));
    Bytes reply = take(usbip::kOperationHeaderSize);
    if (reply.size() == usbip::kOperationHeaderSize && reply.back() == 0) {
      const Bytes rest = take(usbip::kDeviceRecordSize);
      reply.insert(reply.end(), rest.begin(), rest.end());
    }
    const auto decoded = usbip::decode_import_reply(reply);
    return decoded.ok() ? std::optional(*decoded) : std::nullopt;
  }

 private:
  asio::io_context& io_;
  asio::ip::tcp::socket socket_;
};

class UsbServerLineTest : public ::testing::Test {
 protected:
  static UsbConfiguration any_port() {
    UsbConfiguration configuration;
    configuration.port = 0;
    return configuration;
  }

  [[nodiscard]] bool joystick_is_asked() const { return line.open_transfers(1) == 1; }

  asio::io_context io;
  EmptyTruth truth;
  Executive executive{io, truth};
  emulators::HidJoystick joystick{emulators::HidJoystickSettings{}};
  RigUsb line{any_port(), io, executive};
};

TEST_F(UsbServerLineTest, AClientFindsTheDeviceWhereTheAddressSays) {
  const auto socket = line.plug(joystick, "levers");
  EXPECT_EQ(line.address(socket), "usb 127.0.0.1:" + std::to_string(line.port()) + " 1-1");
  Client client(io, line.port());
  const auto reply = client.import();
  ASSERT_TRUE(reply.has_value());
  EXPECT_EQ(reply->status, usbip::OperationStatus::ok);
  EXPECT_EQ(reply->device.path, "/rigwire/levers");
  EXPECT_TRUE(line.imported(socket));
  EXPECT_EQ(line.statistics().units, 1U);
}

TEST_F(UsbServerLineTest, APlugIsPulledAndPutBackInSimulatedTime) {
  const auto socket = line.plug(joystick, "levers");
  line.begin(socket, {{2s, 1s}, UnpluggedFault{}});
  EXPECT_EQ(line.next_event(), kStart + 2s);
  Client before(io, line.port());
  ASSERT_EQ(before.import()->status, usbip::OperationStatus::ok);
  line.advance(kStart + 2s);
  EXPECT_FALSE(line.imported(socket));
  EXPECT_TRUE(before.take(1).empty()) << "the connection has ended";
  Client meanwhile(io, line.port());
  EXPECT_EQ(meanwhile.import()->status, usbip::OperationStatus::failed);
  line.advance(kStart + 3s);
  EXPECT_EQ(meanwhile.import()->status, usbip::OperationStatus::ok);
  EXPECT_EQ(line.next_event(), kNever);
}

TEST_F(UsbServerLineTest, APlugStaysOutAsLongAsOneOfItsFaultsHolds) {
  const auto socket = line.plug(joystick, "levers");
  line.begin(socket, {{1s, 2s}, UnpluggedFault{}});
  line.begin(socket, {{2s, 3s}, UnpluggedFault{}});
  line.advance(kStart + 4s);
  Client client(io, line.port());
  EXPECT_EQ(client.import()->status, usbip::OperationStatus::failed);
  EXPECT_EQ(line.next_event(), kStart + 5s);
}

TEST_F(UsbServerLineTest, ADeviceWithoutSupplyIsNotThereNorIsOneWhosePlugIsOut) {
  const auto socket = line.plug(joystick, "levers");
  const auto outage =
      line.begin(socket, emulators::SupplyFault{{1s, 2s}, emulators::NoSupplyFault{}});
  line.begin(socket, PlugFault{{2s, 2s}, UnpluggedFault{}});
  Client client(io, line.port());
  const auto status_at = [&](Duration since_start) {
    line.advance(kStart + since_start);
    return client.import()->status;
  };
  EXPECT_EQ(status_at(1500ms), usbip::OperationStatus::failed) << "no supply";
  EXPECT_EQ(status_at(3500ms), usbip::OperationStatus::failed) << "unplugged still";
  EXPECT_FALSE(line.end_outage(socket, outage, kStart + 3500ms)) << "it is over";
  EXPECT_EQ(status_at(4s), usbip::OperationStatus::ok);
  EXPECT_EQ(line.next_event(), kNever);
}

TEST_F(UsbServerLineTest, APlugIsPulledAndPutBackWhenToldWhileTheRunGoesOn) {
  const auto socket = line.plug(joystick, "levers");
  line.advance(kStart + 1s);
  const auto fault = line.begin(socket, {{1s, std::nullopt}, UnpluggedFault{}});
  line.advance(kStart + 2s);
  Client client(io, line.port());
  EXPECT_EQ(client.import()->status, usbip::OperationStatus::failed);
  EXPECT_TRUE(line.end(socket, fault, kStart + 3s));
  line.advance(kStart + 3s);
  EXPECT_EQ(client.import()->status, usbip::OperationStatus::ok);
  EXPECT_FALSE(line.end(socket, fault, kStart + 4s)) << "it is over";
}

TEST_F(UsbServerLineTest, TheDeviceLivesWithTheExecutive) {
  line.plug(joystick, "levers");
  Client client(io, line.port());
  const auto device = client.import()->device;
  usbip::Submit submit;
  submit.device = (device.bus << 16U) | device.device;
  submit.number = 1;
  submit.setup = {0x00, 9, 1, 0, 0, 0, 0, 0};
  client.send(usbip::encode(submit));
  EXPECT_EQ(client.take(48).size(), 48U);
  submit.to_host = true;
  submit.endpoint = 1;
  submit.length = 16;
  submit.number = 2;
  client.send(usbip::encode(submit));
  EXPECT_EQ(client.take(48 + 16).size(), 48U + 16U) << "the first report";
  submit.number = 3;
  client.send(usbip::encode(submit));
  while (!joystick_is_asked()) {
    io.restart();
    io.run_one();
  }
  JoystickSample sample;
  sample.time = kStart + 1s;
  sample.axes[0] = 1.0;
  joystick.update(sample);
  const Bytes report = client.take(48 + 16);
  ASSERT_EQ(report.size(), 48U + 16U);
  EXPECT_EQ(report[48], 0xFF);
  EXPECT_EQ(report[49], 0x7F);
}

}  // namespace
}  // namespace rigwire::hil
