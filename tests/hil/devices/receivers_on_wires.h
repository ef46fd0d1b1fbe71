// Receivers with their antennas in an open sky, and wires from one's second UART to another's, run
// in simulated time as fast as the machine allows.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "emulators/ublox/receiver.h"
#include "protocols/nmea/sentence.h"
#include "protocols/rtcm3/frame.h"
#include "protocols/ubx/configuration_keys.h"
#include "protocols/ubx/frame.h"
#include "sim/gnss/antenna_book.h"
#include "sim/gnss/gnss_sensor.h"
#include "sim/local_frame.h"

namespace rigwire::hil {

struct OpenSky final : sim::Visibility {
  [[nodiscard]] bool blocked(const Eigen::Vector3d& /*p_W*/, const Eigen::Vector3d& direction_W,
                             double /*clearance_m*/) const override {
    return direction_W.z() < 0.0;
  }
};

using Motion = std::function<sim::LinkMotion(SimTime)>;

[[nodiscard]] inline Motion standing_at(const Eigen::Vector3d& p_W) {
  sim::LinkMotion motion;
  motion.X_WL.translation() = p_W;
  return [motion](SimTime) { return motion; };
}

class ReceiverOnWires {
 public:
  /// What it says on its first UART.
  struct Line final : emulators::ByteOutput {
    void send(SimTime /*due*/, std::span<const std::uint8_t> bytes) override {
      all.insert(all.end(), bytes.begin(), bytes.end());
    }
    std::vector<std::uint8_t> all;
  };
  /// What it says on its second, on its way.
  struct Wire final : emulators::ByteOutput {
    void send(SimTime due, std::span<const std::uint8_t> bytes) override {
      if (to == nullptr || cut) {
        return;
      }
      if (!rewrite) {
        waiting.emplace_back(due + delay, std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
        return;
      }
      begun.insert(begun.end(), bytes.begin(), bytes.end());
      if (const auto frame = protocols::rtcm3::decode_frame(begun); frame.ok()) {
        waiting.emplace_back(due + delay, rewrite(*frame));
        begun.erase(begun.begin(), begun.begin() + static_cast<std::ptrdiff_t>(frame.consumed()));
      }
    }
    ReceiverOnWires* to = nullptr;
    bool cut = false;
    Duration delay{0};
    /// What stands on the wire in a message's place; empty: the message itself.
    std::function<std::vector<std::uint8_t>(const protocols::rtcm3::FrameView&)> rewrite;
    std::vector<std::uint8_t> begun;
    std::deque<std::pair<SimTime, std::vector<std::uint8_t>>> waiting;
  };

  ReceiverOnWires(const emulators::UbloxSettings& settings, const sim::GnssParameters& parameters,
                  const Calendar& calendar, const sim::LocalFrame& frame,
                  const std::shared_ptr<sim::AntennaBook>& antennas, std::uint64_t seed,
                  const std::string& name, Motion motion)
      : sensor(parameters, calendar, frame, seed, name),
        receiver(settings, calendar, line, wire),
        motion_(std::move(motion)) {
    sensor.share(antennas);
    sensor.command(receiver.command());
    receiver.set_client(kStart, {true, settings.baud});
  }

  [[nodiscard]] SimTime next() const {
    SimTime next = std::min(receiver.next_event(), receiver.sample_plan().next_after(sampled_));
    return wire.waiting.empty() ? next : std::min(next, wire.waiting.front().first);
  }
  void advance(SimTime now) {
    receiver.advance(now);
    if (const SimTime planned = receiver.sample_plan().next_after(sampled_); planned <= now) {
      sampled_ = planned;
      sensor.command(receiver.command());
      latest = sensor.sample(planned, motion_(planned), sky_);
      receiver.update(latest);
    }
    while (!wire.waiting.empty() && wire.waiting.front().first <= now) {
      wire.to->receiver.receive_second(now, wire.waiting.front().second, receiver.second_baud());
      wire.waiting.pop_front();
    }
  }
  /// Payloads of the UBX messages of that id so far.
  [[nodiscard]] std::vector<std::vector<std::uint8_t>> said(protocols::ubx::MessageId id) const {
    std::vector<std::vector<std::uint8_t>> found;
    for (std::size_t at = 0; at < line.all.size();) {
      const auto rest = std::span(line.all).subspan(at);
      const auto frame = protocols::ubx::decode_frame(rest);
      if (frame.ok() && frame->id == id) {
        found.emplace_back(frame->payload.begin(), frame->payload.end());
      }
      at += frame.ok() ? frame.consumed() : 1;
    }
    return found;
  }

  Line line;
  Wire wire;
  sim::GnssSensor sensor;
  emulators::UbloxReceiver receiver;
  GnssSample latest;

 private:
  Motion motion_;
  OpenSky sky_;
  SimTime sampled_ = kStart;
};

/// Items by name, as UBX-CFG-VALSET to the RAM, 900 ms after the start.
using Keys = std::vector<std::pair<std::string_view, std::uint64_t>>;
inline void set(ReceiverOnWires& one, const Keys& keys) {
  std::vector<std::uint8_t> payload{0, 1 /*RAM*/, 0, 0};
  const auto put = [&](std::uint64_t value, std::size_t bytes) {
    for (std::size_t i = 0; i < bytes; ++i) {
      payload.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
  };
  for (const auto& [name, value] : keys) {
    const std::uint32_t id =
        protocols::ubx::configuration_keys()[protocols::ubx::key_index(name)].id;
    put(id, 4);
    put(value, protocols::ubx::value_bytes(id));
  }
  std::vector<std::uint8_t> frame(payload.size() + protocols::ubx::kOverheadBytes);
  ASSERT_EQ(protocols::ubx::encode_frame({0x06, 0x8A}, payload, frame), frame.size());
  const auto before = one.receiver.counters().acknowledged;
  one.receiver.receive(kStart + std::chrono::milliseconds{900}, frame);
  EXPECT_EQ(one.receiver.counters().acknowledged, before + 1);
}

/// Lets all of them live up to `end`; `watch(now)` after each step.
inline void run_until(std::vector<ReceiverOnWires*> receivers, SimTime end,
                      const std::function<void(SimTime)>& watch = {}) {
  for (;;) {
    SimTime now = kNever;
    for (const ReceiverOnWires* one : receivers) {
      now = std::min(now, one->next());
    }
    if (now > end) {
      return;
    }
    for (ReceiverOnWires* one : receivers) {
      one->advance(now);
    }
    if (watch) {
      watch(now);
    }
  }
}

}  // namespace rigwire::hil
