#include "protocols/glonass/string.h"

#include <bit>
#include <cassert>
#include <cmath>

#include "protocols/bit_fields.h"

namespace rigwire::protocols::glonass {
namespace {

using enum Sign;

constexpr unsigned kBits = 85;
constexpr unsigned kCheckBits = 8;  // bits 8 to 1
constexpr std::size_t kBytes = 12;

double step(int exponent) {
  return std::ldexp(1.0, exponent);
}
/// The message counts km.
double km_step(int exponent) {
  return std::ldexp(1e3, exponent);
}

struct Head {
  std::uint8_t number = 0;
  std::uint8_t half_minute = 0;
  std::uint8_t minute = 0;
  std::uint8_t hour = 0;
  std::uint8_t interval = 1;  ///< P1: new orbits every 30 min.
  std::uint8_t quarter = 0;   ///< tb, quarters of an hour.
  std::uint8_t health = 0;    ///< Bn, its first bit counts.
  std::uint8_t modern = 1;    ///< M: GLONASS-M.
  std::uint8_t four_years = 1;
  std::uint16_t day = 1;
};

template <class Bits>
void walk_axis(Bits& bits, std::size_t axis, Ephemeris& e) {
  bits.scaled(24, magnitude, km_step(-20), e.velocity_mps[axis]);
  bits.scaled(5, magnitude, km_step(-30), e.acceleration_mps2[axis]);
  bits.scaled(27, magnitude, km_step(-11), e.position_m[axis]);
}

// Bits 80 to 9 of each string: figure 4.3.

template <class Bits>
void walk_1(Bits& bits, Head& head, Ephemeris& e) {
  bits.spare(2);
  bits.whole(2, head.interval);
  bits.whole(5, head.hour);
  bits.whole(6, head.minute);
  bits.whole(1, head.half_minute);
  walk_axis(bits, 0, e);
}

template <class Bits>
void walk_2(Bits& bits, Head& head, Ephemeris& e) {
  bits.whole(3, head.health);
  std::uint8_t odd = head.quarter % 2;
  bits.whole(1, odd);
  bits.whole(7, head.quarter);
  bits.spare(5);
  walk_axis(bits, 1, e);
}

template <class Bits>
void walk_3(Bits& bits, Head& /*head*/, Ephemeris& e) {
  std::uint8_t five_almanacs = 1;
  bits.whole(1, five_almanacs);
  bits.scaled(11, magnitude, step(-40), e.frequency_offset);
  bits.spare(1 + 2 + 1);
  walk_axis(bits, 2, e);
}

template <class Bits>
void walk_4(Bits& bits, Head& head, Ephemeris& e) {
  bits.scaled(22, magnitude, step(-30), e.clock_correction_s);
  bits.scaled(5, magnitude, step(-30), e.second_delay_s);
  bits.spare(5 /*age*/ + 14 + 1);
  bits.whole(4, e.accuracy);
  bits.spare(3);
  bits.whole(11, head.day);
  bits.whole(5, e.slot);
  bits.whole(2, head.modern);
}

/// The clocks of GLONASS, UTC and GPS agree here.
template <class Bits>
void walk_5(Bits& bits, Head& head) {
  bits.whole(11, head.day);
  bits.spare(32 + 1);
  bits.whole(5, head.four_years);
  bits.spare(22 + 1);
}

template <class Bits>
void walk(Bits& bits, Head& head, Ephemeris& e) {
  switch (head.number) {
    case 1:
      return walk_1(bits, head, e);
    case 2:
      return walk_2(bits, head, e);
    case 3:
      return walk_3(bits, head, e);
    case 4:
      return walk_4(bits, head, e);
    default:
      return walk_5(bits, head);
  }
}

bool bit(const String& string, unsigned number) {
  const unsigned at = kBits - number;
  return (string[at / 32] >> (31U - at % 32) & 1U) != 0;
}

/// Returns the seven check bits and, in the eighth, the parity of everything but it. Bits 9, 10 ..
/// 85 are at the places 3, 5, 6, 7, 9 .. 84 of a Hamming code, those that are no powers of two;
/// check bit i covers the places whose number has bit i.
std::uint32_t checks(const String& string) {
  std::uint32_t sum = 0;
  std::uint32_t ones = 0;
  std::uint32_t place = 2;
  for (unsigned number = kCheckBits + 1; number <= kBits; ++number) {
    ++place;
    place += std::has_single_bit(place) ? 1U : 0U;
    if (bit(string, number)) {
      sum ^= place;
      ++ones;
    }
  }
  ones += static_cast<std::uint32_t>(std::popcount(sum));
  return sum | (ones & 1U) << (kCheckBits - 1);
}

std::uint32_t check_bits_of(const String& string) {
  std::uint32_t bits = 0;
  for (unsigned number = kCheckBits; number >= 1; --number) {
    bits = bits << 1U | (bit(string, number) ? 1U : 0U);
  }
  return bits;
}

String words_of(std::span<const std::uint8_t> bytes) {
  BitReader bits(bytes);
  String words{};
  for (std::uint32_t& word : words) {
    bits.whole(32, word);
  }
  return words;
}

}  // namespace

String string(std::uint8_t number, const Ephemeris& ephemeris, const FrameTime& time) {
  assert(number >= 1 && number <= 5);
  Head head{.number = number,
            .half_minute = static_cast<std::uint8_t>(time.second_of_day / 30 % 2),
            .minute = static_cast<std::uint8_t>(time.second_of_day / 60 % 60),
            .hour = static_cast<std::uint8_t>(time.second_of_day / 3600),
            .quarter = static_cast<std::uint8_t>(ephemeris.time_of_day_s / kTimeStep_s),
            .health = static_cast<std::uint8_t>(ephemeris.healthy ? 0 : 4),
            .four_years = time.four_years,
            .day = time.day};
  Ephemeris e = ephemeris;
  BitWriter<kBytes> bits;
  bits.spare(1);
  bits.whole(4, number);
  walk(bits, head, e);
  String made = words_of(bits.bytes());
  // Bits 8 to 1 end where the 85 bits do.
  made[2] |= checks(made) << (32 * 3 - kBits);
  return made;
}

bool is_sound(const String& string) {
  return check_bits_of(string) == checks(string);
}

Decoded<Ephemeris> decode_ephemeris(const std::array<String, 4>& strings) {
  Ephemeris e;
  Head head;
  for (std::size_t i = 0; i < strings.size(); ++i) {
    if (!is_sound(strings[i])) {
      return Malformed{"the code does not hold", i};
    }
    BitWriter<kBytes> bytes;
    for (const std::uint32_t word : strings[i]) {
      bytes.whole(32, word);
    }
    BitReader bits(bytes.bytes());
    bits.spare(1);
    bits.whole(4, head.number);
    if (head.number != i + 1) {
      return Malformed{"another string", i};
    }
    walk(bits, head, e);
  }
  e.time_of_day_s = head.quarter * kTimeStep_s;
  e.healthy = head.health < 4;
  return {e, strings.size()};
}

}  // namespace rigwire::protocols::glonass
