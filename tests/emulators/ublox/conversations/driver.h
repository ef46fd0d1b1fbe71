// What every scripted driver has: its own reader and writer of UBX frames (nothing of protocols/,
// so that a defect there cannot hide itself), and the waits with a time limit that real drivers
// make.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <utility>

#include "serial_line.h"

namespace rigwire::emulators::conversation {

struct Frame {
  std::uint8_t kind = 0;  ///< Class.
  std::uint8_t id = 0;
  Bytes payload;

  [[nodiscard]] bool is(std::uint8_t k, std::uint8_t i) const { return kind == k && id == i; }
  [[nodiscard]] std::uint32_t u8(std::size_t at) const { return payload.at(at); }
  [[nodiscard]] std::uint32_t u16(std::size_t at) const { return u8(at) | u8(at + 1) << 8; }
  [[nodiscard]] std::uint32_t u32(std::size_t at) const { return u16(at) | u16(at + 2) << 16; }
  [[nodiscard]] std::string text(std::size_t at, std::size_t length) const {
    std::string field(payload.begin() + std::ptrdiff_t(at),
                      payload.begin() + std::ptrdiff_t(at + length));
    return field.substr(0, field.find('\0'));
  }
};

/// Little-endian bytes, written one field after the other.
class Payload {
 public:
  Payload& u8(std::uint32_t value) { return put(value, 1); }
  Payload& u16(std::uint32_t value) { return put(value, 2); }
  Payload& u32(std::uint32_t value) { return put(value, 4); }
  Payload& zeros(std::size_t count) {
    bytes.insert(bytes.end(), count, 0);
    return *this;
  }
  Bytes bytes;

 private:
  Payload& put(std::uint32_t value, int count) {
    for (int i = 0; i < count; ++i) {
      bytes.push_back(static_cast<std::uint8_t>(value >> 8 * i));
    }
    return *this;
  }
};

[[nodiscard]] inline std::pair<std::uint8_t, std::uint8_t> checksum(
    std::span<const std::uint8_t> bytes) {
  unsigned a = 0;
  unsigned b = 0;
  for (const std::uint8_t byte : bytes) {
    a = (a + byte) & 0xFFU;
    b = (b + a) & 0xFFU;
  }
  return {static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b)};
}

[[nodiscard]] inline Bytes make_frame(std::uint8_t kind, std::uint8_t id, const Bytes& payload) {
  Payload head;
  head.u8(0xB5).u8(0x62).u8(kind).u8(id).u16(static_cast<std::uint32_t>(payload.size()));
  Bytes frame = std::move(head.bytes);
  for (const std::uint8_t byte : payload) {
    frame.push_back(byte);
  }
  const auto [a, b] = checksum(std::span(frame).subspan(2));
  frame.push_back(a);
  frame.push_back(b);
  return frame;
}

/// Finds frames in a stream, skipping what is none.
class FrameReader {
 public:
  void put(const Bytes& bytes) { buffer_.insert(buffer_.end(), bytes.begin(), bytes.end()); }
  void reset() { buffer_.clear(); }
  /// Bytes that belonged to no frame so far.
  [[nodiscard]] const Bytes& other() const { return other_; }
  void forget_other() { other_.clear(); }

  [[nodiscard]] std::optional<Frame> next() {
    std::size_t at = 0;
    std::optional<Frame> found;
    while (at < buffer_.size()) {
      const auto rest = std::span(buffer_).subspan(at);
      if (rest[0] != 0xB5 || (rest.size() > 1 && rest[1] != 0x62)) {
        other_.push_back(rest[0]);
        ++at;
        continue;
      }
      if (rest.size() < 8) {
        break;
      }
      const std::size_t length = rest[4] | std::size_t{rest[5]} << 8;
      if (length > 2048) {
        other_.push_back(rest[0]);
        ++at;
        continue;
      }
      if (rest.size() < length + 8) {
        break;
      }
      const auto [a, b] = checksum(rest.subspan(2, 4 + length));
      if (rest[6 + length] != a || rest[7 + length] != b) {
        other_.push_back(rest[0]);
        ++at;
        continue;
      }
      found = Frame{rest[2], rest[3],
                    Bytes(rest.begin() + 6, rest.begin() + 6 + std::ptrdiff_t(length))};
      at += length + 8;
      break;
    }
    buffer_.erase(buffer_.begin(), buffer_.begin() + std::ptrdiff_t(at));
    return found;
  }

 private:
  Bytes buffer_;
  Bytes other_;
};

enum class Reply { acknowledged, refused, silence };

class Driver {
 public:
  explicit Driver(SerialLine& line) : line_(line) {}

  /// Why the driver would have given up; empty while it has not.
  [[nodiscard]] const std::string& reason() const { return reason_; }
  /// The longest that it waited for an answer which came.
  [[nodiscard]] Duration slowest_reply() const { return slowest_; }

 protected:
  [[nodiscard]] SimTime now() const { return line_.now(); }

  void send(std::uint8_t kind, std::uint8_t id, const Bytes& payload = {}) {
    line_.write(make_frame(kind, id, payload));
  }

  /// The next frame that has arrived before `deadline`.
  [[nodiscard]] std::optional<Frame> next_frame(SimTime deadline) {
    while (true) {
      if (auto frame = reader_.next()) {
        return frame;
      }
      const Bytes bytes = line_.read_until(deadline);
      if (bytes.empty()) {
        return std::nullopt;
      }
      reader_.put(bytes);
    }
  }

  /// The acknowledgement of class and id within `limit`; other frames meanwhile go to `see`.
  template <class See>
  [[nodiscard]] Reply wait_for_reply(std::uint8_t kind, std::uint8_t id, Duration limit,
                                     See&& see) {
    const SimTime asked = now();
    while (const auto frame = next_frame(asked + limit)) {
      if (frame->kind == 0x05 && frame->payload.size() == 2 && frame->u8(0) == kind &&
          frame->u8(1) == id) {
        slowest_ = std::max(slowest_, now() - asked);
        return frame->id == 0x01 ? Reply::acknowledged : Reply::refused;
      }
      see(*frame);
    }
    return Reply::silence;
  }
  [[nodiscard]] Reply wait_for_reply(std::uint8_t kind, std::uint8_t id, Duration limit) {
    return wait_for_reply(kind, id, limit, [](const Frame&) {});
  }

  /// The message itself within `limit`, as the answer to a poll.
  [[nodiscard]] std::optional<Frame> wait_for_message(std::uint8_t kind, std::uint8_t id,
                                                      Duration limit) {
    const SimTime asked = now();
    while (auto frame = next_frame(asked + limit)) {
      if (frame->is(kind, id)) {
        slowest_ = std::max(slowest_, now() - asked);
        return frame;
      }
    }
    return std::nullopt;
  }

  bool give_up(const std::string& reason) {
    std::ostringstream text;
    text << reason << " (at " << to_seconds(now()) << " s)";
    reason_ = text.str();
    return false;
  }

  SerialLine& line_;
  FrameReader reader_;

 private:
  std::string reason_;
  Duration slowest_{0};
};

}  // namespace rigwire::emulators::conversation
