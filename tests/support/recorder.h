// Outputs that keep what a device under test sends, and hold that it is due in order.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "emulators/device.h"
#include "protocols/j1939/message.h"
#include "protocols/vehicle/message.h"

namespace rigwire::test {

class ByteRecorder final : public emulators::ByteOutput {
 public:
  struct Sent {
    SimTime due;
    std::vector<std::uint8_t> bytes;
  };
  void send(SimTime due, std::span<const std::uint8_t> bytes) override {
    EXPECT_TRUE(sent.empty() || due >= sent.back().due) << "due times went back";
    sent.push_back({due, {bytes.begin(), bytes.end()}});
  }
  /// All of it, in one piece.
  [[nodiscard]] std::string text() const {
    std::string all;
    for (const Sent& each : sent) {
      all.append(each.bytes.begin(), each.bytes.end());
    }
    return all;
  }
  std::vector<Sent> sent;
};

class FrameRecorder final : public emulators::FrameOutput {
 public:
  void send(SimTime due, const protocols::can::Frame& frame) override {
    EXPECT_GE(due, last_) << "due times went back";
    last_ = due;
    frames.emplace_back(due, frame);
  }
  /// Frames with one identifier, oldest first.
  [[nodiscard]] std::vector<std::pair<SimTime, protocols::can::Frame>> with_id(
      std::uint32_t id) const {
    std::vector<std::pair<SimTime, protocols::can::Frame>> found;
    for (const auto& entry : frames) {
      if (entry.second.id == id) {
        found.push_back(entry);
      }
    }
    return found;
  }
  /// When frames of one J1939 group were due.
  [[nodiscard]] std::vector<SimTime> times(std::uint32_t pgn) const {
    std::vector<SimTime> found;
    for (const auto& [due, frame] : frames) {
      if (protocols::j1939::unpack(frame.id).pgn == pgn) {
        found.push_back(due);
      }
    }
    return found;
  }
  /// Frames of one J1939 group, oldest first.
  [[nodiscard]] std::vector<protocols::can::Frame> of(std::uint32_t pgn) const {
    std::vector<protocols::can::Frame> found;
    for (const auto& [due, frame] : frames) {
      if (protocols::j1939::unpack(frame.id).pgn == pgn) {
        found.push_back(frame);
      }
    }
    return found;
  }
  /// The latest message of its kind; a failure, and everything not available, when there is none.
  template <class Message>
  [[nodiscard]] Message latest() const {
    const auto found = of(Message::kGroup.pgn);
    if (found.empty()) {
      ADD_FAILURE() << "no " << Message::kGroup.name;
      return {};
    }
    const auto decoded = protocols::vehicle::decode<Message>(found.back());
    EXPECT_TRUE(decoded.ok());
    return decoded.ok() ? *decoded : Message{};
  }
  std::vector<std::pair<SimTime, protocols::can::Frame>> frames;

 private:
  SimTime last_ = kStart;
};

}  // namespace rigwire::test
