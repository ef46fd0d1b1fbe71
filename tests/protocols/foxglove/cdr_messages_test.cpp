#include "protocols/foxglove/cdr_messages.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace rigwire::protocols::foxglove {
namespace {

using namespace std::string_literals;

// Bytes worked by hand from the rules of CDR; Foxglove's own reader takes a whole cloud in
// tests/conformance/dashboard_foxglove.mjs.

TEST(CdrMessages, ACloudsMembersAreAtMultiplesOfTheirSizes) {
  constexpr std::array<PackedField, 2> kFields{
      {{"x", 0, NumericType::float32}, {"laser", 4, NumericType::uint8}}};
  std::string bytes = begin_point_cloud({.unix_ns = 0x10'0000'0002,
                                         .frame_id = "a",
                                         .position_m = {1.0, 0.0, 0.0},
                                         .point_stride = 5,
                                         .fields = kFields},
                                        3);
  // 0x1000000002 ns are 68 s and 719476738 ns.
  const std::string one = "\0\0\0\0\0\0\xF0\x3F"s;
  const std::string zero(8, '\0');
  std::string expected = "\0\1\0\0"s + "\x44\0\0\0"s + "\x02\x58\xE2\x2A"s;
  expected += "\2\0\0\0"s + "a\0"s + "\0\0"s;  // up to 16, for a number of 8 bytes
  expected += one + zero + zero;               // position
  expected += zero + zero + zero + one;        // orientation
  expected += "\5\0\0\0"s + "\2\0\0\0"s;
  expected += "\2\0\0\0x\0"s + "\0\0"s + "\0\0\0\0"s + "\7"s;
  expected += "\0\0\0"s + "\6\0\0\0laser\0"s + "\0\0"s + "\4\0\0\0"s + "\1"s;
  expected += "\0\0\0"s + "\3\0\0\0"s;
  EXPECT_EQ(bytes, expected);
}

TEST(CdrMessages, APicturesBlockIsAtAMultipleOfEight) {
  const std::string bytes = begin_raw_image({.unix_ns = 1'000'000'000,
                                             .frame_id = "a",
                                             .width = 3,
                                             .height = 2,
                                             .encoding = "rgb8",
                                             .step = 9,
                                             .block = 0x1'0000'0002,
                                             .sent_width = 6,
                                             .sent_height = 4,
                                             .remark = "abc"},
                                            18);
  std::string expected = "\0\1\0\0"s + "\1\0\0\0"s + "\0\0\0\0"s;
  expected += "\2\0\0\0"s + "a\0"s + "\0\0"s;                             // up to 16
  expected += "\3\0\0\0"s + "\2\0\0\0"s + "\5\0\0\0rgb8\0"s + "\0\0\0"s;  // up to 36
  expected += "\x9\0\0\0"s + "\2\0\0\0\1\0\0\0"s + "\6\0\0\0"s + "\4\0\0\0"s;
  expected += "\4\0\0\0abc\0"s;
  expected += "\x12\0\0\0"s;
  EXPECT_EQ(bytes, expected);
}

}  // namespace
}  // namespace rigwire::protocols::foxglove
