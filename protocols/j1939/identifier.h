// The 29-bit identifier of SAE J1939-21, 5.2: priority 3, extended data page 1, data page 1,
// PDU format 8, PDU specific 8, source address 8 (most significant first).
//
// PDU format below 240 (PDU1): PDU specific is the destination and not part of the parameter group
// number. From 240 up (PDU2): it belongs to the number, and the message is for everybody.
#pragma once

#include <cstdint>

namespace rigwire::protocols::j1939 {

/// Destination of everybody.
inline constexpr std::uint8_t kGlobalAddress = 0xFF;
/// Source of a node that has no address.
inline constexpr std::uint8_t kNullAddress = 0xFE;

struct Identifier {
  std::uint8_t priority = 6;                  ///< 0 (first) .. 7.
  std::uint32_t pgn = 0;                      ///< 18 bits; low byte 0 when PDU1.
  std::uint8_t destination = kGlobalAddress;  ///< Always global for PDU2.
  std::uint8_t source = kNullAddress;

  friend bool operator==(const Identifier&, const Identifier&) = default;
};

/// Whether messages of this parameter group carry a destination (PDU format below 240).
[[nodiscard]] constexpr bool is_addressed(std::uint32_t pgn) {
  return ((pgn >> 8U) & 0xFFU) < 240U;
}

/// Out-of-range bits are dropped; the destination of a PDU2 group is not used.
[[nodiscard]] constexpr std::uint32_t pack(const Identifier& identifier) {
  const std::uint32_t group = identifier.pgn & 0x3FFFFU;
  const std::uint32_t specific =
      is_addressed(group) ? (group & 0x3FF00U) | identifier.destination : group;
  return ((identifier.priority & 7U) << 26U) | (specific << 8U) | identifier.source;
}

/// The parts of a 29-bit identifier; higher bits are ignored.
[[nodiscard]] constexpr Identifier unpack(std::uint32_t id) {
  Identifier identifier;
  identifier.priority = static_cast<std::uint8_t>((id >> 26U) & 7U);
  identifier.pgn = (id >> 8U) & 0x3FFFFU;
  identifier.source = static_cast<std::uint8_t>(id & 0xFFU);
  if (is_addressed(identifier.pgn)) {
    identifier.destination = static_cast<std::uint8_t>(identifier.pgn & 0xFFU);
    identifier.pgn &= 0x3FF00U;
  }
  return identifier;
}

}  // namespace rigwire::protocols::j1939
