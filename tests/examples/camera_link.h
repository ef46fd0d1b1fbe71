// An emulated GigE Vision camera and the field program's client on one simulated network, in one
// simulated time. Pictures are the test's; what the network does to packets is, too.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "emulators/gige_camera/gige_camera.h"
#include "emulators/nonvolatile_memory.h"
#include "field/gige_client.h"

namespace rigwire::field {

/// A picture of what the camera's command asks for; each part's bytes tell part and place, `seed`
/// tells pictures apart.
inline std::shared_ptr<const Picture> test_picture(const CameraCommand& command, SimTime start,
                                                   unsigned seed) {
  auto picture = std::make_shared<Picture>();
  picture->exposure_start = start;
  picture->exposure = command.exposure;
  picture->gain_db = command.gain_db;
  const auto add = [&](bool wanted, PictureComponent component, std::uint8_t source,
                       PixelFormat format) {
    if (!wanted) {
      return;
    }
    const auto pixels = static_cast<std::size_t>(command.region.width * command.region.height);
    PicturePart part{component, source, format, command.region, {}};
    part.bytes.resize(pixels * bytes_per_pixel(format));
    for (std::size_t i = 0; i < part.bytes.size(); ++i) {
      part.bytes[i] =
          static_cast<std::uint8_t>(i * 7 + i / 251 + picture->parts.size() * 31 + seed);
    }
    picture->parts.push_back(std::move(part));
  };
  add(command.intensity, PictureComponent::intensity, 0, command.format);
  add(command.intensity_right, PictureComponent::intensity, 1, command.format);
  add(command.disparity, PictureComponent::disparity, 0, PixelFormat::coord3d_c16);
  add(command.confidence, PictureComponent::confidence, 0, PixelFormat::confidence8);
  return picture;
}

class CameraLink {
 public:
  using Bytes = std::vector<std::uint8_t>;
  using Arrivals = std::vector<Bytes>;
  /// A block as the client handed it over, kept.
  struct Taken {
    std::uint64_t number = 0;
    std::uint64_t timestamp = 0;
    std::vector<std::pair<protocols::gige_vision::PartLeader, Bytes>> pictures;
    std::size_t chunks = 0;
    std::optional<double> exposure_us;
  };

  static constexpr std::uint32_t kHost = 0x7F00'0001;
  static constexpr std::uint16_t kClientPort = 40000;
  static constexpr std::uint16_t kStreamPort = 50000;

  CameraLink(emulators::GigeCameraSettings camera, GigeClientSettings client)
      : camera_settings_(std::move(camera)),
        client_(std::move(client), {kHost, kStreamPort},
                {.send = [this](std::span<const std::uint8_t> d) { to_camera(d); },
                 .block = [this](const GigeBlock& block) { take(block); },
                 .streaming = [this] { ++begun_; },
                 .ended = [this] { troubles_.push_back(client_.trouble()); }}) {
    switch_on();
  }

  /// The camera is (again) as it comes from the factory.
  void switch_on() {
    switch_off();
    camera_ = std::make_unique<emulators::GigeCamera>(camera_settings_, memory_, control_, stream_);
    exposed_ = now_;
  }
  void switch_off() {
    camera_.reset();
    control_.on_way.clear();
    stream_.on_way.clear();
  }

  void start() { client_.start(now_.time_since_epoch()); }

  void run(Duration span) {
    const SimTime end = now_ + span;
    while (step(end)) {
    }
    now_ = end;
  }

