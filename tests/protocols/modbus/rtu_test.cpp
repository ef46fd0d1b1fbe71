#include "protocols/modbus/rtu.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string_view>
#include <vector>

namespace rigwire::protocols::modbus {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

/// The long division itself, bit by bit.
std::uint16_t slow_crc(const Bytes& bytes) {
  unsigned crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 1U) != 0 ? (crc >> 1U) ^ 0xA001U : crc >> 1U;
    }
  }
  return static_cast<std::uint16_t>(crc);
}

TEST(Rtu, ChecksTheExampleOfTheSerialLineGuide) {
  EXPECT_EQ(crc16(Bytes{0x02, 0x07}), 0x1241);  // V1.02, 6.2.2: the frame ends with 41 12
}

TEST(Rtu, ChecksTheCatalogueString) {
  const std::string_view digits = "123456789";
  EXPECT_EQ(crc16(Bytes(digits.begin(), digits.end())), 0x4B37);  // CRC-16/MODBUS
}

TEST(Rtu, TheTableIsTheLongDivision) {
  Bytes bytes;
  for (unsigned i = 0; i < 256; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(i * 37 + 11));
    EXPECT_EQ(crc16(bytes), slow_crc(bytes));
  }
}

TEST(Rtu, EncodesAWellKnownRequest) {
  const Bytes pdu{0x03, 0x00, 0x00, 0x00, 0x0A};
  EXPECT_THAT(encode_rtu(1, pdu).view(), ::testing::ElementsAre(1, 3, 0, 0, 0, 10, 0xC5, 0xCD));
}

TEST(Rtu, RoundTripOfEveryLength) {
  for (std::size_t size = 1; size <= kPduMaximum; ++size) {
    Bytes pdu(size);
    for (std::size_t i = 0; i < size; ++i) {
      pdu[i] = static_cast<std::uint8_t>(i * 7 + size);
    }
    const RtuBytes bytes = encode_rtu(247, pdu);
    const auto frame = decode_rtu(bytes.view());
    ASSERT_TRUE(frame.ok()) << size;
    EXPECT_EQ(frame->address, 247);
    EXPECT_THAT(frame->pdu, ::testing::ElementsAreArray(pdu));
    EXPECT_EQ(frame.consumed(), size + 3);
  }
}

TEST(Rtu, EveryTruncationAndEveryTurnedBitIsMalformed) {
  const Bytes pdu{0x10, 0x00, 0x01, 0x00, 0x02, 0x04, 0x00, 0x0A, 0x01, 0x02};
  const RtuBytes good = encode_rtu(17, pdu);
  for (std::size_t size = 0; size < good.size; ++size) {
    EXPECT_TRUE(decode_rtu(good.view().first(size)).malformed()) << size;
  }
  for (std::size_t bit = 0; bit < 8 * good.size; ++bit) {
    RtuBytes bad = good;
    bad.bytes[bit / 8] = static_cast<std::uint8_t>(bad.bytes[bit / 8] ^ 1U << bit % 8);
    EXPECT_TRUE(decode_rtu(bad.view()).malformed()) << bit;
  }
}

TEST(Rtu, LongerThan256BytesIsMalformedWhateverItsCheck) {
  Bytes frame(257, 0x55);
  const std::uint16_t crc = crc16(std::span(frame).first(255));
  frame[255] = static_cast<std::uint8_t>(crc);
  frame[256] = static_cast<std::uint8_t>(crc >> 8U);
  ASSERT_EQ(crc16(frame), 0);
  EXPECT_TRUE(decode_rtu(frame).malformed());
}

TEST(RtuTiming, SilencesFollowTheCharacterUpTo19200) {
  // 11 bits at 9600 bit/s: 1145.83 us; at 19200: 572.916 us.
  const RtuTiming slow{9600, SerialCharacter::even_8e1};
  EXPECT_EQ(slow.characters(1), 1'145'833ns);
  EXPECT_EQ(slow.inside_limit(), 1'718'750ns);
  EXPECT_EQ(slow.frame_silence(), 4'010'416ns);
  const RtuTiming edge{19'200, SerialCharacter::none_8n2};
  EXPECT_EQ(edge.frame_silence(), 2'005'208ns);
  EXPECT_EQ(edge.characters(8), 4'583'333ns);
  EXPECT_EQ(edge.characters(25), 14'322'916ns);
}

TEST(RtuTiming, SilencesAreFixedAbove19200) {
  for (const std::uint32_t baud : {19'201U, 38'400U, 115'200U, 1'000'000U}) {
    const RtuTiming timing{baud, SerialCharacter::odd_8o1};
    EXPECT_EQ(timing.inside_limit(), 750us);
    EXPECT_EQ(timing.frame_silence(), 1750us);
  }
}

TEST(RtuTiming, TenBitsWithoutParityAndOneStopBit) {
  const RtuTiming timing{9600, SerialCharacter::none_8n1};
  EXPECT_EQ(timing.characters(96), 100ms);
}

}  // namespace
}  // namespace rigwire::protocols::modbus
