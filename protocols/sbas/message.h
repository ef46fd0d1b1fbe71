// Messages of satellite based augmentation (WAAS, EGNOS, MSAS, GAGAN): 250 bits a second, of which
// 8 of preamble, 6 of type, 212 of content, 24 of CRC-24Q over all before.
//
// Source: RTCA DO-229, appendix A.4, as RTKLIB's sbas.c reads it; the cycle of the preambles and
// how u-blox receivers hand the words on, recordings of a NEO-7P.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <span>

#include "protocols/result.h"

namespace rigwire::protocols::sbas {

inline constexpr std::size_t kMessageBits = 8 /*preamble*/ + 6 /*type*/ + 212 /*content*/ + 24;
inline constexpr std::size_t kWords = 8;
/// Satellites of the mask: GPS 1..37, then GLONASS and others.
inline constexpr std::size_t kMaskedSatellites = 210;

inline constexpr std::uint8_t kTypeMask = 1;
inline constexpr std::uint8_t kTypeFirstFastCorrections = 2;
inline constexpr std::uint8_t kTypeDegradation = 7;
inline constexpr std::uint8_t kTypeNull = 63;

/// The bits in their order, 32 in each word; the last word holds 26, most significant first.
struct Message {
  std::array<std::uint32_t, kWords> words{};

  friend bool operator==(const Message&, const Message&) = default;
};

/// Returns a null message. `second` of the week selects the preamble: 0x53, 0x9A, 0xC6 in turn.
[[nodiscard]] Message null_message(std::uint32_t second);

/// Returns the mask of the satellites with corrections; bit n of `gps` is GPS satellite n + 1.
/// `issue` 0..3.
[[nodiscard]] Message mask_message(std::uint32_t second, const std::bitset<32>& gps,
                                   std::uint8_t issue);

/// A fast correction of one satellite of the mask.
struct FastCorrection {
  std::int16_t range_steps = 0;  ///< Range correction in steps of 0.125 m, +-256 m.
  std::uint8_t error_index =
      14;  ///< UDREI: 0..13 by growing error, 14 not monitored, 15 not to use.
};
inline constexpr std::size_t kFastCorrections = 13;

/// Type 2 + `block`: corrections of the satellites 13 x block ... of the mask. More than
/// kFastCorrections are left out. block 0..3, issues 0..3.
[[nodiscard]] Message fast_corrections(std::uint32_t second, std::uint8_t block,
                                       std::span<const FastCorrection> corrections,
                                       std::uint8_t issue, std::uint8_t mask_issue);

/// How fast corrections age: not at all. `mask_issue` 0..3.
[[nodiscard]] Message degradation_message(std::uint32_t second, std::uint8_t mask_issue);

/// The type of a message whose preamble and checksum are right.
[[nodiscard]] Decoded<std::uint8_t> decode_type(const Message& message);

}  // namespace rigwire::protocols::sbas
