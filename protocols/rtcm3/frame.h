// Frames of RTCM 3: 0xD3, six zero bits, ten bits of length, payload, CRC-24Q.
//
// Source: RTCM 10403, "Transport layer", as RTKLIB and pyrtcm read it; lengths checked against
// recordings. What a payload says, message.h decodes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "protocols/result.h"

namespace rigwire::protocols::rtcm3 {

inline constexpr std::uint8_t kPreamble = 0xD3;
inline constexpr std::size_t kHeaderBytes = 3 /*preamble, length*/;
inline constexpr std::size_t kChecksumBytes = 3;
inline constexpr std::size_t kGreatestPayload = 1023;
inline constexpr std::size_t kGreatestFrame = kHeaderBytes + kGreatestPayload + kChecksumBytes;

/// A frame whose checksum holds; points into the bytes that it was decoded from.
struct FrameView {
  std::span<const std::uint8_t> payload;

  /// 0 when the payload is too short to say it.
  [[nodiscard]] std::uint16_t message() const;
  /// The twelve bits after the number: the station, or the subtype of a message 4072.
  [[nodiscard]] std::uint16_t second_field() const;
};

/// Malformed when the bytes do not begin with a frame, or its checksum is wrong.
[[nodiscard]] Decoded<FrameView> decode_frame(std::span<const std::uint8_t> bytes);

/// Writes the frame around a payload; its size. Precondition: at most kGreatestPayload bytes, and
/// `out` holds them with header and checksum.
std::size_t encode_frame(std::span<const std::uint8_t> payload, std::span<std::uint8_t> out);

}  // namespace rigwire::protocols::rtcm3
