#include "protocols/rtcm3/frame.h"

#include <gtest/gtest.h>

#include <vector>

#include "protocols/crc24q.h"

namespace rigwire::protocols::rtcm3 {
namespace {

using Bytes = std::vector<std::uint8_t>;

// Message 1005 of the standard's example 4.2: station 2003, 19 bytes.
const Bytes kExample{0xD3, 0x00, 0x13, 0x3E, 0xD7, 0xD3, 0x02, 0x02, 0x98, 0x0E, 0xDE, 0xEF, 0x34,
                     0xB4, 0xBD, 0x62, 0xAC, 0x09, 0x41, 0x98, 0x6F, 0x33, 0x36, 0x0B, 0x98};

TEST(Rtcm3Frame, ExampleOfTheStandardIsRead) {
  const auto frame = decode_frame(kExample);
  ASSERT_TRUE(frame.ok());
  EXPECT_EQ(frame.consumed(), kExample.size());
  EXPECT_EQ(frame->payload.size(), 19U);
  EXPECT_EQ(frame->message(), 1005);
  EXPECT_EQ(frame->second_field(), 2003);
}

TEST(Rtcm3Frame, EveryCutIsIncompleteAndEveryFlippedBitIsNoticed) {
  for (std::size_t size = 0; size < kExample.size(); ++size) {
    EXPECT_TRUE(decode_frame(std::span(kExample).first(size)).incomplete()) << size;
  }
  for (std::size_t bit = 0; bit < kExample.size() * 8; ++bit) {
    Bytes bad = kExample;
    bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ 1U << bit % 8);
    EXPECT_FALSE(decode_frame(bad).ok()) << bit;
  }
}

TEST(Rtcm3Frame, EmptyPayloadHasNoNumber) {
  Bytes empty{0xD3, 0x00, 0x00};
  const std::uint32_t checksum = crc24q(empty);
  for (const unsigned shift : {16U, 8U, 0U}) {
    empty.push_back(static_cast<std::uint8_t>(checksum >> shift));
  }
  const auto frame = decode_frame(empty);
  ASSERT_TRUE(frame.ok());
  EXPECT_EQ(frame->message(), 0);
  EXPECT_EQ(frame->second_field(), 0);
}

}  // namespace
}  // namespace rigwire::protocols::rtcm3
