#include "protocols/sbas/message.h"

#include <gtest/gtest.h>

#include <vector>

namespace rigwire::protocols::sbas {
namespace {

// Words of RXM-SFRB from a recording of a NEO-7P, PRN 135 and 138 (WAAS): a null message, the same
// for both, and one with fast corrections.
constexpr Message kRecordedNull{{0xC6FC'0000, 0, 0, 0, 0, 0, 0, 0x0021'705B}};
constexpr Message kRecordedFast{{0x9A0A'0000, 0x0040'05FF, 0xFFCF'FFFF, 0xFDFF'FFF3, 0xFFDF'FDFF,
                                 0xDFFF'9D7B, 0x95BD'5BBB, 0x02B1'26EA}};

TEST(SbasMessage, NullMessageIsThatOfARecording) {
  EXPECT_EQ(null_message(2), kRecordedNull);
}

TEST(SbasMessage, RecordedMessagesAreRead) {
  EXPECT_EQ(*decode_type(kRecordedNull), kTypeNull);
  EXPECT_EQ(*decode_type(kRecordedFast), kTypeFirstFastCorrections);
}

TEST(SbasMessage, WhatIsWrittenIsReadAndEveryFlippedBitIsNoticed) {
  const std::vector<FastCorrection> corrections{{-1, 4}, {7, 13}};
  const std::vector<std::pair<Message, std::uint8_t>> messages{
      {null_message(0), kTypeNull},
      {mask_message(1, 0x00FF'FFFF, 1), kTypeMask},
      {fast_corrections(2, 1, corrections, 2, 1), 3},
      {degradation_message(3, 1), kTypeDegradation}};
  for (const auto& [message, type] : messages) {
    const auto read = decode_type(message);
    ASSERT_TRUE(read.ok());
    EXPECT_EQ(*read, type);
    for (std::size_t bit = 0; bit < kMessageBits; ++bit) {
      Message bad = message;
      const std::size_t width = bit / 32 + 1 < kWords ? 32 : 26;
      bad.words[bit / 32] ^= 1U << (width - 1 - bit % 32);
      EXPECT_FALSE(decode_type(bad).ok()) << bit;
    }
  }
}

TEST(SbasMessage, FastCorrectionsStandWhereTheDocumentPutsThem) {
  const std::vector<FastCorrection> corrections{{-1, 4}, {7, 13}};
  const Message message = fast_corrections(2, 0, corrections, 2, 1);
  const auto bits = [&](std::size_t first, std::size_t count) {
    std::uint32_t value = 0;
    for (std::size_t i = first; i < first + count; ++i) {
      const std::size_t width = i / 32 + 1 < kWords ? 32 : 26;
      value = value << 1U | (message.words[i / 32] >> (width - 1 - i % 32) & 1U);
    }
    return value;
  };
  EXPECT_EQ(bits(0, 8), 0xC6U);
  EXPECT_EQ(bits(8, 6), 2U);
  EXPECT_EQ(bits(14, 2), 2U) << "issue";
  EXPECT_EQ(bits(16, 2), 1U) << "issue of the mask";
  EXPECT_EQ(bits(18, 12), 0xFFFU) << "-1 in two's complement";
  EXPECT_EQ(bits(30, 12), 7U);
  EXPECT_EQ(bits(18 + 13 * 12, 4), 4U);
  EXPECT_EQ(bits(18 + 13 * 12 + 4, 4), 13U);
  EXPECT_EQ(bits(18 + 13 * 12 + 8, 4), 14U) << "not monitored";
}

}  // namespace
}  // namespace rigwire::protocols::sbas
