// A serial line in simulated time between an emulated receiver and a client written as a script.
//
// Both directions take 10 bits a byte at the speed of the end that sends; where the two ends are
// set to different speeds, the other end gets garbage. The receiver lives while the client waits:
// it is advanced at its own events and sees the sky at the instants that it plans.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "emulators/ublox/receiver.h"

namespace rigwire::emulators::conversation {

using Bytes = std::vector<std::uint8_t>;

/// Eight satellites over a machine that drives north-east at 1.4 m/s.
inline GnssSample open_sky(SimTime time) {
  GnssSample sample;
  sample.time = time;
  sample.fix = GnssFix::three_d;
  sample.latitude_deg = 49.4240123 + 1e-5 * to_seconds(time);
  sample.longitude_deg = 7.7510456;
  sample.ellipsoid_height_m = 328.25;
  sample.geoid_separation_m = 48.0;
  sample.velocity_ned_mps = {1.0, 1.0, -0.25};
  sample.horizontal_accuracy_m = 2.5;
  sample.vertical_accuracy_m = 4.0;
  sample.speed_accuracy_mps = 0.1;
  sample.time_accuracy_s = 20e-9;
  sample.horizontal_dilution = 1.59;
  sample.vertical_dilution = 3.04;
  sample.position_dilution = 2.03;
  sample.time_dilution = 1.2;
  for (std::uint8_t prn = 1; prn <= 8; ++prn) {
    sample.satellites.push_back({prn, 0.5 * prn, 0.1 * prn, 40.0, true, true});
  }
  return sample;
}

class SerialLine final : public ByteOutput {
 public:
  /// The device at the far end; it must have been given this line as its output.
  void attach(UbloxReceiver& receiver) { receiver_ = &receiver; }

  [[nodiscard]] SimTime now() const { return now_; }

  /// The client opens the line, or changes its speed.
  void set_baud(std::uint32_t baud) {
    baud_ = baud;
    receiver_->set_client(now_, SerialClient{true, baud});
  }
  [[nodiscard]] std::uint32_t baud() const { return baud_; }

  /// Bytes leave the client's UART back to back.
  void write(std::span<const std::uint8_t> bytes) {
    for (const std::uint8_t byte : bytes) {
      client_free_ = std::max(client_free_, now_) + Duration{10'000'000'000 / baud_};
      leaving_.push_back({client_free_, baud_, byte});
    }
  }
  /// Bytes that are there all at once, as through a pseudo-terminal.
  void write_at_once(std::span<const std::uint8_t> bytes) { receiver_->receive(now_, bytes); }

  /// Everything that has arrived and was not read.
  [[nodiscard]] Bytes take() { return std::exchange(arrived_, {}); }

  /// Waits for bytes until `deadline` at most; empty when there were none.
  [[nodiscard]] Bytes read_until(SimTime deadline) {
    while (arrived_.empty() && now_ < deadline) {
      step(deadline);
    }
    return take();
  }
  void wait_until(SimTime instant) {
    while (now_ < instant) {
      step(instant);
    }
  }

  void send(SimTime due, std::span<const std::uint8_t> bytes) override {
    for (const std::uint8_t byte : bytes) {
      coming_.push_back({due, receiver_ == nullptr ? baud_ : receiver_->baud(), byte});
    }
  }

 private:
  struct Byte {
    SimTime due;
    std::uint32_t baud = 0;
    std::uint8_t value = 0;
  };

  /// What a UART makes of a byte at another speed; any byte does that is not the right one.
  [[nodiscard]] static std::uint8_t garbage(std::uint8_t byte) {
    return static_cast<std::uint8_t>((byte * 0x5B + 0x3D) ^ 0xA6);
  }

  /// On to the next thing that happens, but not past `limit`.
  void step(SimTime limit) {
    const SimTime planned = receiver_->sample_plan().next_after(sampled_);
    SimTime next = std::min({limit, receiver_->next_event(), planned});
    if (!leaving_.empty()) {
      next = std::min(next, leaving_.front().due);
    }
    if (!coming_.empty()) {
      next = std::min(next, coming_.front().due);
    }
    now_ = std::max(now_, next);
    receiver_->advance(now_);
    while (!coming_.empty() && coming_.front().due <= now_) {
      const Byte byte = coming_.front();
      coming_.pop_front();
      arrived_.push_back(byte.baud == baud_ ? byte.value : garbage(byte.value));
    }
    while (!leaving_.empty() && leaving_.front().due <= now_) {
      const Byte byte = leaving_.front();
      leaving_.pop_front();
      const std::uint8_t heard = byte.baud == receiver_->baud() ? byte.value : garbage(byte.value);
      receiver_->receive(now_, std::span(&heard, 1));
    }
    if (planned <= now_) {
      sampled_ = planned;
      receiver_->update(open_sky(planned));
    }
  }

  UbloxReceiver* receiver_ = nullptr;
  SimTime now_ = kStart;
  SimTime sampled_ = kStart;
  SimTime client_free_ = kStart;
  std::uint32_t baud_ = 9600;
  std::deque<Byte> leaving_;  ///< From the client.
  std::deque<Byte> coming_;   ///< From the receiver.
  Bytes arrived_;
};

}  // namespace rigwire::emulators::conversation
