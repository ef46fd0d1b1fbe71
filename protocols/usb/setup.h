// The eight bytes that begin a control transfer, and what is in the first of them.
//
// Source: Universal Serial Bus Specification 2.0, 9.3, table 9-2.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "protocols/bytes.h"
#include "protocols/usb/constants.h"
#include "protocols/usb/transfer.h"

namespace rigwire::protocols::usb {

inline constexpr std::size_t kSetupSize =
    1 /* request type */ + 1 /* request */ + 2 /* value */ + 2 /* index */ + 2 /* length */;
static_assert(kSetupSize == 8);

using SetupBytes = std::array<std::uint8_t, kSetupSize>;

[[nodiscard]] constexpr Setup decode_setup(std::span<const std::uint8_t, kSetupSize> bytes) {
  return {bytes[0], bytes[1], load_little<std::uint16_t>(bytes, 2),
          load_little<std::uint16_t>(bytes, 4), load_little<std::uint16_t>(bytes, 6)};
}

[[nodiscard]] constexpr SetupBytes encode_setup(const Setup& setup) {
  SetupBytes bytes{setup.request_type, setup.request};
  store_little(bytes, 2, setup.value);
  store_little(bytes, 4, setup.index);
  store_little(bytes, 6, setup.length);
  return bytes;
}

[[nodiscard]] constexpr RequestKind kind_of(const Setup& setup) {
  return static_cast<RequestKind>((setup.request_type >> 5U) & 3U);
}
[[nodiscard]] constexpr std::uint8_t recipient_number(const Setup& setup) {
  return setup.request_type & 0x1FU;
}
[[nodiscard]] constexpr bool is_for(const Setup& setup, Recipient recipient) {
  return recipient_number(setup) == static_cast<std::uint8_t>(recipient);
}

/// The first byte, from its parts.
[[nodiscard]] constexpr std::uint8_t request_type(bool to_host, RequestKind kind,
                                                  Recipient recipient) {
  return static_cast<std::uint8_t>((to_host ? 0x80U : 0U) | (static_cast<unsigned>(kind) << 5U) |
                                   static_cast<unsigned>(recipient));
}

}  // namespace rigwire::protocols::usb
