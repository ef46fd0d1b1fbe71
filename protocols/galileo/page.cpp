#include "protocols/galileo/page.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "protocols/bit_fields.h"
#include "protocols/crc24q.h"
#include "protocols/gps/bits.h"

namespace rigwire::protocols::galileo {
namespace {

using gps::kSemicircle_rad;
using enum Sign;

// Table 42, words by page of 2 s.
constexpr std::size_t kPages = kFrameSeconds / kPageSeconds;
constexpr std::array<std::uint8_t, kPages> kOnE1{2, 4, 6, 0, 0, 0, 0, 0, 0, 0, 1, 3, 5, 0, 0};
constexpr std::array<std::uint8_t, kPages> kOnE5b{1, 3, 5, 0, 0, 0, 0, 0, 0, 0, 2, 4, 6, 0, 0};

double step(int exponent) {
  return std::ldexp(1.0, exponent);
}
double angle(int exponent) {
  return std::ldexp(kSemicircle_rad, exponent);
}

/// What words say besides the figures that gps::Ephemeris has.
struct Head {
  std::uint8_t type = 0;
  std::uint16_t issue = 0;
  std::uint16_t week = 0;  ///< Galileo's.
  std::uint32_t second = 0;
};

// Tables 43 to 49. The head's type is read or written before.

template <class Bits>
void walk_1(Bits& bits, Head& head, gps::Ephemeris& e) {
  bits.whole(10, head.issue);
  bits.scaled(14, none, 60.0, e.ephemeris_time_s);
  bits.scaled(32, twos, angle(-31), e.mean_anomaly_rad);
  bits.scaled(32, none, step(-33), e.eccentricity);
  bits.scaled(32, none, step(-19), e.sqrt_semi_major_axis);
  bits.spare(2);
}

template <class Bits>
void walk_2(Bits& bits, Head& head, gps::Ephemeris& e) {
  bits.whole(10, head.issue);
  bits.scaled(32, twos, angle(-31), e.ascending_node_rad);
  bits.scaled(32, twos, angle(-31), e.inclination_rad);
  bits.scaled(32, twos, angle(-31), e.argument_of_perigee_rad);
  bits.scaled(14, twos, angle(-43), e.inclination_rate);
  bits.spare(2);
}

template <class Bits>
void walk_3(Bits& bits, Head& head, gps::Ephemeris& e) {
  bits.whole(10, head.issue);
  bits.scaled(24, twos, angle(-43), e.ascending_node_rate);
  bits.scaled(16, twos, angle(-43), e.mean_motion_difference);
  bits.scaled(16, twos, step(-29), e.latitude_cosine_rad);
  bits.scaled(16, twos, step(-29), e.latitude_sine_rad);
  bits.scaled(16, twos, step(-5), e.radius_cosine_m);
  bits.scaled(16, twos, step(-5), e.radius_sine_m);
  bits.whole(8, e.accuracy_index);
}

template <class Bits>
void walk_4(Bits& bits, Head& head, gps::Ephemeris& e) {
  bits.whole(10, head.issue);
  bits.whole(6, e.prn);
  bits.scaled(16, twos, step(-29), e.inclination_cosine_rad);
  bits.scaled(16, twos, step(-29), e.inclination_sine_rad);
  bits.scaled(14, none, 60.0, e.clock_time_s);
  bits.scaled(31, twos, step(-34), e.clock_bias_s);
  bits.scaled(21, twos, step(-46), e.clock_drift);
  bits.scaled(6, twos, step(-59), e.clock_drift_rate);
  bits.spare(2);
}

template <class Bits>
void walk_5(Bits& bits, Head& head, gps::Ephemeris& e) {
  bits.spare(11 + 11 + 14 + 5);  // ionosphere: coefficients and regions
  bits.scaled(10, twos, step(-32), e.second_delay_s);
  bits.scaled(10, twos, step(-32), e.group_delay_s);
  bits.whole(6, e.health);  // status of E5b, of E1, and whether their data are valid
  bits.whole(12, head.week);
  bits.whole(20, head.second);
  bits.spare(23);
}

template <class Bits>
void walk_6(Bits& bits, Head& head, gps::IonosphereUtc& utc) {
  bits.scaled(32, twos, step(-30), utc.utc_a0_s);
  bits.scaled(24, twos, step(-50), utc.utc_a1);
  bits.whole(8, utc.leap_seconds);
  bits.scaled(8, none, 3600.0, utc.utc_reference_time_s);
  bits.whole(8, utc.utc_reference_week);
  bits.whole(8, utc.leap_week);
  bits.whole(3, utc.leap_day);
  bits.whole(8, utc.leap_seconds_future);
  bits.whole(20, head.second);
  bits.spare(3);
}

template <class Bits>
void walk_spare(Bits& bits, Head& head) {
  std::uint8_t time_is_said = 0b10;
  bits.whole(2, time_is_said);
  bits.spare(88);
  bits.whole(12, head.week);
  bits.whole(20, head.second);
}

template <class Bits>
void walk(Bits& bits, Head& head, gps::Ephemeris& e, gps::IonosphereUtc& utc) {
  switch (head.type) {
    case 1:
      return walk_1(bits, head, e);
    case 2:
      return walk_2(bits, head, e);
    case 3:
      return walk_3(bits, head, e);
    case 4:
      return walk_4(bits, head, e);
    case 5:
      return walk_5(bits, head, e);
    case 6:
      return walk_6(bits, head, utc);
    default:
      return walk_spare(bits, head);
  }
}

constexpr unsigned kTail = 6;
constexpr unsigned kEvenBits = 112;
constexpr unsigned kOddBits = 16;
constexpr unsigned kReserved = 40 + 22 + 2;  // for authentication, search and rescue, spare

/// CRC-24Q of the parts up to it, after four zeros that make it whole bytes.
std::uint32_t checksum(const Word& word) {
  BitWriter<25> bits;
  bits.spare(4 + 2);
  for (const std::uint8_t byte : std::span(word).first(kEvenBits / 8)) {
    bits.whole(8, byte);
  }
  bits.whole(2, 0b10);
  for (const std::uint8_t byte : std::span(word).last(kOddBits / 8)) {
    bits.whole(8, byte);
  }
  bits.spare(kReserved);
  return crc24q(bits.bytes());
}

}  // namespace

std::uint8_t type_on_e1(std::uint32_t since_frame_s) {
  return kOnE1[since_frame_s / kPageSeconds % kPages];
}

std::uint8_t type_on_e5b(std::uint32_t since_frame_s) {
  return kOnE5b[since_frame_s / kPageSeconds % kPages];
}

Word word(std::uint8_t type, const gps::Ephemeris& ephemeris, const gps::IonosphereUtc& utc,
          const PageTime& time) {
  assert(type <= 6);
  constexpr std::uint8_t kNothingWorks = 0b01'01'11;  // out of service, without guarantee
  Head head{.type = type,
            .issue = ephemeris.issue_of_clock,
            .week = static_cast<std::uint16_t>(time.week - kFirstWeek),
            .second = time.second};
  gps::Ephemeris e = ephemeris;
  e.health = ephemeris.health == 0 ? std::uint8_t{0} : kNothingWorks;
  gps::IonosphereUtc of_utc = utc;
  of_utc.utc_reference_week -= kFirstWeek;
  of_utc.leap_week -= kFirstWeek;
  BitWriter<16> bits;
  bits.whole(6, type);
  walk(bits, head, e, of_utc);
  Word made;
  std::ranges::copy(bits.bytes(), made.begin());
  return made;
}

Page page_of(const Word& word) {
  BitWriter<32> bits;
  bits.whole(2, 0b00);  // even part, nominal page
  for (const std::uint8_t byte : std::span(word).first(kEvenBits / 8)) {
    bits.whole(8, byte);
  }
  bits.spare(kTail + 8);
  bits.whole(2, 0b10);  // odd part, nominal page
  for (const std::uint8_t byte : std::span(word).last(kOddBits / 8)) {
    bits.whole(8, byte);
  }
  bits.spare(kReserved);
  bits.whole(24, checksum(word));
  bits.spare(8 + kTail + 8);
  BitReader words(bits.bytes());
  Page page;
  for (std::uint32_t& one : page) {
    words.whole(32, one);
  }
  return page;
}

// Joins the word from the even and the odd part of a nominal page (Galileo OS SIS ICD 2.1, 4.3.2.3)
// and checks its CRC-24Q (5.1.9.4).
Decoded<Word> word_of(const Page& page) {
  BitWriter<32> all;
  for (const std::uint32_t one : page) {
    all.whole(32, one);
  }
  BitReader bits(all.bytes());
  std::uint8_t even = 0;
  std::uint8_t odd = 0;
  std::uint32_t said = 0;
  Word word;
  bits.whole(2, even);
  for (std::uint8_t& byte : std::span(word).first(kEvenBits / 8)) {
    bits.whole(8, byte);
  }
  bits.spare(kTail + 8);
  bits.whole(2, odd);
  for (std::uint8_t& byte : std::span(word).last(kOddBits / 8)) {
    bits.whole(8, byte);
  }
  bits.spare(kReserved);
  bits.whole(24, said);
  if ((even & 0b10U) != 0 || (odd & 0b10U) == 0) {
    return Malformed{"parts are not even and odd", 0};
  }
  if ((even & 0b01U) != 0 || (odd & 0b01U) != 0) {
    return Malformed{"an alert page", 1};
  }
  if (said != checksum(word)) {
    return Malformed{"checksum", 2};
  }
  return {word, page.size()};
}

Decoded<gps::Ephemeris> decode_ephemeris(const std::array<Word, 5>& words) {
  gps::Ephemeris e;
  gps::IonosphereUtc unused;
  std::array<Head, 5> heads;
  for (std::size_t i = 0; i < words.size(); ++i) {
    BitReader bits(words[i]);
    bits.whole(6, heads[i].type);
    if (heads[i].type != i + 1) {
      return Malformed{"another type of word", i};
    }
    walk(bits, heads[i], e, unused);
  }
  const auto same = [&](const Head& head) { return head.issue == heads[0].issue; };
  if (!std::ranges::all_of(std::span(heads).first(4), same)) {
    return Malformed{"words of different issues", heads.size()};
  }
  e.issue_of_clock = heads[0].issue;
  e.issue_of_ephemeris = static_cast<std::uint8_t>(heads[0].issue);
  e.week = heads[4].week + kFirstWeek;
  // The word's week is that of its page; the orbit's time is in another one if it is more than half
  // a week away.
  const double ahead_s = e.ephemeris_time_s - heads[4].second;
  constexpr double kHalfWeek_s = gps::kWeekSeconds / 2.0;
  e.week += ahead_s > kHalfWeek_s ? -1 : ahead_s < -kHalfWeek_s ? 1 : 0;
  return {e, words.size()};
}

}  // namespace rigwire::protocols::galileo
