// Galileo's I/NAV message, as E1-B and E5b-I carry it: words of 128 bits, each in a page of two
// seconds, and the order in which a satellite sends them.
//
// Source: Galileo OS SIS ICD, issue 2.1: section 4.3.2.3 (nominal page: even and odd part of 120
// bits, the word's first 112 bits in the even one), 4.3.3 (order of words), 4.3.5 (content of words
// 0 to 6), 5.1.9.4 (checksum CRC-24Q over both parts up to it). Quantities are SI and radians. The
// orbit's figures are those of gps::Ephemeris: week and times of GPS, which Galileo's are but for
// 1024 weeks; issue_of_clock is IODnav.
//
// The convolutional code and the interleaver of the air are not here: receivers hand pages on
// decoded.
#pragma once

#include <array>
#include <cstdint>

#include "protocols/gps/ephemeris.h"
#include "protocols/gps/page.h"
#include "protocols/result.h"

namespace rigwire::protocols::galileo {

inline constexpr std::int32_t kFirstWeek = 1024;  ///< GPS week in which Galileo's count begins.
inline constexpr std::int32_t kPageSeconds = 2;
inline constexpr std::int32_t kFrameSeconds = 30;
inline constexpr std::int32_t kE1Begins_s = 1;  ///< Pages of E1-B begin at odd seconds.
inline constexpr std::int32_t kE5bBegins_s = 0;

/// 128 bits, the bit sent first highest in the first byte.
using Word = std::array<std::uint8_t, 16>;
/// The two parts, each 120 bits and eight zeros.
using Page = std::array<std::uint32_t, 8>;

/// When a page begins: GPS week, not rolled over, and second.
struct PageTime {
  std::int32_t week = kFirstWeek;
  std::uint32_t second = 0;  ///< Second of the week.
};

/// Type of the word that a page carries, by the second since the signal's frame began (0, 2 .. 28).
/// Where the satellites send almanacs and what helps to start, it is 0, the spare word.
[[nodiscard]] std::uint8_t type_on_e1(std::uint32_t since_frame_s);
[[nodiscard]] std::uint8_t type_on_e5b(std::uint32_t since_frame_s);

/// Word `type` 0 to 6 (precondition). In word 5 all is healthy or, with `ephemeris.health`,
/// nothing; the ionosphere's coefficients and disturbance flags are 0.
[[nodiscard]] Word word(std::uint8_t type, const gps::Ephemeris& ephemeris,
                        const gps::IonosphereUtc& utc, const PageTime& time);

[[nodiscard]] Page page_of(const Word& word);
/// The word of a page. Malformed: a part that is not where it belongs, an alert page or a wrong
/// checksum (offset 0, 1, 2).
[[nodiscard]] Decoded<Word> word_of(const Page& page);

/// What words 1 to 5 of one issue say of the orbit. Malformed when types (offset: which of them) or
/// issues (offset 5) do not go together.
[[nodiscard]] Decoded<gps::Ephemeris> decode_ephemeris(const std::array<Word, 5>& words);

}  // namespace rigwire::protocols::galileo
