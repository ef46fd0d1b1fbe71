// The 64-bit NAME of SAE J1939-81, 4.1.1: who a node is. In address contention the lower NAME wins.
#pragma once

#include <cstdint>

namespace rigwire::protocols::j1939 {

/// Bit positions from the least significant end, as in the claim's payload (little-endian).
struct Name {
  std::uint32_t identity = 0;          ///< 21 bits, 0..20: serial number.
  std::uint16_t manufacturer = 0;      ///< 11 bits, 21..31.
  std::uint8_t ecu_instance = 0;       ///< 3 bits, 32..34.
  std::uint8_t function_instance = 0;  ///< 5 bits, 35..39.
  std::uint8_t function = 0;           ///< 8 bits, 40..47.
  std::uint8_t vehicle_system = 0;     ///< 7 bits, 49..55 (bit 48 reserved, 0).
  std::uint8_t system_instance = 0;    ///< 4 bits, 56..59.
  std::uint8_t industry_group = 0;     ///< 3 bits, 60..62.
  bool arbitrary_address = false;      ///< Bit 63: may take another address when it loses.

  friend bool operator==(const Name&, const Name&) = default;
};

/// Out-of-range bits are dropped.
[[nodiscard]] std::uint64_t pack(const Name& name);
/// The reserved bit 48 is not kept.
[[nodiscard]] Name unpack_name(std::uint64_t bits);

}  // namespace rigwire::protocols::j1939
