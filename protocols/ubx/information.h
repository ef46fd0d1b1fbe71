// INF: lines of text from the receiver (class 0x04), the same as the TXT sentences of NMEA.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, section 32.13 "UBX-INF". The text is
// not terminated.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "protocols/ubx/frame.h"

namespace rigwire::protocols::ubx {

/// The values are the message's id and the bit of CFG-INF's mask.
enum class InformationKind : std::uint8_t {
  error = 0,
  warning = 1,
  notice = 2,
  test = 3,
  debug = 4
};

inline constexpr std::uint8_t kInformationClass = 0x04;

struct Information {
  InformationKind kind = InformationKind::notice;
  std::string_view text;  ///< Points into the bytes it was decoded from.

  friend bool operator==(const Information&, const Information&) = default;
};

/// Writes a whole frame into `out` and returns its size; 0 when `out` is too small.
[[nodiscard]] std::size_t encode_information(const Information& information,
                                             std::span<std::uint8_t> out);

/// Malformed when the frame is of another class, or its id none of the five.
[[nodiscard]] Decoded<Information> decode_information(const FrameView& frame);

}  // namespace rigwire::protocols::ubx
