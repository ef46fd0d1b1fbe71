// Modbus on serial lines, RTU mode: the frame, its check, and the silences that delimit it.
//
//   offset  size  field
//   0       1     address: 0 broadcast, 1 .. 247 a unit, 248 .. 255 reserved
//   1       n     PDU, 1 .. 253 bytes
//   1 + n   2     CRC-16 of all before it, low byte first
//
// Nothing in a frame says where it ends: silence does. So there is no decoder of a stream here,
// only one of a whole frame; who receives finds its two ends by time.
//
// Source: MODBUS over Serial Line, Specification and Implementation Guide V1.02, sections 2.2
// (addresses), 2.5.1 (characters, frame, silences), 6.2.2 (CRC).
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

#include "protocols/modbus/constants.h"
#include "protocols/result.h"

namespace rigwire::protocols::modbus {

inline constexpr std::uint8_t kBroadcastAddress = 0;
inline constexpr std::uint8_t kUnitMaximum = 247;

inline constexpr std::size_t kRtuAddressSize = 1;
inline constexpr std::size_t kRtuCheckSize = 2;
inline constexpr std::size_t kRtuFrameMinimum = kRtuAddressSize + 1 /* function */ + kRtuCheckSize;
inline constexpr std::size_t kRtuFrameMaximum = kRtuAddressSize + kPduMaximum + kRtuCheckSize;
static_assert(kRtuFrameMinimum == 4 && kRtuFrameMaximum == 256);

/// Returns the checksum: polynomial 8005 hex reflected, start FFFF hex. Over a frame with its own
/// checksum: 0.
[[nodiscard]] std::uint16_t crc16(std::span<const std::uint8_t> bytes);
/// Returns the checksum `before` of the preceding bytes, continued by `byte`.
[[nodiscard]] std::uint16_t crc16(std::uint16_t before, std::uint8_t byte);
inline constexpr std::uint16_t kCrcStart = 0xFFFF;

/// `pdu` points into the bytes given to decode_rtu and is never empty.
struct RtuFrame {
  std::uint8_t address = 0;
  std::span<const std::uint8_t> pdu;
};

/// All of `frame`, between two silences. Malformed when it is shorter than 4 bytes, longer than 256
/// or its check is wrong; never incomplete.
[[nodiscard]] Decoded<RtuFrame> decode_rtu(std::span<const std::uint8_t> frame);

/// Encoded bytes, address first; no allocation.
struct RtuBytes {
  std::array<std::uint8_t, kRtuFrameMaximum> bytes{};
  std::size_t size = 0;
  [[nodiscard]] std::span<const std::uint8_t> view() const { return std::span(bytes).first(size); }
};

/// Precondition: pdu has 1 .. kPduMaximum bytes.
[[nodiscard]] RtuBytes encode_rtu(std::uint8_t address, std::span<const std::uint8_t> pdu);

/// How a character lies on the line. The standard asks for 11 bits whatever the parity; 8N1 with
/// 10 bits is common all the same.
enum class SerialCharacter : std::uint8_t { even_8e1, odd_8o1, none_8n2, none_8n1 };

/// Start, data, parity, stop.
[[nodiscard]] constexpr unsigned bits_of(SerialCharacter character) {
  return character == SerialCharacter::none_8n1 ? 1 + 8 + 1 : 1 + 8 + 2;
}

/// The times of one line.
struct RtuTiming {
  std::uint32_t baud = 19'200;  ///< bit/s, not 0.
  SerialCharacter character = SerialCharacter::even_8e1;

  /// `count` characters without a gap, to the nanosecond below; no rounding adds up.
  [[nodiscard]] std::chrono::nanoseconds characters(std::uint64_t count) const;
  /// t1.5: more silence than this inside a frame spoils it. 750 us above 19200 bit/s.
  [[nodiscard]] std::chrono::nanoseconds inside_limit() const;
  /// t3.5: this much silence ends a frame. 1750 us above 19200 bit/s.
  [[nodiscard]] std::chrono::nanoseconds frame_silence() const;
};

}  // namespace rigwire::protocols::modbus
