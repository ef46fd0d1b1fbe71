#include "protocols/modbus/mbap.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace rigwire::protocols::modbus {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes header_with_length(std::uint16_t length) {
  return {
      0x15, 0x01, 0, 0, static_cast<std::uint8_t>(length >> 8U), static_cast<std::uint8_t>(length),
      0xFF};
}

TEST(Mbap, EncodesTheExampleOfTheImplementationGuide) {
  const std::uint8_t pdu[] = {0x03, 0x00, 0x04, 0x00, 0x01};
  const AduBytes adu = encode_adu({0x1501, 0, 0xFF}, pdu);
  EXPECT_THAT(adu.view(), ::testing::ElementsAre(0x15, 0x01, 0, 0, 0, 6, 0xFF, 3, 0, 4, 0, 1));
}

TEST(Mbap, EveryCutOfADataUnitIsIncomplete) {
  Bytes stream = header_with_length(6);
  stream.insert(stream.end(), {3, 0, 4, 0, 1});
  for (std::size_t size = 0; size < stream.size(); ++size) {
    EXPECT_TRUE(decode_adu(std::span(stream).first(size)).incomplete()) << size;
  }
  stream.push_back(0x99);  // of the next unit
  const auto adu = decode_adu(stream);
  ASSERT_TRUE(adu.ok());
  EXPECT_EQ(adu.consumed(), 12U);
  EXPECT_EQ(adu->header, (MbapHeader{0x1501, 0, 0xFF}));
  EXPECT_THAT(adu->pdu, ::testing::ElementsAre(3, 0, 4, 0, 1));
}

TEST(Mbap, LengthIs2To254) {
  for (const std::uint16_t length : std::vector<std::uint16_t>{0, 1, 255, 256, 65535}) {
    EXPECT_TRUE(decode_adu(header_with_length(length)).malformed()) << length;
  }
  for (const std::uint16_t length : std::vector<std::uint16_t>{2, 254}) {
    Bytes stream = header_with_length(length);
    EXPECT_TRUE(decode_adu(stream).incomplete()) << length;
    stream.resize(6U + length);
    const auto adu = decode_adu(stream);
    ASSERT_TRUE(adu.ok()) << length;
    EXPECT_EQ(adu->pdu.size(), length - 1U);
  }
}

TEST(Mbap, AWrongLengthIsSeenBeforeTheUnitArrives) {
  const Bytes stream = header_with_length(1);
  EXPECT_TRUE(decode_adu(std::span(stream).first(6)).malformed());
}

TEST(Mbap, AForeignProtocolStillSaysWhereTheNextUnitStarts) {
  const Bytes stream = {0, 1, 0, 5, 0, 3, 1, 0xAA, 0xBB, 0};
  const auto adu = decode_adu(stream);
  ASSERT_TRUE(adu.ok());
  EXPECT_EQ(adu->header.protocol, 5);
  EXPECT_EQ(adu.consumed(), 9U);
}

}  // namespace
}  // namespace rigwire::protocols::modbus
