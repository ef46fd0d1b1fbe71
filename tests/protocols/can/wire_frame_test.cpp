#include "protocols/can/wire_frame.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace rigwire::protocols::can {
namespace {

std::string levels(const WireFrame& wire) {
  std::string text;
  for (unsigned bit = 0; bit < wire.stuffed_bits(); ++bit) {
    text += wire.recessive(bit) ? '1' : '0';
  }
  return text;
}

// By hand: identifier 0x123, RTR, IDE, r0, length 0; CRC by long division of 0 00100100011 000 0000
// by 1100010110011001.
TEST(WireFrame, BitsOfAnEmptyFrameByHand) {
  const WireFrame wire(Frame{0x123, false, false, 0, {}});
  const std::string expected =
      "0"            // SOF
      "00100100011"  // identifier
      "0"
      "0"
      "0"  // RTR, IDE, r0
      "00"
      "1"
      "00"                // length; five dominant bits were sent: a stuff bit after the second
      "110100001011000";  // CRC 0x6858
  EXPECT_EQ(checksum(Frame{0x123, false, false, 0, {}}), 0x6858);
  EXPECT_EQ(levels(wire), expected);
  EXPECT_TRUE(wire.is_stuff_bit(17));
  EXPECT_FALSE(wire.is_stuff_bit(16));
  EXPECT_EQ(wire.acknowledge_slot(), 36U);
  EXPECT_EQ(wire.last_bit(), 44U);
}

TEST(WireFrame, EndsWhereTheTablesSay) {
  std::uint64_t state = 1;
  for (int i = 0; i < 20'000; ++i) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    Frame frame;
    frame.extended = (state >> 60U & 1U) != 0;
    frame.remote = (state >> 57U & 7U) == 0;
    frame.id = static_cast<std::uint32_t>(state >> 20U) & (frame.extended ? 0x1FFF'FFFFU : 0x7FFU);
    frame.length = static_cast<std::uint8_t>((state >> 50U) % 9);
    for (std::size_t k = 0; k < 8; ++k) {
      // Runs, as sensors send them, and noise.
      frame.data[k] = static_cast<std::uint8_t>((state >> 61U) == 0 ? 0U : state >> (5U * k));
    }
    const WireFrame wire(frame);
    ASSERT_EQ(wire.last_bit() + 1 + kInterframeBits, exact_bits(frame));
  }
}

TEST(WireFrame, NeverHasSixEqualBits) {
  for (unsigned pattern = 0; pattern < 256; ++pattern) {
    Frame frame{pattern * 0x10101U, true, false, 8, {}};
    frame.data.fill(static_cast<std::uint8_t>(pattern));
    const WireFrame wire(frame);
    EXPECT_EQ(levels(wire).find("000000"), std::string::npos);
    EXPECT_EQ(levels(wire).find("111111"), std::string::npos);
  }
}

TEST(WireFrame, NamesTheFieldOfEveryBit) {
  using enum FrameField;
  const WireFrame wire(Frame{0x2AA, false, false, 1, {0xAA}});  // No stuff bit in front of r0.
  EXPECT_EQ(wire.field(0), start_of_frame);
  EXPECT_EQ(wire.field(1), identifier_28_21);
  EXPECT_EQ(wire.field(8), identifier_28_21);
  EXPECT_EQ(wire.field(9), identifier_20_18);
  EXPECT_EQ(wire.field(12), substitute_remote);
  EXPECT_EQ(wire.field(13), identifier_extension);
  EXPECT_EQ(wire.field(14), reserved_0);
  EXPECT_EQ(wire.field(15), length_code);
  EXPECT_EQ(wire.field(wire.stuffed_bits() - 1), crc_sequence);
  EXPECT_EQ(wire.field(wire.stuffed_bits()), crc_delimiter);
  EXPECT_EQ(wire.field(wire.acknowledge_slot()), acknowledge_slot);
  EXPECT_EQ(wire.field(wire.acknowledge_slot() + 1), acknowledge_delimiter);
  EXPECT_EQ(wire.field(wire.last_bit()), end_of_frame);
  EXPECT_EQ(wire.field(wire.last_bit() + 1), intermission);
  EXPECT_TRUE(wire.in_arbitration(1));
  EXPECT_TRUE(wire.in_arbitration(12));
  EXPECT_FALSE(wire.in_arbitration(0));
  EXPECT_FALSE(wire.in_arbitration(14));
}

TEST(WireFrame, FirstDifferenceOfEqualIdentifiersIsInLengthOrData) {
  const Frame a{0x555, false, false, 2, {0x55, 0x01}};
  Frame b = a;
  EXPECT_EQ(first_difference(WireFrame(a), WireFrame(b)), WireFrame(a).last_bit() + 1);
  b.data[1] = 0x00;
  // SOF, 11 identifier, RTR, IDE, r0, 4 length, 16 data: the last of them is number 34 of the
  // frame. In front of it are two stuff bits: RTR, IDE, r0 and two bits of the length are five
  // dominant ones, and so are the first five of the second byte.
  EXPECT_EQ(first_difference(WireFrame(a), WireFrame(b)), 36U);
}

}  // namespace
}  // namespace rigwire::protocols::can
