// The configuration items of ZED-F9P (HPG 1.50): number, name, type, unit, limits and default of
// each.
//
// Source: u-blox F9 HPG 1.50 interface description, UBXDOC-963802114-12815, sections 6.1
// "Configuration items", 6.9 "Configuration reference" and "Configuration defaults"; every number
// and type compared with the lists of pyubx2, ubloxcfg and gpsd 3.22. (gpsd differs in six items of
// NAV-SLAS and NAV-TIMEQZSS, where the other three agree.)
//
// A key id says the value's size in bits 28..30 (1: one bit, 2: 1 byte, 3: 2, 4: 4, 5: 8 bytes),
// the group in bits 16..27 and the item in bits 0..15.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "protocols/ubx/frame.h"

namespace rigwire::protocols::ubx {

/// Flag, unsigned, bit field, enumeration, signed, floating point; the number is the width in
/// bytes.
enum class KeyType : std::uint8_t { l, u1, u2, u4, x1, x2, x8, e1, i1, i2, i4, r4, r8 };

/// Bytes that the value of this key takes on the wire; 0 when the id has no valid size.
[[nodiscard]] constexpr std::size_t value_bytes(std::uint32_t key) {
  switch (key >> 28U & 7U) {
    case 1:
    case 2:
      return 1;
    case 3:
      return 2;
    case 4:
      return 4;
    case 5:
      return 8;
    default:
      return 0;
  }
}

inline constexpr std::uint32_t kGroupMask = 0x0FFF0000;
inline constexpr std::uint32_t kItemMask = 0x0000FFFF;

/// Every item of the key's group.
[[nodiscard]] constexpr bool is_group_wildcard(std::uint32_t key) {
  return (key & kItemMask) == kItemMask;
}
/// Every item of every group.
[[nodiscard]] constexpr bool is_full_wildcard(std::uint32_t key) {
  return (key & kGroupMask) == kGroupMask;
}

struct ConfigurationKey {
  std::uint32_t id = 0;
  KeyType type = KeyType::l;
  std::string_view name;      ///< "CFG-RATE-MEAS".
  std::uint64_t initial = 0;  ///< Default, as its bytes are on the wire.
  std::int64_t lower = 0;     ///< Limits of the number on the wire; unused for floating point
  std::int64_t upper = 0;     ///< and 8-byte bit fields.
  std::uint64_t choices = 0;  ///< Bit v: v is allowed; 0: every number within the limits.
  double scale = 1.0;         ///< Unit per count.
  std::string_view unit;      ///< Empty when there is none.
};

/// Whether the wire value fits the item. A floating point number must be finite.
[[nodiscard]] bool is_allowed(const ConfigurationKey& key, std::uint64_t value);

/// All items by their whole id, size first: the order in which wildcards list them (a ZED-F9P's
/// answers to VALGET of everything, u-center's log of one, HPG 1.32).
[[nodiscard]] std::span<const ConfigurationKey> configuration_keys();

/// Index in configuration_keys(); its size when unknown.
[[nodiscard]] std::size_t key_index(std::uint32_t id);
[[nodiscard]] std::size_t key_index(std::string_view name);

/// Whether a key or wildcard names that item.
[[nodiscard]] constexpr bool names(std::uint32_t wanted, std::uint32_t id) {
  return is_full_wildcard(wanted) ||
         (is_group_wildcard(wanted) ? ((wanted ^ id) & kGroupMask) == 0 : wanted == id);
}

/// Output rates of one message: five consecutive keys, for the ports in the order of CFG-PRT (I2C,
/// UART1, UART2, USB, SPI).
struct MessageRateKeys {
  std::uint32_t first = 0;
  std::string_view name;  ///< "UBX_NAV_PVT".
  MessageId message;
  std::uint8_t initial = 0;  ///< Default rate on every port.
};
inline constexpr std::size_t kMessageRatePorts = 5;

/// By key.
[[nodiscard]] std::span<const MessageRateKeys> message_rate_keys();

}  // namespace rigwire::protocols::ubx
