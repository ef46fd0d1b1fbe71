#include "protocols/beidou/subframe.h"

#include <cassert>
#include <cmath>
#include <optional>

#include "protocols/bit_fields.h"
#include "protocols/gps/bits.h"

namespace rigwire::protocols::beidou {
namespace {

using gps::kSemicircle_rad;
using enum Sign;

constexpr std::uint16_t kPreamble = 0b111'0001'0010;
constexpr unsigned kWordBits = 30;
constexpr unsigned kParityBits = 4;   // of one code word ...
constexpr unsigned kCodedBits = 11;   // ... for so many of data
constexpr unsigned kFirstPlain = 15;  // of the first word, not coded
constexpr unsigned kFirstData = kFirstPlain + kCodedBits;
constexpr unsigned kData = 2 * kCodedBits;
constexpr std::size_t kBytes = (kFirstData + 9 * kData) / 8;
static_assert(kBytes * 8 == 224);

double step(int exponent) {
  return std::ldexp(1.0, exponent);
}
double angle(int exponent) {
  return std::ldexp(kSemicircle_rad, exponent);
}

struct Head {
  std::uint16_t preamble = kPreamble;
  std::uint8_t id = 0;
  std::uint32_t second = 0;
  std::uint16_t week = 0;  ///< BeiDou's.
};
constexpr double kTimeStep_s = 8.0;
constexpr unsigned kLowBitsOfToe = 15;

// Data bits in the order of figures 5-8 to 5-10.

template <class Bits>
void walk_head(Bits& bits, Head& head) {
  bits.whole(11, head.preamble);
  bits.spare(4);
  bits.whole(3, head.id);
  bits.whole(20, head.second);
}

template <class Bits>
void walk_1(Bits& bits, Head& head, gps::Ephemeris& e, gps::IonosphereUtc& i) {
  bits.whole(1, e.health);
  bits.whole(5, e.issue_of_clock);
  bits.whole(4, e.accuracy_index);
  bits.whole(13, head.week);
  bits.scaled(17, none, kTimeStep_s, e.clock_time_s);
  bits.scaled(10, twos, 1e-10, e.group_delay_s);
  bits.scaled(10, twos, 1e-10, e.second_delay_s);
  constexpr std::array<int, 4> kAlpha{-30, -27, -24, -24};
  constexpr std::array<int, 4> kBeta{11, 14, 16, 16};
  for (std::size_t k = 0; k < kAlpha.size(); ++k) {
    bits.scaled(8, twos, step(kAlpha[k]), i.alpha[k]);
  }
  for (std::size_t k = 0; k < kBeta.size(); ++k) {
    bits.scaled(8, twos, step(kBeta[k]), i.beta[k]);
  }
  bits.scaled(11, twos, step(-66), e.clock_drift_rate);
  bits.scaled(24, twos, step(-33), e.clock_bias_s);
  bits.scaled(22, twos, step(-50), e.clock_drift);
  bits.whole(5, e.issue_of_ephemeris);
}

template <class Bits>
void walk_2(Bits& bits, std::uint8_t& high_toe, gps::Ephemeris& e) {
  bits.scaled(16, twos, angle(-43), e.mean_motion_difference);
  bits.scaled(18, twos, step(-31), e.latitude_cosine_rad);
  bits.scaled(32, twos, angle(-31), e.mean_anomaly_rad);
  bits.scaled(32, none, step(-33), e.eccentricity);
  bits.scaled(18, twos, step(-31), e.latitude_sine_rad);
  bits.scaled(18, twos, step(-6), e.radius_cosine_m);
  bits.scaled(18, twos, step(-6), e.radius_sine_m);
  bits.scaled(32, none, step(-19), e.sqrt_semi_major_axis);
  bits.whole(2, high_toe);
}

template <class Bits>
void walk_3(Bits& bits, std::uint16_t& low_toe, gps::Ephemeris& e) {
  bits.whole(kLowBitsOfToe, low_toe);
  bits.scaled(32, twos, angle(-31), e.inclination_rad);
  bits.scaled(18, twos, step(-31), e.inclination_cosine_rad);
  bits.scaled(24, twos, angle(-43), e.ascending_node_rate);
  bits.scaled(18, twos, step(-31), e.inclination_sine_rad);
  bits.scaled(14, twos, angle(-43), e.inclination_rate);
  bits.scaled(32, twos, angle(-31), e.ascending_node_rad);
  bits.scaled(32, twos, angle(-31), e.argument_of_perigee_rad);
  bits.spare(1);
}

/// Remainder of `data`, eleven bits, times x^4 by x^4 + x + 1.
std::uint32_t parity(std::uint32_t data) {
  constexpr std::uint32_t kGenerator = 0b1'0011;
  std::uint32_t remainder = data << kParityBits;
  for (unsigned bit = kCodedBits + kParityBits; bit-- > kParityBits;) {
    if ((remainder >> bit & 1U) != 0) {
      remainder ^= kGenerator << (bit - kParityBits);
    }
  }
  return remainder;
}

/// Every other of 22 bits, the first or the second of each pair.
std::uint32_t every_other(std::uint32_t data, unsigned which) {
  std::uint32_t bits = 0;
  for (unsigned i = 0; i < kCodedBits; ++i) {
    bits = bits << 1U | (data >> (kData - 1 - 2 * i - which) & 1U);
  }
  return bits;
}

std::uint32_t coded_word(std::uint32_t data) {
  const std::uint32_t first = parity(every_other(data, 0));
  const std::uint32_t second = parity(every_other(data, 1));
  std::uint32_t word = data;
  for (unsigned i = kParityBits; i-- > 0;) {
    word = word << 2U | (first >> i & 1U) << 1U | (second >> i & 1U);
  }
  return word;
}

std::uint32_t first_word(std::uint32_t data) {
  return data << kParityBits | parity(data & ((1U << kCodedBits) - 1U));
}

Subframe words_of(std::span<const std::uint8_t> data) {
  BitReader bits(data);
  Subframe words{};
  for (std::size_t i = 0; i < words.size(); ++i) {
    std::uint32_t value = 0;
    bits.whole(i == 0 ? kFirstData : kData, value);
    words[i] = i == 0 ? first_word(value) : coded_word(value);
  }
  return words;
}

/// Data bits of a subframe whose words' codes hold.
std::optional<BitWriter<kBytes>> data_of(const Subframe& words) {
  BitWriter<kBytes> bits;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const unsigned width = i == 0 ? kFirstData : kData;
    const std::uint32_t data = words[i] >> (kWordBits - width) & ((1U << width) - 1U);
    if (words[i] != (i == 0 ? first_word(data) : coded_word(data))) {
      return std::nullopt;
    }
    bits.whole(width, data);
  }
  return bits;
}

}  // namespace

