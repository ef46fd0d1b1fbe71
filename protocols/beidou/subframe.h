// BeiDou's D1 message, as the satellites in medium and inclined orbits send it on B1I and B2I:
// subframes of ten words, 6 s.
//
// Source: BDS-SIS-ICD-2.1, section 5.1.3 (words: the first has 26 bits of data, of which the last
// eleven are coded, the others 22; BCH(15,11,1), two of them interleaved), 5.2.3 (structure), 5.2.4
// (content of subframes 1 to 3). Quantities are SI and radians; the orbit's figures are those of
// gps::Ephemeris: week as GPS counts, times of BeiDou's week, which is 14 s late; group delays are
// of B1I and B2I; issue_of_clock is AODC, issue_of_ephemeris AODE.
//
// Subframes 4 and 5, the almanac, are not here.
#pragma once

#include <array>
#include <cstdint>

#include "protocols/gps/ephemeris.h"
#include "protocols/gps/page.h"
#include "protocols/result.h"

namespace rigwire::protocols::beidou {

inline constexpr std::int32_t kFirstWeek = 1356;  ///< GPS week in which BeiDou's count begins.
inline constexpr std::int32_t kBehindGps_s = 14;
inline constexpr std::int32_t kSubframeSeconds = 6;
inline constexpr std::uint32_t kSubframes = 5;

/// Ten words of 30 bits, the bit sent first in bit 29.
using Subframe = std::array<std::uint32_t, 10>;

/// When a subframe begins by BeiDou's time.
struct SubframeTime {
  std::int32_t week = kFirstWeek;  ///< GPS week number.
  std::uint32_t second = 0;        ///< Second of BeiDou's week.
};

/// Returns the subframe's number, 1 to 5.
[[nodiscard]] constexpr std::uint8_t id_at(std::uint32_t second) {
  return static_cast<std::uint8_t>(second / kSubframeSeconds % kSubframes + 1);
}

/// Subframe `id` 1, 2 or 3 (precondition).
[[nodiscard]] Subframe subframe(std::uint8_t id, const gps::Ephemeris& ephemeris,
                                const gps::IonosphereUtc& ionosphere, const SubframeTime& time);

/// What subframes 1 to 3 say of the orbit. Malformed when a word's code does not hold, when they
/// are not one after the other, or the times of clock and orbit differ (offset: which of them, 3).
[[nodiscard]] Decoded<gps::Ephemeris> decode_ephemeris(const std::array<Subframe, 3>& subframes);

}  // namespace rigwire::protocols::beidou
