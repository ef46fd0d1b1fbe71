// Places of fields in the data bits of a subframe, and numbers in steps of powers of two: what the
// tables of ephemeris, almanac and page 18 are made of. Encoders and decoders share the tables.
//
// The document counts bits 1..300 with parity; here a field has its word and its first bit among
// that word's 24 data bits: document bit b of word w is bit b - 30 (w - 1). A field runs on into
// the next word's data bits where the document splits it into most and least significant bits.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "protocols/gps/subframe.h"

namespace rigwire::protocols::gps {

struct BitRange {
  std::uint8_t word = 1;   ///< 1..10.
  std::uint8_t first = 1;  ///< 1..24, 1 is sent first.
  std::uint8_t bits = 1;   ///< 1..32.
};

[[nodiscard]] constexpr std::uint32_t get_bits(const SubframeData& data, BitRange range) {
  std::uint32_t value = 0;
  unsigned at = (range.word - 1U) * kDataBits + range.first - 1U;
  for (unsigned i = 0; i < range.bits; ++i, ++at) {
    const std::uint32_t word = data.words[at / kDataBits];
    value = (value << 1U) | ((word >> (kDataBits - 1U - at % kDataBits)) & 1U);
  }
  return value;
}

/// Higher bits of `value` than the range has are left out.
constexpr void put_bits(SubframeData& data, BitRange range, std::uint32_t value) {
  unsigned at = (range.word - 1U) * kDataBits + range.first - 1U;
  for (unsigned i = 0; i < range.bits; ++i, ++at) {
    const std::uint32_t mask = 1U << (kDataBits - 1U - at % kDataBits);
    std::uint32_t& word = data.words[at / kDataBits];
    const bool set = ((value >> (range.bits - 1U - i)) & 1U) != 0U;
    word = set ? word | mask : word & ~mask;
  }
}

/// The value of pi that the message's semicircles stand for: section 20.3.3.4.3.3.
inline constexpr double kSemicircle_rad = 3.1415926535898;

/// A number in whole steps of 2^exponent, angles in semicircles.
struct Scale {
  std::uint8_t bits = 1;
  bool negative = false;  ///< Two's complement.
  int exponent = 0;
  bool semicircles = false;

  [[nodiscard]] double step() const {
    return std::ldexp(semicircles ? kSemicircle_rad : 1.0, exponent);
  }
  [[nodiscard]] double least() const { return negative ? -std::ldexp(step(), bits - 1) : 0.0; }
  [[nodiscard]] double greatest() const {
    return std::ldexp(step(), negative ? bits - 1 : bits) - step();
  }
  /// The nearest step within the field, as its bits; NaN gives 0.
  [[nodiscard]] std::uint32_t count(double value) const {
    if (std::isnan(value)) {
      return 0;
    }
    const double steps = std::clamp(value, least(), greatest()) / step();
    return static_cast<std::uint32_t>(std::llround(steps));
  }
  /// The value of the field's bits.
  [[nodiscard]] double value(std::uint32_t count) const {
    const unsigned spare = 32U - bits;
    const double steps =
        negative ? static_cast<double>(static_cast<std::int32_t>(count << spare) >> spare)
                 : static_cast<double>(count);
    return steps * step();
  }
};

/// A member of Record, its place and scale.
template <class Record>
struct ScaledField {
  double Record::*member = nullptr;
  std::uint8_t word = 1;
  std::uint8_t first = 1;
  Scale scale;

  void encode(const Record& record, SubframeData& data) const {
    put_bits(data, {word, first, scale.bits}, scale.count(record.*member));
  }
  void decode(const SubframeData& data, Record& record) const {
    record.*member = scale.value(get_bits(data, {word, first, scale.bits}));
  }
};

}  // namespace rigwire::protocols::gps
