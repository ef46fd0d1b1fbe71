// Every command that decodes writes back to the bytes that it was read from (reserved ones aside).
// A camera takes any sequence of datagrams, pictures and time: it answers each datagram at most
// once, what it answers reads back, its stream is of packets that read back and go where they may,
// and its memory holds what it can.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>

#include "emulators/gige_camera/gige_camera.h"
#include "protocols/bytes.h"
#include "protocols/gige_vision/chunk.h"
#include "protocols/gige_vision/gvcp.h"
#include "protocols/gige_vision/gvsp.h"

namespace gev = rigwire::protocols::gige_vision;

static void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

static void command_round_trip(std::span<const std::uint8_t> bytes) {
  const auto packet = gev::decode_command(bytes);
  if (!packet.ok()) {
    return;
  }
  const auto interpreted = gev::interpret(*packet);
  const auto* const command = std::get_if<gev::Command>(&interpreted);
  if (command == nullptr) {
    require(is_error(std::get<gev::Status>(interpreted)));
    return;
  }
  const auto same = [&](const gev::GvcpPacket& again) {
    // The flags hold bits that mean nothing with most commands.
    require(again.view().size() == bytes.size());
    require(std::ranges::equal(again.view().subspan(2), bytes.subspan(2)));
  };
  if (const auto* const write = std::get_if<gev::WriteMemory>(command)) {
    same(gev::encode_write_memory(packet->request, write->address, write->bytes));
  } else if (const auto* const read = std::get_if<gev::ReadMemory>(command)) {
    const auto again = gev::encode_read_memory(packet->request, read->address, read->count);
    require(again.view().size() == bytes.size());
  } else if (std::holds_alternative<gev::Discovery>(*command)) {
    same(gev::encode_discovery(packet->request));
  }
}

static void stream_reads(std::span<const std::uint8_t> bytes) {
  if (const auto packet = gev::decode_stream_packet(bytes); packet.ok()) {
    const auto payload = packet->payload;
    (void)gev::decode_image_leader(payload);
    if (const auto leader = gev::decode_multipart_leader(payload, packet->header.parts);
        leader.ok()) {
      require(leader->parts.size() == packet->header.parts);
    }
    (void)gev::decode_multipart_payload(payload);
    (void)gev::decode_trailer(payload);
  }
  if (const auto acknowledge = gev::decode_acknowledge(bytes); acknowledge.ok()) {
    (void)gev::decode_register_values(*acknowledge);
    (void)gev::decode_memory(*acknowledge);
    (void)gev::decode_count(*acknowledge);
  }
  gev::ChunkReader chunks(bytes);
  std::size_t total = 0;
  while (const auto chunk = chunks.next()) {
    total += chunk->bytes.size() + gev::kChunkTagSize;
    require(total <= bytes.size());
  }
}

