// Subframes: ten words, 300 bits, 6 s. How each begins, and how its words hang together.
//
// Source: IS-GPS-200 sections 20.3.2 (structure), 20.3.3.1 (telemetry word), 20.3.3.2 (hand-over
// word), 20.3.5.2 (parity from word to word). Words are numbered 1..10 in the document, 0..9 here.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "protocols/gps/word.h"
#include "protocols/result.h"

namespace rigwire::protocols::gps {

inline constexpr std::size_t kWords = 10;
inline constexpr std::int32_t kStepSeconds = 6;  ///< One subframe.
inline constexpr std::int32_t kWeekSeconds = 604'800;
inline constexpr std::uint32_t kStepsPerWeek = kWeekSeconds / kStepSeconds;
inline constexpr std::uint32_t kPreamble = 0x8B;

/// The 24 data bits of each word, true polarity, the bit sent first in bit 23.
struct SubframeData {
  std::array<std::uint32_t, kWords> words{};

  friend bool operator==(const SubframeData&, const SubframeData&) = default;
};

/// The 30 bits of each word as the satellite sends them, the bit sent first in bit 29.
struct Subframe {
  std::array<std::uint32_t, kWords> words{};

  friend bool operator==(const Subframe&, const Subframe&) = default;
};

/// Telemetry and hand-over word.
struct Head {
  std::uint16_t telemetry_message = 0;  ///< 14 bits, not for civil users.
  bool integrity_status = false;
  /// Time of week, in steps of 6 s, at which the NEXT subframe begins; 0..100799.
  std::uint32_t next_step = 0;
  bool alert = false;  ///< The range error may be worse than the accuracy index says.
  bool anti_spoof = true;
  std::uint8_t subframe_id = 1;  ///< 1..5.

  friend bool operator==(const Head&, const Head&) = default;
};

/// Writes words 1 and 2. Precondition: next_step < 100800, subframe_id 1..5, telemetry_message
/// < 2^14.
void set_head(SubframeData& data, const Head& head);

/// Words 1 and 2. Malformed when the preamble is wrong (offset 0), or the time of week or the
/// subframe id is impossible (offset 1); offsets count words.
[[nodiscard]] Decoded<Head> head(const SubframeData& data);

/// The subframe as sent. The last two bits of words 2 and 10 are not data: they are chosen here so
/// that these words end in zeros, which lets every subframe begin with D29* = D30* = 0.
[[nodiscard]] Subframe encode_subframe(const SubframeData& data);

/// Malformed when the parity of a word is wrong or the preamble is not there; the offset counts
/// words.
[[nodiscard]] Decoded<SubframeData> decode_subframe(const Subframe& subframe);

/// The words of a subframe as receivers hand them on: true_polarity() of each.
[[nodiscard]] std::array<std::uint32_t, kWords> true_polarity(const Subframe& subframe);

}  // namespace rigwire::protocols::gps