  /// What another application on the network sends to the camera.
  void other_sends(const protocols::gige_vision::GvcpPacket& packet) {
    camera_->receive(now_, {0x7F00'0009, 40009}, packet.view());
  }

  /// What becomes of a stream packet: the datagrams that arrive in its place. Unset: itself.
  std::function<Arrivals(const Bytes&)> network;
  /// Whether a datagram passes, either way, on both channels.
  std::function<bool(SimTime)> cable;

  [[nodiscard]] GigeClient& client() { return client_; }
  [[nodiscard]] emulators::GigeCamera& camera() { return *camera_; }
  [[nodiscard]] const std::vector<Taken>& taken() const { return taken_; }
  [[nodiscard]] const std::vector<std::string>& troubles() const { return troubles_; }
  [[nodiscard]] int begun() const { return begun_; }
  [[nodiscard]] SimTime now() const { return now_; }
  [[nodiscard]] std::shared_ptr<const Picture> exposed(std::uint64_t timestamp) const {
    for (const auto& picture : pictures_) {
      if (picture->exposure_start.time_since_epoch().count() ==
          static_cast<std::int64_t>(timestamp)) {
        return picture;
      }
    }
    return nullptr;
  }

  /// Instead of test_picture().
  std::function<std::shared_ptr<const Picture>(const CameraCommand&, SimTime)> sensor;

 private:
  class Wire final : public emulators::DatagramOutput {
   public:
    void send(SimTime due, const emulators::UdpEnd& to, std::span<const std::uint8_t> bytes,
              bool /*do_not_fragment*/) override {
      if (to.address == kHost) {
        on_way.push_back({due, {bytes.begin(), bytes.end()}, to.port});
      }
    }
    struct Sent {
      SimTime due;
      Bytes bytes;
      std::uint16_t port = 0;
    };
    std::vector<Sent> on_way;
  };

  [[nodiscard]] bool passes() const { return !cable || cable(now_); }

  void to_camera(std::span<const std::uint8_t> datagram) {
    if (camera_ && passes()) {
      camera_->advance(now_);
      camera_->receive(now_, {kHost, kClientPort}, datagram);
    }
  }

  /// The earliest thing that happens until `end`; false when there is none.
  bool step(SimTime end) {
    SimTime at = SimTime{client_.next_event()};
    SimTime exposure = kNever;
    if (camera_) {
      at = std::min(at, camera_->next_event());
      exposure = camera_->sample_plan().next_after(exposed_);
      at = std::min(at, exposure);
    }
    for (const Wire* const wire : {&control_, &stream_}) {
      if (!wire->on_way.empty()) {
        at = std::min(at, wire->on_way.front().due);
      }
    }
    if (at > end) {
      return false;
    }
    now_ = std::max(now_, at);
    if (camera_) {
      camera_->advance(now_);
      if (exposure <= now_) {
        expose(exposure);
      }
    }
    deliver(control_);
    deliver(stream_);
    client_.advance(now_.time_since_epoch());
    return true;
  }

  void expose(SimTime start) {
    exposed_ = start;
    pictures_.push_back(sensor ? sensor(camera_->command(), start)
                               : test_picture(camera_->command(), start,
                                              static_cast<unsigned>(3 * pictures_.size())));
    // Read out at once: a picture's way from the sensor is not what is tested.
    camera_->update({now_, start, pictures_.back()});
  }

  void deliver(Wire& wire) {
    while (!wire.on_way.empty() && wire.on_way.front().due <= now_) {
      const Wire::Sent sent = std::move(wire.on_way.front());
      wire.on_way.erase(wire.on_way.begin());
      if (!passes()) {
        continue;
      }
      if (sent.port == kClientPort) {
        client_.receive_control(now_.time_since_epoch(), sent.bytes);
      } else if (sent.port == kStreamPort) {
        const auto arrived = network ? network(sent.bytes) : Arrivals{sent.bytes};
        for (const Bytes& bytes : arrived) {
          client_.receive_stream(now_.time_since_epoch(), bytes);
        }
      }
    }
  }

  void take(const GigeBlock& block) {
    Taken taken{block.number,
                block.timestamp,
                {},
                block.chunks.size(),
                client_.chunk(block, "ChunkExposureTime")};
    for (const GigePicture& picture : block.pictures) {
      taken.pictures.emplace_back(picture.info, Bytes(picture.bytes.begin(), picture.bytes.end()));
    }
    taken_.push_back(std::move(taken));
  }

  emulators::GigeCameraSettings camera_settings_;
  emulators::VolatileMemory memory_;
  Wire control_;
  Wire stream_;
  std::unique_ptr<emulators::GigeCamera> camera_;
  SimTime now_ = kStart + std::chrono::seconds{1};
  SimTime exposed_ = now_;
  GigeClient client_;
  std::vector<std::shared_ptr<const Picture>> pictures_;
  std::vector<Taken> taken_;
  std::vector<std::string> troubles_;
  int begun_ = 0;
};

}  // namespace rigwire::field
