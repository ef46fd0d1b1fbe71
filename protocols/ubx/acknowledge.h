// Answers to configuration messages (class 0x05).
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, section 32.8 "UBX-ACK".
#pragma once

#include <cstddef>
#include <cstdint>
#include <tuple>

#include "protocols/ubx/layout.h"

namespace rigwire::protocols::ubx {

/// ACK-ACK: the request `message_class`, `message_id` was carried out.
struct AckAck {
  static constexpr MessageId kId{0x05, 0x01};
  static constexpr std::size_t kLength = 2 /*id of the request*/;

  std::uint8_t message_class = 0;
  std::uint8_t message_id = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &AckAck::message_class), at(1, &AckAck::message_id));
  }
  friend bool operator==(const AckAck&, const AckAck&) = default;
};

/// ACK-NAK: it was refused.
struct AckNak {
  static constexpr MessageId kId{0x05, 0x00};
  static constexpr std::size_t kLength = 2 /*id of the request*/;

  std::uint8_t message_class = 0;
  std::uint8_t message_id = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &AckNak::message_class), at(1, &AckNak::message_id));
  }
  friend bool operator==(const AckNak&, const AckNak&) = default;
};

}  // namespace rigwire::protocols::ubx
