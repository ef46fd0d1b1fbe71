// A camera with its sockets recorded, a client that speaks to it, and a sensor that draws.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drawn_picture.h"
#include "emulators/gige_camera/gige_camera.h"
#include "emulators/nonvolatile_memory.h"
#include "protocols/bytes.h"
#include "protocols/gige_vision/gvcp.h"
#include "protocols/gige_vision/gvsp.h"

namespace rigwire::emulators {

namespace gev = protocols::gige_vision;
namespace boot = protocols::gige_vision::bootstrap;
namespace reg = camera_register;

class DatagramRecorder final : public DatagramOutput {
 public:
  struct Sent {
    SimTime due;
    UdpEnd to;
    std::vector<std::uint8_t> bytes;
    bool do_not_fragment = false;
  };
  void send(SimTime due, const UdpEnd& to, std::span<const std::uint8_t> bytes,
            bool do_not_fragment) override {
    EXPECT_TRUE(sent.empty() || due >= sent.back().due) << "due times went back";
    sent.push_back({due, to, {bytes.begin(), bytes.end()}, do_not_fragment});
  }
  std::vector<Sent> sent;
};

/// What a receiver makes of the packets of one block.
struct Received {
  std::optional<gev::ImageLeader> image;
  std::optional<gev::MultipartLeader> multipart;
  std::optional<gev::Trailer> trailer;
  std::vector<std::uint8_t> payload;
  std::size_t packets = 0;
  bool extended_ids = false;
};

class GigeCameraFixture : public testing::Test {
 protected:
  static constexpr UdpEnd kClient{0x7F00'0001, 40000};
  static constexpr UdpEnd kOther{0x7F00'0001, 40001};
  static constexpr std::uint16_t kStreamTo = 50000;

  static GigeCameraSettings small() {
    GigeCameraSettings settings;
    settings.width = 64;
    settings.height = 48;
    return settings;
  }

  void make(const GigeCameraSettings& settings = small()) {
    control.sent.clear();
    stream.sent.clear();
    camera = std::make_unique<GigeCamera>(settings, memory, control, stream);
  }

  // --- Requests; each is answered at once. ---

  /// The last answer to a command. Fails the test when there is none.
  gev::Acknowledge ask(const gev::GvcpPacket& packet, const UdpEnd& from = kClient) {
    const std::size_t before = control.sent.size();
    camera->receive(now, from, packet.view());
    EXPECT_EQ(control.sent.size(), before + 1) << "not answered, or more than once";
    if (control.sent.size() == before) {
      return {};
    }
    EXPECT_EQ(control.sent.back().to, from);
    const auto acknowledge = gev::decode_acknowledge(control.sent.back().bytes);
    EXPECT_TRUE(acknowledge.ok());
    return *acknowledge;
  }
  gev::Status write(std::uint32_t address, std::uint32_t value, const UdpEnd& from = kClient) {
    const gev::RegisterValue pair{address, value};
    return ask(gev::encode_write_registers(next_request(), std::span(&pair, 1)), from).status;
  }
  gev::Status write_bytes(std::uint32_t address, std::span<const std::uint8_t> bytes) {
    return ask(gev::encode_write_memory(next_request(), address, bytes)).status;
  }
  gev::Status write_real(std::uint32_t address, double value) {
    std::array<std::uint8_t, 8> bytes{};
    protocols::store_big(std::span<std::uint8_t>(bytes), 0, std::bit_cast<std::uint64_t>(value));
    return write_bytes(address, bytes);
  }
  gev::Status status_of_reading(std::uint32_t address, const UdpEnd& from = kClient) {
    return ask(gev::encode_read_registers(next_request(), std::span(&address, 1)), from).status;
  }
  std::uint32_t read(std::uint32_t address, const UdpEnd& from = kClient) {
    const auto acknowledge =
        ask(gev::encode_read_registers(next_request(), std::span(&address, 1)), from);
    EXPECT_EQ(acknowledge.status, gev::Status::success) << address;
    const auto values = gev::decode_register_values(acknowledge);
    return values.ok() && values->size() == 1 ? (*values)[0] : 0;
  }
  std::vector<std::uint8_t> read_bytes(std::uint32_t address, std::uint16_t count) {
    const auto acknowledge = ask(gev::encode_read_memory(next_request(), address, count));
    EXPECT_EQ(acknowledge.status, gev::Status::success) << address;
    const auto content = gev::decode_memory(acknowledge);
    return content.ok() ? std::vector<std::uint8_t>(content->bytes.begin(), content->bytes.end())
                        : std::vector<std::uint8_t>{};
  }
  double read_real(std::uint32_t address) {
    const std::vector<std::uint8_t> bytes = read_bytes(address, 8);
    return bytes.size() == 8 ? std::bit_cast<double>(protocols::load_big<std::uint64_t>(bytes, 0))
                             : 0.0;
  }
  std::string read_text(std::uint32_t address, std::uint16_t count) {
    const std::vector<std::uint8_t> bytes = read_bytes(address, count);
    return {bytes.begin(), std::find(bytes.begin(), bytes.end(), std::uint8_t{0})};
  }

  void take_control() {
    ASSERT_EQ(write(boot::kControlPrivilege, gev::Privilege::kControl), gev::Status::success);
  }
  void open_stream() {
    ASSERT_EQ(write(boot::kStreamDestination, kClient.address), gev::Status::success);
    ASSERT_EQ(write(boot::kStreamPort, kStreamTo), gev::Status::success);
  }
  void start_streaming() {
    take_control();
    open_stream();
    ASSERT_EQ(write(reg::kAcquisitionStart, 1), gev::Status::success);
  }
  void pass(Duration span) {
    now += span;
    camera->advance(now);
  }

  /// The sensor hands over the picture of an exposure that begins now.
  void expose(std::uint8_t seed = 0) {
    const SimTime start = now;
    const auto picture = drawn(camera->command(), start, seed);
    now += picture->exposure;
    camera->update({now, start, picture});
  }

  /// Blocks by their numbers, put together by the sizes and offsets on the wire.
  [[nodiscard]] std::map<std::uint64_t, Received> received(std::size_t packet_size = 1500) const {
    std::map<std::uint64_t, Received> blocks;
    for (const auto& sent : stream.sent) {
      EXPECT_LE(sent.bytes.size() + gev::kIpUdpHeaders, packet_size);
      const auto packet = gev::decode_stream_packet(sent.bytes);
      EXPECT_TRUE(packet.ok());
      if (!packet.ok() || is_error(packet->header.status)) {
        continue;
      }
      Received& block = blocks[packet->header.block];
      ++block.packets;
      block.extended_ids = packet->header.extended_ids;
      const bool multipart = packet->header.format == gev::PacketFormat::multipart;
      const std::size_t room =
          gev::payload_room(packet_size, packet->header.extended_ids, multipart);
      std::size_t at = 0;
      std::span<const std::uint8_t> bytes = packet->payload;
      switch (packet->header.format) {
        case gev::PacketFormat::leader:
          if (*gev::decode_payload_type(packet->payload) % 16 == gev::PayloadType::kImage) {
            block.image = *gev::decode_image_leader(packet->payload);
          } else {
            block.multipart = *gev::decode_multipart_leader(packet->payload, packet->header.parts);
          }
          continue;
        case gev::PacketFormat::trailer:
          block.trailer = *gev::decode_trailer(packet->payload);
          continue;
        case gev::PacketFormat::payload:
          at = (packet->header.packet - 1) * room;
          break;
        case gev::PacketFormat::multipart: {
          const auto part = gev::decode_multipart_payload(packet->payload);
          at = part->offset;
          bytes = part->bytes;
          break;
        }
      }
      block.payload.resize(std::max(block.payload.size(), at + bytes.size()));
      std::copy(bytes.begin(), bytes.end(),
                block.payload.begin() + static_cast<std::ptrdiff_t>(at));
    }
    return blocks;
  }

  std::uint16_t next_request() { return ++request_; }

  VolatileMemory memory;
  DatagramRecorder control;
  DatagramRecorder stream;
  std::unique_ptr<GigeCamera> camera;
  SimTime now = kStart + std::chrono::seconds{1};

 private:
  std::uint16_t request_ = 0;
};

}  // namespace rigwire::emulators
