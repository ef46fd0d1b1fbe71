#include "protocols/gps/subframe.h"

#include <gtest/gtest.h>

namespace rigwire::protocols::gps {
namespace {

SubframeData subframe_example() {
  SubframeData data;
  set_head(data, {.telemetry_message = 0x1555,
                  .integrity_status = true,
                  .next_step = 100'799,
                  .alert = true,
                  .anti_spoof = false,
                  .subframe_id = 5});
  for (std::uint32_t i = 2; i < kWords; ++i) {
    data.words[i] = (i * 0x35'79BDU) & kDataMask;
  }
  return data;
}

TEST(GpsSubframe, HeadHasTheDocumentsPlaces) {
  const SubframeData data = subframe_example();
  // Telemetry: 10001011, 14 bits of message, integrity, reserved.
  EXPECT_EQ(data.words[0], (0x8BU << 16U) | (0x1555U << 2U) | 0b10U);
  // Hand-over: 17 bits of time, alert, anti-spoof, 3 bits of id, two solved bits.
  EXPECT_EQ(data.words[1], (100'799U << 7U) | (1U << 6U) | (0U << 5U) | (5U << 2U));
}

TEST(GpsSubframe, HeadComesBack) {
  const auto found = head(subframe_example());
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(*found, (Head{0x1555, true, 100'799, true, false, 5}));
}

TEST(GpsSubframe, HandOverAndLastWordEndInZeros) {
  const Subframe sent = encode_subframe(subframe_example());
  EXPECT_EQ(sent.words[1] & 3U, 0U);
  EXPECT_EQ(sent.words[9] & 3U, 0U);
}

TEST(GpsSubframe, ReceiverWordsNeedNoWordBefore) {
  // Bit 30 is 0 and the data are plain, whatever was complemented on the way.
  const auto words = true_polarity(encode_subframe(subframe_example()));
  for (std::size_t i = 2; i + 1 < kWords; ++i) {
    EXPECT_EQ((words[i] >> kParityBits) & kDataMask, subframe_example().words[i]);
    EXPECT_EQ(words[i] & (1U << 30U), 0U);
    EXPECT_EQ(parity((words[i] >> kParityBits) & kDataMask, words[i] >> 30U), words[i] & 0x3FU);
  }
}

TEST(GpsSubframe, BadParityIsRefusedAndItsWordNamed) {
  const Subframe sent = encode_subframe(subframe_example());
  for (std::size_t i = 0; i < kWords; ++i) {
    Subframe wrong = sent;
    wrong.words[i] ^= 1U << 17U;
    const auto found = decode_subframe(wrong);
    ASSERT_TRUE(found.malformed());
    EXPECT_EQ(found.fault().offset, i);
  }
}

TEST(GpsSubframe, BadPreambleIsRefused) {
  SubframeData data = subframe_example();
  data.words[0] ^= 1U << 23U;
  EXPECT_TRUE(head(data).malformed());
  EXPECT_TRUE(decode_subframe(encode_subframe(data)).malformed());
}

TEST(GpsSubframe, ImpossibleHandOverIsRefused) {
  SubframeData data = subframe_example();
  data.words[1] = (100'800U << 7U) | (1U << 2U);
  EXPECT_TRUE(head(data).malformed());
  for (const std::uint32_t id : {0U, 6U, 7U}) {
    data.words[1] = id << 2U;
    EXPECT_TRUE(head(data).malformed());
  }
}

}  // namespace
}  // namespace rigwire::protocols::gps