Subframe subframe(std::uint8_t id, const gps::Ephemeris& ephemeris,
                  const gps::IonosphereUtc& ionosphere, const SubframeTime& time) {
  assert(id >= 1 && id <= 3);
  Head head{
      .id = id, .second = time.second, .week = static_cast<std::uint16_t>(time.week - kFirstWeek)};
  gps::Ephemeris e = ephemeris;
  e.health = ephemeris.health == 0 ? 0 : 1;
  gps::IonosphereUtc i = ionosphere;
  const auto toe = static_cast<std::uint32_t>(std::lround(e.ephemeris_time_s / kTimeStep_s));
  auto high = static_cast<std::uint8_t>(toe >> kLowBitsOfToe);
  auto low = static_cast<std::uint16_t>(toe & ((1U << kLowBitsOfToe) - 1U));
  BitWriter<kBytes> bits;
  walk_head(bits, head);
  if (id == 1) {
    walk_1(bits, head, e, i);
  } else if (id == 2) {
    walk_2(bits, high, e);
  } else {
    walk_3(bits, low, e);
  }
  return words_of(bits.bytes());
}

// Reads subframes 1 to 3 (BDS-SIS-ICD-2.1, 5.2.4). toe is split between subframes 2 (high bits) and
// 3 (low bits). The week is that of the subframes, corrected by one if toe is more than half a week
// away.
Decoded<gps::Ephemeris> decode_ephemeris(const std::array<Subframe, 3>& subframes) {
  std::array<Head, 3> heads;
  gps::Ephemeris e;
  gps::IonosphereUtc unused;
  std::uint8_t high = 0;
  std::uint16_t low = 0;
  for (std::size_t i = 0; i < subframes.size(); ++i) {
    const auto data = data_of(subframes[i]);
    if (!data) {
      return Malformed{"a word's parity", i};
    }
    BitReader bits(data->bytes());
    walk_head(bits, heads[i]);
    if (heads[i].preamble != kPreamble || heads[i].id != i + 1 ||
        heads[i].second != heads[0].second + i * kSubframeSeconds) {
      return Malformed{"subframes that do not follow each other", i};
    }
    if (i == 0) {
      walk_1(bits, heads[i], e, unused);
    } else if (i == 1) {
      walk_2(bits, high, e);
    } else {
      walk_3(bits, low, e);
    }
  }
  e.ephemeris_time_s =
      kTimeStep_s * static_cast<double>(std::uint32_t{high} << kLowBitsOfToe | low);
  if (e.clock_time_s != e.ephemeris_time_s) {
    return Malformed{"times of clock and orbit differ", 3};
  }
  constexpr double kHalfWeek_s = gps::kWeekSeconds / 2.0;
  const double ahead_s = e.ephemeris_time_s - heads[0].second;
  e.week = heads[0].week + kFirstWeek;
  e.week += ahead_s > kHalfWeek_s ? -1 : ahead_s < -kHalfWeek_s ? 1 : 0;
  return {e, subframes.size()};
}

}  // namespace rigwire::protocols::beidou
