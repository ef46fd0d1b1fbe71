#include "protocols/can/frame_text.h"

#include <gtest/gtest.h>

namespace rigwire::protocols::can {
namespace {

TEST(FrameText, AsCandumpWritesIt) {
  const Frame request{0x18EAFFFE, true, false, 3, {0x00, 0xEE, 0x00}};
  EXPECT_EQ(frame_text(request), "18EAFFFE#00EE00");
  EXPECT_EQ(parse_frame_text("18EAFFFE#00EE00"), request);
  EXPECT_EQ(parse_frame_text("18eafffe#00.ee.00"), request);
  EXPECT_EQ(parse_frame_text("7FF#"), (Frame{0x7FF, false, false, 0, {}}));
  EXPECT_EQ(parse_frame_text("123#R"), (Frame{0x123, false, true, 0, {}}));
  EXPECT_EQ(parse_frame_text("123#R4"), (Frame{0x123, false, true, 4, {}}));
  EXPECT_EQ(frame_text({0x123, false, true, 4, {}}), "123#R4");
}

TEST(FrameText, WhatIsNoFrame) {
  for (const char* text :
       {"", "#", "12#", "1234#00", "123", "800#00", "20000000#", "123#0", "123#0G", "123#R9",
        "123#R12", "123#000102030405060708", "123##100", "123#00."}) {
    EXPECT_FALSE(parse_frame_text(text)) << text;
  }
}

}  // namespace
}  // namespace rigwire::protocols::can
