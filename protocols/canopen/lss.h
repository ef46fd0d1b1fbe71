// Layer setting services: how a master finds nodes by their identity (1018) and gives them a
// node-ID and a bit rate. Both directions are eight bytes: command specifier, then what it carries,
// least significant byte first, the rest 0.
//
// Source: CiA 305 V3.0.0, 4 (services), 5 (protocols).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace rigwire::protocols::canopen {

inline constexpr std::uint32_t kLssAnswerId = 0x7E4;   ///< Slave to master.
inline constexpr std::uint32_t kLssRequestId = 0x7E5;  ///< Master to slave.

/// The node-ID of a node that has none yet.
inline constexpr std::uint8_t kNoNodeId = 255;

enum class LssCommand : std::uint8_t {
  switch_state_global = 0x04,
  configure_node_id = 0x11,
  configure_bit_timing = 0x13,
  activate_bit_timing = 0x15,
  store_configuration = 0x17,
  select_vendor = 0x40,  ///< Then product, revision and serial number, to 0x43.
  select_serial = 0x43,
  selected = 0x44,              ///< Answer.
  identify_vendor = 0x46,       ///< Then product, min and max revision,
  identify_last_serial = 0x4B,  ///< min and max serial number.
  identify_unconfigured = 0x4C,
  identified = 0x4F,               ///< Answer.
  unconfigured_identified = 0x50,  ///< Answer.
  fastscan = 0x51,
  inquire_vendor = 0x5A,  ///< Then product, revision and serial number, to 0x5D.
  inquire_serial = 0x5D,
  inquire_node_id = 0x5E,
};

inline constexpr std::size_t kLssBytes = 8;
using LssPayload = std::array<std::uint8_t, kLssBytes>;

/// Numbers of the identity object (1018) in their order there.
inline constexpr std::size_t kLssIdentityNumbers = 4;
using LssIdentity = std::array<std::uint32_t, kLssIdentityNumbers>;

/// First byte of an answer to a configuration service.
inline constexpr std::uint8_t kLssDone = 0;
inline constexpr std::uint8_t kLssOutOfRange = 1;  ///< Node-ID; bit timing that is not supported.
inline constexpr std::uint8_t kLssRefused = 255;   ///< Implementation specific; the next byte 0.
inline constexpr std::uint8_t kLssNotStored = 2;   ///< The storage cannot be written.

/// BitCheck of a fastscan that every unconfigured node answers, and that begins anew.
inline constexpr std::uint8_t kFastscanReset = 0x80;

/// Table 0 of bit timings (CiA 305, table 1): bit/s of an index; nothing where it is reserved or
/// automatic.
[[nodiscard]] constexpr std::optional<std::uint32_t> lss_bit_rate_bps(std::uint8_t index) {
  constexpr std::array<std::uint32_t, 9> kRates{1'000'000, 800'000, 500'000, 250'000, 125'000,
                                                0,         50'000,  20'000,  10'000};
  return index < kRates.size() && kRates[index] != 0 ? std::optional(kRates[index]) : std::nullopt;
}

}  // namespace rigwire::protocols::canopen
