// An emulated GigE Vision camera as the far end of a network, in its own time: nothing waits. What
// it sends may be damaged on the way, one datagram at a time, and what is sent to it held back.
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "conform/datagram_line.h"
#include "drawn_picture.h"
#include "emulators/gige_camera/gige_camera.h"
#include "emulators/nonvolatile_memory.h"

namespace rigwire::conform {

class EmulatedCamera final : public DatagramLine {
 public:
  using Bytes = std::vector<std::uint8_t>;
  /// Instead of a datagram: itself, another, several, or none.
  using Change = std::function<std::vector<Bytes>(const Bytes& datagram)>;
  struct Changes {
    Change answering;  ///< Changes what its control port sends.
    Change streaming;
    Change hearing;  ///< Changes what is sent to it.
  };

  static constexpr std::uint16_t kStreamFrom = 45'000;

  explicit EmulatedCamera(const emulators::GigeCameraSettings& settings, Changes changes = {})
      : changes_(std::move(changes)),
        control_(*this, kCamera.port, changes_.answering),
        stream_(*this, kStreamFrom, changes_.streaming),
        camera_(settings, memory_, control_, stream_) {
    camera_.set_stream_port(kStreamFrom);
    run(kStart + std::chrono::seconds{1});
  }

  static inline const Peer kCamera{"127.0.0.2", 3956};

  bool send(std::size_t from_port, const Peer& /*to*/,
            std::span<const std::uint8_t> bytes) override {
    const Bytes one(bytes.begin(), bytes.end());
    for (const Bytes& each : changed(changes_.hearing, one)) {
      camera_.receive(now_, {kOwnAddress, kPorts.at(from_port)}, each);
    }
    run(now_);
    return true;
  }

  std::optional<Datagram> receive(Clock::time_point deadline) override {
    const SimTime until = kStart + deadline.time_since_epoch();
    while (true) {
      // Packets of both sockets, by the time at which they left.
      const auto first = arrived_.begin();
      if (first != arrived_.end() && first->first <= now_) {
        Datagram datagram = std::move(first->second);
        arrived_.erase(first);
        return datagram;
      }
      if (now_ >= until) {
        return std::nullopt;
      }
      run(std::min(until, now_ + std::chrono::milliseconds(1)));
    }
  }

  Peer own(std::size_t port) const override { return {"127.0.0.1", kPorts.at(port)}; }
  [[nodiscard]] Clock::time_point now() const override {
    return Clock::time_point(now_.time_since_epoch());
  }

 private:
  static constexpr std::uint32_t kOwnAddress = 0x7F00'0001;
  static constexpr std::array<std::uint16_t, 3> kPorts{40'000, 40'001, 50'000};

  static std::vector<Bytes> changed(const Change& change, const Bytes& bytes) {
    return change ? change(bytes) : std::vector<Bytes>{bytes};
  }

  class Socket final : public emulators::DatagramOutput {
   public:
    Socket(EmulatedCamera& all, std::uint16_t port, const Change& change)
        : all_(all), port_(port), change_(change) {}
    void send(SimTime due, const emulators::UdpEnd& to, std::span<const std::uint8_t> bytes,
              bool /*do_not_fragment*/) override {
      const auto* const at = std::ranges::find(kPorts, to.port);
      if (at == kPorts.end()) {
        return;
      }
      for (Bytes& each : changed(change_, {bytes.begin(), bytes.end()})) {
        all_.arrived_.emplace(due, Datagram{static_cast<std::size_t>(at - kPorts.begin()),
                                            {kCamera.address, port_},
                                            Clock::time_point(due.time_since_epoch()),
                                            std::move(each)});
      }
    }

   private:
    EmulatedCamera& all_;
    std::uint16_t port_;
    const Change& change_;
  };

  void run(SimTime until) {
    while (true) {
      const SimTime exposure = camera_.sample_plan().next_after(now_);
      const SimTime step = std::min(exposure, camera_.next_event());
      if (step > until) {
        break;
      }
      now_ = std::max(now_, step);
      camera_.advance(now_);
      if (step == exposure) {
        const auto picture = emulators::drawn(camera_.command(), now_, ++seed_);
        now_ += picture->exposure;
        camera_.update({now_, picture->exposure_start, picture});
      }
    }
    now_ = std::max(now_, until);
    camera_.advance(now_);
  }

  Changes changes_;
  std::multimap<SimTime, Datagram> arrived_;
  emulators::VolatileMemory memory_;
  Socket control_;
  Socket stream_;
  emulators::GigeCamera camera_;
  SimTime now_ = kStart;
  std::uint8_t seed_ = 0;
};

}  // namespace rigwire::conform
