// The UBX frame: how u-blox receivers wrap every binary message.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, sections 32.2 "UBX Frame Structure" and
// 32.4 "UBX Checksum"; the same for protocol 14 (u-blox 7), checked against recorded frames.
//
//   0xB5 0x62 | class | id | length, 16 bit, least significant byte first | payload | CK_A CK_B
//
// The checksum is the 8-bit Fletcher sum over class, id, length and payload.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "protocols/result.h"

namespace rigwire::protocols::ubx {

inline constexpr std::uint8_t kSync1 = 0xB5;
inline constexpr std::uint8_t kSync2 = 0x62;
inline constexpr std::size_t kHeaderBytes = 2 /*sync*/ + 1 /*class*/ + 1 /*id*/ + 2 /*length*/;
inline constexpr std::size_t kChecksumBytes = 1 /*CK_A*/ + 1 /*CK_B*/;
inline constexpr std::size_t kOverheadBytes = kHeaderBytes + kChecksumBytes;
static_assert(kOverheadBytes == 8);

/// Class and id of a message.
struct MessageId {
  std::uint8_t message_class = 0;
  std::uint8_t message_id = 0;

  friend constexpr bool operator==(const MessageId&, const MessageId&) = default;
  friend constexpr auto operator<=>(const MessageId&, const MessageId&) = default;
};

/// One frame; the payload points into the bytes it was decoded from.
struct FrameView {
  MessageId id;
  std::span<const std::uint8_t> payload;
};

struct Checksum {
  std::uint8_t a = 0;
  std::uint8_t b = 0;

  friend constexpr bool operator==(const Checksum&, const Checksum&) = default;
};

/// Fletcher sum of `bytes`: everything between the sync characters and the checksum.
[[nodiscard]] Checksum checksum(std::span<const std::uint8_t> bytes);

/// Decodes the frame that starts at bytes[0]. Malformed when the sync characters are not there, the
/// length exceeds `maximum_payload`, or the checksum is wrong; incomplete while a correct beginning
/// is cut off. After malformed, drop find_sync(bytes, 1) bytes and try again.
[[nodiscard]] Decoded<FrameView> decode_frame(std::span<const std::uint8_t> bytes,
                                              std::size_t maximum_payload = 0xFFFF);

/// Offset of the first place at or after `from` where a frame may begin: both sync characters, or
/// the first one as the very last byte. bytes.size() when there is none.
[[nodiscard]] std::size_t find_sync(std::span<const std::uint8_t> bytes, std::size_t from);

/// Writes header and checksum around a payload that is already at frame[kHeaderBytes].
/// Precondition: kOverheadBytes <= frame.size() <= kOverheadBytes + 65535.
void seal_frame(MessageId id, std::span<std::uint8_t> frame);

/// Writes a whole frame into `out` and returns its size; 0 when `out` is too small or the payload
/// longer than 65535 bytes.
[[nodiscard]] std::size_t encode_frame(MessageId id, std::span<const std::uint8_t> payload,
                                       std::span<std::uint8_t> out);

}  // namespace rigwire::protocols::ubx
