#include "protocols/gps/word.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "protocols/gps/subframe.h"

namespace rigwire::protocols::gps {
namespace {

// Table 20-XIV written out as the document has it: which of D29*, D30* and which data bits make up
// each parity bit.
struct ParityBit {
  bool uses_d29;
  std::vector<int> data_bits;
};
const std::array<ParityBit, 6>& document_table() {
  static const std::array<ParityBit, 6> table{{
      {true, {1, 2, 3, 5, 6, 10, 11, 12, 13, 14, 17, 18, 20, 23}},
      {false, {2, 3, 4, 6, 7, 11, 12, 13, 14, 15, 18, 19, 21, 24}},
      {true, {1, 3, 4, 5, 7, 8, 12, 13, 14, 15, 16, 19, 20, 22}},
      {false, {2, 4, 5, 6, 8, 9, 13, 14, 15, 16, 17, 20, 21, 23}},
      {false, {1, 3, 5, 6, 7, 9, 10, 14, 15, 16, 17, 18, 21, 22, 24}},
      {true, {3, 5, 6, 8, 9, 10, 11, 13, 15, 19, 22, 23, 24}},
  }};
  return table;
}

std::uint32_t parity_bit_by_bit(std::uint32_t data, bool d29, bool d30) {
  std::uint32_t result = 0;
  for (const ParityBit& bit : document_table()) {
    bool value = bit.uses_d29 ? d29 : d30;
    for (const int i : bit.data_bits) {
      value ^= ((data >> (24 - i)) & 1U) != 0U;
    }
    result = result * 2U + (value ? 1U : 0U);
  }
  return result;
}

// Subframe 4 or 5 and its neighbours do not matter here: ten words that a ZED-F9P handed on.
constexpr std::array<std::uint32_t, 10> kRecorded{583028782,  2463198336, 394902765, 2566867280,
                                                  1062207503, 675481840,  616371498, 2740700967,
                                                  768066377,  3045061856};

TEST(GpsParity, OfTheTelemetryWordWorkedByHand) {
  // d1, d5, d7, d8 (the preamble 10001011), all else 0, after D29* = D30* = 0:
  //   D25: d1 d5 = 0        D26: d7 = 1          D27: d1 d5 d7 d8 = 0
  //   D28: d5 d8 = 0        D29: d1 d5 d7 = 1    D30: d5 d8 = 0
  EXPECT_EQ(parity(0x8B0000, 0), 0b010010U);
  // D29* turns D25, D27, D30; D30* turns D26, D28, D29.
  EXPECT_EQ(parity(0x8B0000, 0b10), 0b111011U);
  EXPECT_EQ(parity(0x8B0000, 0b01), 0b000100U);
}

TEST(GpsParity, EqualsTheDocumentsTableBitByBit) {
  std::uint32_t state = 12345;
  for (int i = 0; i < 20'000; ++i) {
    state = state * 1'664'525U + 1'013'904'223U;
    const std::uint32_t data = (state >> 8U) & kDataMask;
    const std::uint32_t previous = state & 3U;
    ASSERT_EQ(parity(data, previous),
              parity_bit_by_bit(data, (previous & 2U) != 0, (previous & 1U) != 0));
  }
}

TEST(GpsParity, FindsEveryErrorOfOneAndOfTwoBits) {
  for (std::uint32_t previous = 0; previous < 4; ++previous) {
    const std::uint32_t word = encode_word(0x5A3C96, previous);
    ASSERT_EQ(decode_word(word, previous), 0x5A3C96U);
    for (int i = 0; i < kWordBits; ++i) {
      EXPECT_FALSE(decode_word(word ^ (1U << i), previous)) << i;
      for (int k = 0; k < i; ++k) {
        EXPECT_FALSE(decode_word(word ^ (1U << i) ^ (1U << k), previous)) << i << ' ' << k;
      }
    }
  }
}

TEST(GpsWord, IsComplementedAfterAOne) {
  const std::uint32_t plain = encode_word(0x123456, 0b00) >> kParityBits;
  const std::uint32_t complemented = encode_word(0x123456, 0b01) >> kParityBits;
  EXPECT_EQ(plain, 0x123456U);
  EXPECT_EQ(complemented, ~0x123456U & kDataMask);
}

TEST(GpsWord, EndsInZerosWhateverComesBefore) {
  for (std::uint32_t previous = 0; previous < 4; ++previous) {
    for (std::uint32_t i = 0; i < 64; ++i) {
      const std::uint32_t data = with_zero_ending(i * 0x04'1041U, previous);
      EXPECT_EQ(encode_word(data, previous) & 3U, 0U);
      EXPECT_EQ(data & ~3U, (i * 0x04'1041U) & kDataMask & ~3U) << "only the last two bits change";
    }
  }
}

TEST(GpsWord, TruePolarityGivesTheWordsThatAReceiverRecorded) {
  SubframeData data;
  for (std::size_t i = 0; i < kWords; ++i) {
    data.words[i] = (kRecorded[i] >> kParityBits) & kDataMask;
  }
  const Subframe sent = encode_subframe(data);
  EXPECT_EQ(true_polarity(sent), kRecorded);
  const auto back = decode_subframe(sent);
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(*back, data);
}

}  // namespace
}  // namespace rigwire::protocols::gps
