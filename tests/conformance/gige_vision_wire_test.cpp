// tshark, whose dissectors share no table with us, reads a session with each kind of camera: no
// packet is malformed, and the leaders say what was exposed.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <ostream>
#include <sstream>
#include <string>
#include <vector>

#include "emulators/gige_camera/gige_camera.h"
#include "protocols/bytes.h"
#include "protocols/gige_vision/gvcp.h"

namespace rigwire::emulators {
namespace {

namespace gev = protocols::gige_vision;
namespace boot = protocols::gige_vision::bootstrap;
namespace reg = camera_register;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr UdpEnd kCamera{0x7F00'0002, gev::kGvcpPort};
constexpr UdpEnd kClient{0x7F00'0001, 40000};
constexpr UdpEnd kCameraStream{0x7F00'0002, 45000};
constexpr std::uint16_t kStreamTo = 50000;

/// A pcap file of IPv4 without a link layer.
class Capture {
 public:
  explicit Capture(const std::filesystem::path& file) : out_(file, std::ios::binary) {
    constexpr std::uint32_t kRawIp = 101;  // LINKTYPE_RAW
    for (const std::uint32_t word : {0xA1B2C3D4U, 0x0004'0002U, 0U, 0U, 65535U, kRawIp}) {
      little(word);
    }
  }
  void add(SimTime at, const UdpEnd& from, const UdpEnd& to, std::span<const std::uint8_t> bytes) {
    using protocols::store_big;
    const auto length = static_cast<std::uint32_t>(gev::kIpUdpHeaders + bytes.size());
    const std::int64_t microseconds = at.time_since_epoch().count() / 1000;
    little(static_cast<std::uint32_t>(microseconds / 1'000'000));
    little(static_cast<std::uint32_t>(microseconds % 1'000'000));
    little(length);
    little(length);
    std::array<std::uint8_t, gev::kIpUdpHeaders> head{0x45};
    const std::span<std::uint8_t> fields(head);
    store_big(fields, 2, static_cast<std::uint16_t>(length));
    head[8] = 64;  // hops
    head[9] = 17;  // UDP
    store_big(fields, 12, from.address);
    store_big(fields, 16, to.address);
    store_big(fields, 20, from.port);
    store_big(fields, 22, to.port);
    store_big(fields, 24, static_cast<std::uint16_t>(8 + bytes.size()));
    write(head);
    write(bytes);
    ++packets_;
  }
  [[nodiscard]] std::size_t packets() const { return packets_; }
  void close() { out_.close(); }

 private:
  void little(std::uint32_t word) {
    std::array<std::uint8_t, 4> bytes{};
    protocols::store_little(std::span<std::uint8_t>(bytes), 0, word);
    write(bytes);
  }
  void write(std::span<const std::uint8_t> bytes) {
    out_.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }
  std::ofstream out_;
  std::size_t packets_ = 0;
};

class CapturedSocket final : public DatagramOutput {
 public:
  CapturedSocket(Capture& capture, const UdpEnd& from) : capture_(capture), from_(from) {}
  void send(SimTime due, const UdpEnd& to, std::span<const std::uint8_t> bytes,
            bool /*do_not_fragment*/) override {
    capture_.add(due, from_, to, bytes);
    ++sent;
  }
  std::size_t sent = 0;

 private:
  Capture& capture_;
  UdpEnd from_;
};

std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) {
    return "cannot run " + command;
  }
  std::array<char, 4096> piece{};
  while (std::fgets(piece.data(), static_cast<int>(piece.size()), pipe) != nullptr) {
    text += piece.data();
  }
  const int status = pclose(pipe);
  return status == 0 ? text : "exit status " + std::to_string(status) + "\n" + text;
}

/// Fields of one packet as tshark prints them; empty where a packet has none.
struct Dissected {
  std::string protocols;
  std::string malformed;
  std::string control_status;
  std::string model;
  std::string stream_status;
  std::string format;
  std::string payload_type;
  std::string timestamp;
  std::string width;
  std::string height;
};

struct Case {
  const char* name;
  GigeCameraKind kind;
  bool extended_ids;
  bool multipart;
  bool chunks;
};
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

class GigeVisionWire : public testing::TestWithParam<Case> {
 protected:
  GigeVisionWire()
      : file_(std::filesystem::temp_directory_path() /
              ("rigwire_gige_" + std::string(GetParam().name) + "_" + std::to_string(getpid()) +
               ".pcap")),
        capture_(file_),
        control_(capture_, kCamera),
        stream_(capture_, kCameraStream) {
    GigeCameraSettings settings;
    settings.width = 64;
    settings.height = 48;
    settings.kind = GetParam().kind;
    camera_ = std::make_unique<GigeCamera>(settings, memory_, control_, stream_);
    camera_->set_stream_port(kCameraStream.port);
  }
  ~GigeVisionWire() override { std::filesystem::remove(file_); }

  void tell(const gev::GvcpPacket& packet) {
    capture_.add(now_, kClient, kCamera, packet.view());
    camera_->receive(now_, kClient, packet.view());
    ++told_;
    now_ += milliseconds{1};
  }
  void write(std::uint32_t address, std::uint32_t value) {
    const gev::RegisterValue pair{address, value};
    tell(gev::encode_write_registers(++request_, std::span(&pair, 1)));
  }
  void expose() {
    const CameraCommand& command = camera_->command();
    auto picture = std::make_shared<Picture>();
    last_exposure_ = now_;
    picture->exposure_start = now_;
    picture->exposure = command.exposure;
    const auto add = [&](bool wanted, PictureComponent component, PixelFormat format) {
      if (wanted) {
        const auto pixels = static_cast<std::size_t>(command.region.width) *
                            static_cast<std::size_t>(command.region.height);
        picture->parts.push_back({component, 0, format, command.region,
                                  std::vector<std::uint8_t>(pixels * bytes_per_pixel(format))});
      }
    };
    add(command.intensity, PictureComponent::intensity, command.format);
    add(command.disparity, PictureComponent::disparity, PixelFormat::coord3d_c16);
    add(command.confidence, PictureComponent::confidence, PixelFormat::confidence8);
    now_ += command.exposure;
    camera_->update({now_, picture->exposure_start, picture});
    now_ += milliseconds{20};
    camera_->advance(now_);
  }
  /// What tshark makes of each packet; it takes its time to start, hence once.
  [[nodiscard]] std::vector<Dissected> dissected() const {
    std::istringstream lines(output_of(
        "tshark -r '" + file_.string() +
        "' -d udp.port==50000,gvsp -T fields -E separator=/t -e frame.protocols -e _ws.malformed"
        " -e gvcp.cmd.status -e gvcp.bootstrap.modelname -e gvsp.status -e gvsp.format"
        " -e gvsp.payloadtype -e gvsp.timestamp -e gvsp.sizex -e gvsp.sizey 2>/dev/null"));
    std::vector<Dissected> packets;
    for (std::string line; std::getline(lines, line);) {
      std::istringstream fields(line);
      Dissected& packet = packets.emplace_back();
      for (std::string* field :
           {&packet.protocols, &packet.malformed, &packet.control_status, &packet.model,
            &packet.stream_status, &packet.format, &packet.payload_type, &packet.timestamp,
            &packet.width, &packet.height}) {
        std::getline(fields, *field, '\t');
      }
    }
    return packets;
  }

  std::filesystem::path file_;
  Capture capture_;
  CapturedSocket control_;
  CapturedSocket stream_;
  VolatileMemory memory_;
  std::unique_ptr<GigeCamera> camera_;
  SimTime now_ = kStart + seconds{1};
  SimTime last_exposure_{};
  std::size_t told_ = 0;
  std::uint16_t request_ = 0;
};

TEST_P(GigeVisionWire, AnIndependentDissectorReadsTheSession) {
  const Case& wanted = GetParam();
  tell(gev::encode_discovery(0xFFFF));
  tell(gev::encode_read_memory(++request_, boot::kFirstUrl, 512));
  tell(gev::encode_read_memory(++request_, kDescriptionAddress, 536));
  write(boot::kControlPrivilege, 2);
  for (const std::uint32_t address : {boot::kDeviceMode, boot::kCapability, boot::kStreamPacketSize,
                                      boot::kStreamChannelCapability, boot::kStreamCapability}) {
    tell(gev::encode_read_registers(++request_, std::span(&address, 1)));
  }
  const std::array<std::uint8_t, 16> name{'l', 'e', 'f', 't'};
  tell(gev::encode_write_memory(++request_, boot::kUserDefinedName, name));
  write(boot::kStreamConfiguration,
        wanted.extended_ids ? gev::StreamConfiguration::kExtendedIds : 0);
  write(boot::kStreamChannelConfiguration, wanted.multipart ? gev::StreamChannel::kMultipart : 0);
  write(reg::kChunkModeActive, wanted.chunks ? 1 : 0);
  write(boot::kStreamDestination, kClient.address);
  write(boot::kStreamPort, kStreamTo);
  write(reg::kAcquisitionStart, 1);
  for (int i = 0; i < 3; ++i) {
    expose();
  }
  // What is refused, what is asked for again, and what is gone.
  write(boot::kVersion, 1);
  write(0x0B00, 1);
  const bool extended = wanted.extended_ids || wanted.multipart;
  tell(gev::encode_packet_resend(++request_, {0, extended, 1, 1, 2}));
  tell(gev::encode_packet_resend(++request_, {0, extended, 77, 1, 2}));
  gev::ForceIp force;
  force.mac = {2, 2, 2, 2, 2, 2};
  tell(gev::encode_force_ip(++request_, force));
  now_ += milliseconds{20};
  camera_->advance(now_);
  capture_.close();
  ASSERT_GT(stream_.sent, 9U);

  const std::vector<Dissected> packets = dissected();
  ASSERT_EQ(packets.size(), capture_.packets());
  const auto count = [&packets](const auto& holds) {
    return static_cast<std::size_t>(std::ranges::count_if(packets, holds));
  };
  EXPECT_EQ(count([](const Dissected& p) { return !p.malformed.empty(); }), 0U);
  EXPECT_EQ(count([](const Dissected& p) { return p.protocols == "raw:ip:udp:gvcp"; }),
            told_ + control_.sent);
  EXPECT_EQ(count([](const Dissected& p) { return p.protocols == "raw:ip:udp:gvsp"; }),
            stream_.sent);
  EXPECT_EQ(count([](const Dissected& p) { return p.control_status == "0x8004"; }), 1U);
  EXPECT_EQ(count([](const Dissected& p) { return p.control_status == "0x8003"; }), 1U);
  EXPECT_EQ(count([](const Dissected& p) { return p.model == "AreaCamera"; }), 1U);
  EXPECT_EQ(count([](const Dissected& p) { return p.stream_status == "0x0100"; }), 2U);
  EXPECT_EQ(count([](const Dissected& p) { return p.stream_status == "0x800c"; }), 1U);

  // Leaders in their order; tshark 4.0 knows the header of a multi-part leader alone.
  const std::string leader = extended ? "0x81" : "0x01";
  std::vector<std::string> timestamps;
  for (const Dissected& packet : packets) {
    if (packet.format != leader) {
      continue;
    }
    timestamps.push_back(packet.timestamp);
    if (!wanted.multipart) {
      EXPECT_EQ(packet.payload_type, wanted.chunks ? "0x4001" : "0x0001");
      EXPECT_EQ(packet.width, "64");
      EXPECT_EQ(packet.height, "48");
    }
  }
  const std::size_t components = wanted.kind == GigeCameraKind::stereo && !wanted.multipart ? 3 : 1;
  ASSERT_EQ(timestamps.size(), 3 * components);
  if (!wanted.multipart) {
    EXPECT_EQ(std::stoll(timestamps.back(), nullptr, 16), (last_exposure_ - kStart).count());
  }
}

INSTANTIATE_TEST_SUITE_P(
    Cameras, GigeVisionWire,
    testing::Values(Case{"Image", GigeCameraKind::camera, false, false, false},
                    Case{"ExtendedIds", GigeCameraKind::camera, true, false, false},
                    Case{"Chunks", GigeCameraKind::camera, false, false, true},
                    Case{"ExtendedChunks", GigeCameraKind::camera, true, false, true},
                    Case{"Components", GigeCameraKind::stereo, false, false, false},
                    Case{"Multipart", GigeCameraKind::stereo, false, true, false},
                    Case{"MultipartChunks", GigeCameraKind::stereo, false, true, true}),
    [](const auto& parameter) { return std::string(parameter.param.name); });

}  // namespace
}  // namespace rigwire::emulators
