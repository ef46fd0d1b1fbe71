// An emulated u-blox receiver as the far end of a line, in its own time: nothing waits. What it
// says may be damaged on the way, one message at a time, and what is said to it may be held back.
#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "conform/byte_line.h"
#include "emulators/ublox/receiver.h"
#include "protocols/ubx/frame.h"

namespace rigwire::conform {

using Bytes = std::vector<std::uint8_t>;

/// One frame with another payload, its length and check as they have to be.
inline Bytes resealed(const Bytes& frame, const Bytes& payload) {
  Bytes other(protocols::ubx::kOverheadBytes + payload.size());
  static_cast<void>(protocols::ubx::encode_frame({frame.at(2), frame.at(3)}, payload, other));
  return other;
}

class EmulatedReceiver final : public ByteLine, public emulators::ByteOutput {
 public:
  /// Instead of a frame that it sends, or of one that it is sent; of the latter what is returned as
  /// `second` comes back in its place.
  using Saying = std::function<Bytes(const Bytes& frame)>;
  using Hearing = std::function<std::pair<Bytes, Bytes>(const Bytes& frame)>;

  explicit EmulatedReceiver(const emulators::UbloxSettings& settings, Saying saying = {},
                            Hearing hearing = {})
      : receiver_(settings, Calendar{UtcTime{2026, 6, 1, 8, 0, 0, 0}}, *this),
        saying_(std::move(saying)),
        hearing_(std::move(hearing)) {
    run(kStart + std::chrono::seconds(3));
    arrived_.clear();
  }

  bool send(std::span<const std::uint8_t> bytes) override {
    if (!hearing_) {
      receiver_.receive(now_, bytes);
      return true;
    }
    heard_.insert(heard_.end(), bytes.begin(), bytes.end());
    while (!heard_.empty()) {
      const auto frame = protocols::ubx::decode_frame(heard_);
      if (frame.incomplete()) {
        break;
      }
      const std::size_t size = frame.ok() ? frame.consumed() : 1;
      const Bytes one(heard_.begin(), heard_.begin() + static_cast<std::ptrdiff_t>(size));
      heard_.erase(heard_.begin(), heard_.begin() + static_cast<std::ptrdiff_t>(size));
      const auto [passed, back] = frame.ok() ? hearing_(one) : std::pair(one, Bytes());
      receiver_.receive(now_, passed);
      arrived_.insert(arrived_.end(), back.begin(), back.end());
    }
    return true;
  }

  bool receive(Bytes& bytes, Clock::time_point deadline) override {
    const SimTime until = kStart + deadline.time_since_epoch();
    while (arrived_.empty() && now_ < until) {
      run(std::min(until, now_ + std::chrono::milliseconds(1)));
    }
    bytes.insert(bytes.end(), arrived_.begin(), arrived_.end());
    return !std::exchange(arrived_, {}).empty();
  }

  [[nodiscard]] bool closed() const override { return false; }
  [[nodiscard]] Clock::time_point now() const override {
    return Clock::time_point(now_.time_since_epoch());
  }

  // Takes bytes that the receiver sends.
  void send(SimTime /*due*/, std::span<const std::uint8_t> bytes) override {
    said_.insert(said_.end(), bytes.begin(), bytes.end());
    while (!said_.empty()) {
      const auto frame = protocols::ubx::decode_frame(said_);
      if (frame.incomplete()) {
        break;
      }
      const std::size_t size = frame.ok() ? frame.consumed() : 1;
      Bytes one(said_.begin(), said_.begin() + static_cast<std::ptrdiff_t>(size));
      said_.erase(said_.begin(), said_.begin() + static_cast<std::ptrdiff_t>(size));
      if (frame.ok() && saying_) {
        one = saying_(one);
      }
      arrived_.insert(arrived_.end(), one.begin(), one.end());
    }
  }

 private:
  /// A machine that drives north-east and up under eight satellites; what is measured trembles.
  [[nodiscard]] static GnssSample sample(SimTime time) {
    const double tremble = std::sin(7.0 * to_seconds(time));
    GnssSample sample;
    sample.time = time;
    sample.fix = GnssFix::three_d;
    sample.latitude_deg = 49.4240123 + 1e-7 * tremble;
    sample.longitude_deg = -7.7510456 - 2e-7 * tremble;
    sample.ellipsoid_height_m = 328.25 + 0.01 * tremble;
    sample.geoid_separation_m = 48.0;
    sample.velocity_ned_mps = {2.0 + 0.01 * tremble, 1.5, -0.25};
    sample.horizontal_accuracy_m = 2.5;
    sample.vertical_accuracy_m = 4.0;
    sample.speed_accuracy_mps = 0.1;
    sample.time_accuracy_s = 20e-9;
    sample.horizontal_dilution = 1.2;
    sample.vertical_dilution = 1.6;
    sample.position_dilution = 2.0;
    sample.time_dilution = 1.2;
    for (std::uint8_t prn = 1; prn <= 8; ++prn) {
      sample.satellites.push_back({prn, 0.5 * prn, 0.1 * prn, 40.0, true, true});
    }
    return sample;
  }

  void run(SimTime until) {
    while (true) {
      const SimTime next = receiver_.sample_plan().next_after(now_);
      const SimTime step = std::min(next, receiver_.next_event());
      if (step > until) {
        break;
      }
      receiver_.advance(step);
      now_ = std::max(now_, step);
      if (next == step) {
        receiver_.update(sample(step));
      }
    }
    receiver_.advance(until);
    now_ = until;
  }

  emulators::UbloxReceiver receiver_;
  Saying saying_;
  Hearing hearing_;
  SimTime now_ = kStart;
  Bytes said_;     ///< By the receiver, begun.
  Bytes heard_;    ///< From the client, begun.
  Bytes arrived_;  ///< At the client's end.
};

}  // namespace rigwire::conform