namespace {

using namespace rigwire;
using emulators::UdpEnd;

constexpr UdpEnd kClient{0x7F00'0001, 40000};

class Answers final : public emulators::DatagramOutput {
 public:
  void send(SimTime /*due*/, const UdpEnd& to, std::span<const std::uint8_t> bytes,
            bool /*do_not_fragment*/) override {
    require(to.address == kClient.address);
    require(gev::decode_acknowledge(bytes).ok() && bytes.size() <= gev::kGvcpSizeMaximum);
    ++count;
  }
  unsigned count = 0;
};

class Stream final : public emulators::DatagramOutput {
 public:
  void send(SimTime due, const UdpEnd& to, std::span<const std::uint8_t> bytes,
            bool /*do_not_fragment*/) override {
    require(due >= last);
    last = due;
    require((to.address >> 24U) == 127 && to.port != 0);
    require(bytes.size() + gev::kIpUdpHeaders <= 16356);
    const auto packet = gev::decode_stream_packet(bytes);
    // A test packet is of no block.
    require(packet.ok() || packet.malformed());
  }
  SimTime last{};
};

std::shared_ptr<const Picture> picture_of(const CameraCommand& command, SimTime start) {
  auto picture = std::make_shared<Picture>();
  picture->exposure_start = start;
  picture->exposure = command.exposure;
  const auto add = [&](bool wanted, PictureComponent component, std::uint8_t source,
                       PixelFormat format) {
    if (wanted) {
      const auto pixels = static_cast<std::size_t>(command.region.width * command.region.height);
      picture->parts.push_back({component, source, format, command.region,
                                std::vector<std::uint8_t>(pixels * bytes_per_pixel(format))});
    }
  };
  add(command.intensity, PictureComponent::intensity, 0, command.format);
  add(command.intensity_right, PictureComponent::intensity, 1, command.format);
  add(command.disparity, PictureComponent::disparity, 0, PixelFormat::coord3d_c16);
  add(command.confidence, PictureComponent::confidence, 0, PixelFormat::confidence8);
  return picture;
}

void drive(std::span<const std::uint8_t> bytes) {
  emulators::GigeCameraSettings settings;
  settings.width = 32;
  settings.height = 32;
  settings.kind = emulators::GigeCameraKind::stereo;
  emulators::VolatileMemory memory;
  Answers answers;
  Stream stream;
  emulators::GigeCamera camera(settings, memory, answers, stream);
  SimTime now = kStart;
  const auto command = [&](const gev::GvcpPacket& packet) {
    const unsigned before = answers.count;
    camera.receive(now, kClient, packet.view());
    require(answers.count <= before + 1);
  };
  std::uint16_t request = 1;
  const gev::RegisterValue control[]{{gev::bootstrap::kControlPrivilege, 2},
                                     {gev::bootstrap::kStreamDestination, kClient.address},
                                     {gev::bootstrap::kStreamPort, 50000}};
  command(gev::encode_write_registers(request++, control));
  // A step: what, how long before, how many bytes.
  while (bytes.size() >= 3) {
    const std::uint8_t what = bytes[0] % 8U;
    now += std::chrono::microseconds{bytes[1] * 40};
    const auto data = bytes.subspan(3, std::min<std::size_t>(bytes.size() - 3, bytes[2]));
    bytes = bytes.subspan(3 + data.size());
    camera.advance(now);
    const auto number = [&](std::size_t at) {
      return at + 4 <= data.size() ? protocols::load_little<std::uint32_t>(data, at) : 0U;
    };
    switch (what) {
      case 0: {
        const unsigned before = answers.count;
        camera.receive(now, kClient, data);
        require(answers.count <= before + 1);
        break;
      }
      case 1: {
        const gev::RegisterValue pair{number(0) & 0xFFFCU, number(4)};
        command(gev::encode_write_registers(request++, std::span(&pair, 1)));
        break;
      }
      case 2: {
        // The camera's own registers are near each other.
        const gev::RegisterValue pair{0xA000U + (number(0) & 0x7FCU), number(4) & 0xFFU};
        command(gev::encode_write_registers(request++, std::span(&pair, 1)));
        break;
      }
      case 3:
        command(gev::encode_write_memory(request++, number(0) & 0xFFFCU,
                                         data.subspan(std::min<std::size_t>(4, data.size()))));
        break;
      case 4:
        command(gev::encode_read_memory(request++, number(0) & 0x1'FFFCU,
                                        static_cast<std::uint16_t>(number(4) & 0x3FCU)));
        break;
      case 5:
        command(gev::encode_packet_resend(request++, {0, (number(0) & 1U) != 0, number(4) & 0xFFU,
                                                      number(8) & 0xFFU, number(12) & 0xFFFFU}));
        break;
      case 6: {
        const gev::RegisterValue start{emulators::camera_register::kAcquisitionStart, 1};
        command(gev::encode_write_registers(request++, std::span(&start, 1)));
        break;
      }
      default:
        camera.update({now, now, picture_of(camera.command(), now)});
        break;
    }
    request = request == 0 ? std::uint16_t{1} : request;
    require(camera.next_event() > now || camera.next_event() == kNever);
    require(camera.command().region.width >= 16 && camera.command().region.height >= 16);
    require(camera.command().region.offset_x + camera.command().region.width <= 32);
    require(camera.command().region.offset_y + camera.command().region.height <= 32);
  }
  camera.advance(now + std::chrono::seconds{5});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span bytes(data, size);
  command_round_trip(bytes);
  stream_reads(bytes);
  drive(bytes);
  return 0;
}
