#include "protocols/gps/word.h"

#include <array>
#include <bit>

namespace rigwire::protocols::gps {
namespace {

// One row of table 20-XIV per parity bit D25..D30 over the 26 bits D29*, D30*, d1..d24.
constexpr std::array<std::uint32_t, kParityBits> kParityRows{
    0b10'1110'1100'0111'1100'1101'0010U, 0b01'0111'0110'0011'1110'0110'1001U,
    0b10'1011'1011'0001'1111'0011'0100U, 0b01'0101'1101'1000'1111'1001'1010U,
    0b01'1010'1110'1100'0111'1100'1101U, 0b10'0010'1101'1110'1010'0010'0111U,
};

constexpr std::uint32_t kLastTwo = 0b11U;

bool complemented(std::uint32_t previous) {
  return (previous & 1U) != 0U;
}

}  // namespace

std::uint32_t parity(std::uint32_t data, std::uint32_t previous) {
  const std::uint32_t covered = ((previous & kLastTwo) << kDataBits) | (data & kDataMask);
  std::uint32_t bits = 0;
  for (const std::uint32_t row : kParityRows) {
    bits = (bits << 1U) | (static_cast<std::uint32_t>(std::popcount(covered & row)) & 1U);
  }
  return bits;
}

std::uint32_t encode_word(std::uint32_t data, std::uint32_t previous) {
  const std::uint32_t sent = complemented(previous) ? ~data : data;
  return ((sent & kDataMask) << kParityBits) | parity(data, previous);
}

std::optional<std::uint32_t> decode_word(std::uint32_t word, std::uint32_t previous) {
  const std::uint32_t sent = (word & kWordMask) >> kParityBits;
  const std::uint32_t data = (complemented(previous) ? ~sent : sent) & kDataMask;
  if (encode_word(data, previous) != (word & kWordMask)) {
    return std::nullopt;
  }
  return data;
}

std::uint32_t with_zero_ending(std::uint32_t data, std::uint32_t previous) {
  // d24 counts in D29 and D30, d23 in D30 alone: the one first, then the other.
  constexpr std::uint32_t kD24 = 0b01;
  constexpr std::uint32_t kD23 = 0b10;
  constexpr std::uint32_t kD29 = 0b10;
  constexpr std::uint32_t kD30 = 0b01;
  std::uint32_t bits = data & kDataMask & ~(kD23 | kD24);
  if ((parity(bits, previous) & kD29) != 0U) {
    bits |= kD24;
  }
  if ((parity(bits, previous) & kD30) != 0U) {
    bits |= kD23;
  }
  return bits;
}

std::uint32_t true_polarity(std::uint32_t word, std::uint32_t previous) {
  const std::uint32_t whole = ((previous & kLastTwo) << kWordBits) | (word & kWordMask);
  return complemented(previous) ? ~whole : whole;
}

}  // namespace rigwire::protocols::gps
