#include "hil/configuration/plain_text.h"

#include <gtest/gtest.h>

#include <string>

namespace rigwire::hil {
namespace {

TEST(PlainText, utf8_of_every_length_is_fine) {
  EXPECT_FALSE(find_fault("Bagger \u00FC \u20AC \U0001F69C", TextShape::one_line));
  EXPECT_FALSE(
      find_fault("\u07FF\u0800\uD7FF\uE000\uFFFD\U00010000\U0010FFFF", TextShape::one_line));
  EXPECT_FALSE(find_fault("", TextShape::one_line));
}

TEST(PlainText, what_is_not_utf8_is_found_at_its_first_byte) {
  struct Bad {
    const char* what;
    std::string bytes;
  };
  for (const Bad& bad :
       {Bad{"Latin-1", "\xE9t\xE9"}, Bad{"a byte that continues nothing", "\x80"},
        Bad{"overlong", "\xC0\xAF"}, Bad{"overlong of three", "\xE0\x9F\xBF"},
        Bad{"overlong of four", "\xF0\x8F\xBF\xBF"}, Bad{"a surrogate", "\xED\xA0\x80"},
        Bad{"too high", "\xF4\x90\x80\x80"}, Bad{"too high a lead", "\xF8\x88\x80\x80\x80"},
        Bad{"cut off", "\xE2\x82"}}) {
    const auto fault = find_fault("ab" + bad.bytes, TextShape::lines);
    ASSERT_TRUE(fault) << bad.what;
    EXPECT_EQ(fault->offset, 2U) << bad.what;
    EXPECT_EQ(fault->what, "not UTF-8") << bad.what;
  }
}

TEST(PlainText, what_a_terminal_obeys_is_found) {
  for (const std::string control : {"\x1B", "\x07", "\x7F", "\u009B", "\u0085"}) {
    EXPECT_TRUE(find_fault(control, TextShape::lines)) << printable(control);
  }
  EXPECT_TRUE(find_fault(std::string(1, '\0'), TextShape::lines));
  EXPECT_FALSE(find_fault("a\tb\r\n", TextShape::lines));
  EXPECT_TRUE(find_fault("a\tb", TextShape::one_line));
  EXPECT_TRUE(find_fault("a\nb", TextShape::one_line));
}

TEST(PlainText, what_must_not_be_shown_is_spelled) {
  EXPECT_EQ(printable("caf\xE9 \x1B[2J \u009B"), "caf\\xE9 \\x1B[2J \\xC2\\x9B");
  EXPECT_EQ(printable("caf\u00E9"), "caf\u00E9");
}

}  // namespace
}  // namespace rigwire::hil
