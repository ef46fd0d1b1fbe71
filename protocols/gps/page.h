// Pages of subframes 4 and 5: the third word that says which one it is, the ionosphere and UTC page
// (subframe 4, page 18), and fillers for the pages that this house says nothing on.
//
// Source: IS-GPS-200 section 20.3.3.5, table 20-V (page ids), tables 20-IX and 20-X, figure 20-1
// sheets 8 to 11.
#pragma once

#include <array>
#include <cstdint>

#include "protocols/gps/subframe.h"
#include "protocols/result.h"

namespace rigwire::protocols::gps {

inline constexpr std::uint8_t kPageDummy = 0;
inline constexpr std::uint8_t kPageHealthOfFirst = 51;
inline constexpr std::uint8_t kPageSpecialMessage = 55;
inline constexpr std::uint8_t kPageIonosphereUtc = 56;
inline constexpr std::uint8_t kPageHealthOfLast = 63;

/// Klobuchar's model of the ionosphere, and GPS time to UTC.
struct IonosphereUtc {
  std::array<double, 4> alpha{};  ///< s, s/semicircle, s/semicircle2, s/semicircle3.
  std::array<double, 4> beta{};   ///< Units of alpha.
  double utc_a0_s = 0.0;
  double utc_a1 = 0.0;                  ///< s/s.
  double utc_reference_time_s = 0.0;    ///< tot, a multiple of 4096 s.
  std::int32_t utc_reference_week = 0;  ///< WNt, not rolled over; 8 bits in the message.
  std::int32_t leap_seconds = 0;
  std::int32_t leap_week = 0;  ///< Week and day (1..7) at whose end leap_seconds_future begins.
  std::int32_t leap_day = 1;
  std::int32_t leap_seconds_future = 0;

  friend bool operator==(const IonosphereUtc&, const IonosphereUtc&) = default;
};

/// Clears words 3..10 and writes data id 1 and the satellite or page id.
void begin_page(SubframeData& data, std::uint8_t id);
/// The satellite or page id, 0..63.
[[nodiscard]] std::uint8_t page_id(const SubframeData& data);

/// Words 3..10 of subframe 4 page 18. Values beyond a field are clamped to it.
void put_ionosphere_utc(SubframeData& data, const IonosphereUtc& parameters);
/// Malformed for another page id (offset 2, counted in words). `week_hint` within 127 weeks.
[[nodiscard]] Decoded<IonosphereUtc> decode_ionosphere_utc(const SubframeData& data,
                                                           std::int32_t week_hint);

/// A page without content: ones and zeros in turn, as satellites fill pages of satellites that are
/// not there and reserved ones; the special message page is filled with blanks.
void put_filler(SubframeData& data, std::uint8_t id);

/// Table 20-V for `subframe` 4 or 5 and page 1..25: a satellite's PRN, or the id of the page.
[[nodiscard]] std::uint8_t page_id_of(std::uint8_t subframe, std::uint8_t page);

}  // namespace rigwire::protocols::gps
