// An emulated receiver under test: the truth that it is fed with, and the wire that it sends on.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "emulators/ublox/receiver.h"
#include "protocols/nmea/sentence.h"
#include "protocols/ubx/configuration.h"
#include "protocols/ubx/frame.h"
#include "protocols/ubx/navigation.h"

namespace rigwire::emulators {

using Bytes = std::vector<std::uint8_t>;

/// The wire out of the receiver: holds that bytes come in order and in chunks, and reads them.
class UbloxLine final : public ByteOutput {
 public:
  void send(SimTime due, std::span<const std::uint8_t> bytes) override {
    EXPECT_GE(due, last_due);
    EXPECT_LE(bytes.size(), 8U);
    EXPECT_FALSE(bytes.empty());
    if (first_due == kNever) {
      first_due = due;
    }
    last_due = due;
    all.insert(all.end(), bytes.begin(), bytes.end());
  }
  void clear() {
    all.clear();
    first_due = kNever;
  }
  std::string text() const { return {all.begin(), all.end()}; }
  std::vector<std::string> sentences() const {
    std::vector<std::string> found;
    for (std::size_t at = 0; at < all.size();) {
      const auto rest = std::span(all).subspan(at);
      if (const auto s = protocols::nmea::decode_sentence(rest); s.ok()) {
        found.emplace_back(rest.begin(), rest.begin() + std::ptrdiff_t(s.consumed()) - 2);
        at += s.consumed();
      } else if (const auto f = protocols::ubx::decode_frame(rest); f.ok()) {
        at += f.consumed();
      } else {
        ADD_FAILURE() << "garbage on the line at " << at;
        break;
      }
    }
    return found;
  }
  std::vector<std::pair<protocols::ubx::MessageId, Bytes>> frames() const {
    std::vector<std::pair<protocols::ubx::MessageId, Bytes>> found;
    for (std::size_t at = 0; at < all.size();) {
      const auto rest = std::span(all).subspan(at);
      if (const auto f = protocols::ubx::decode_frame(rest); f.ok()) {
        found.emplace_back(f->id, Bytes(f->payload.begin(), f->payload.end()));
        at += f.consumed();
      } else if (const auto s = protocols::nmea::decode_sentence(rest); s.ok()) {
        at += s.consumed();
      } else {
        ADD_FAILURE() << "garbage on the line at " << at;
        break;
      }
    }
    return found;
  }
  Bytes all;
  SimTime first_due = kNever;
  SimTime last_due{};
};

/// A machine that drives north-east and up, seen by eight satellites.
inline GnssSample good_sample(SimTime time) {
  GnssSample sample;
  sample.time = time;
  sample.fix = GnssFix::three_d;
  sample.latitude_deg = 49.4240123;
  sample.longitude_deg = -7.7510456;
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

class UbloxReceiverTest : public testing::Test {
 protected:
  UbloxSettings quiet() const {
    UbloxSettings settings;
    settings.nmea_sentences.clear();
    settings.start_banner = false;
    settings.baud = 115200;
    return settings;
  }
  /// Feeds samples as planned until `until`, then lets everything leave.
  void run(UbloxReceiver& receiver, SimTime until,
           const std::function<void(GnssSample&)>& change = {}) {
    while (true) {
      const SimTime next = receiver.sample_plan().next_after(now_);
      const SimTime event = receiver.next_event();
      const SimTime step = std::min(next, event);
      if (step > until) {
        break;
      }
      receiver.advance(step);
      now_ = std::max(now_, step);
      if (next == step) {
        GnssSample sample = good_sample(step);
        if (change) {
          change(sample);
        }
        receiver.update(sample);
      }
    }
    receiver.advance(until);
    now_ = until;
  }
  template <class Message>
  std::vector<Message> decoded() const {
    std::vector<Message> found;
    for (const auto& [id, payload] : line_.frames()) {
      if (id == Message::kId) {
        EXPECT_EQ(payload.size(), Message::kLength);
        found.push_back(protocols::ubx::read_payload<Message>(payload));
      }
    }
    return found;
  }
  std::vector<protocols::ubx::MessageId> ids() const {
    std::vector<protocols::ubx::MessageId> found;
    for (const auto& [id, payload] : line_.frames()) {
      found.push_back(id);
    }
    return found;
  }
  void say(UbloxReceiver& receiver, protocols::ubx::MessageId id, const Bytes& payload) {
    Bytes frame(protocols::ubx::kOverheadBytes + payload.size());
    ASSERT_EQ(protocols::ubx::encode_frame(id, payload, frame), frame.size());
    receiver.receive(now_, frame);
  }
  template <class Message>
  void say(UbloxReceiver& receiver, const Message& message) {
    receiver.receive(now_, encode(message));
  }

  Calendar calendar_{UtcTime{2026, 6, 1, 8, 0, 0, 0}};
  UbloxLine line_;
  SimTime now_ = kStart;
};

}  // namespace rigwire::emulators
