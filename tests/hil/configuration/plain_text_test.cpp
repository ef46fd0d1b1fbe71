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

TEST(Printable, letters_of_every_script_stay) {
  EXPECT_EQ(printable("Bagger Kettenfahrzeug"), "Bagger Kettenfahrzeug");
  EXPECT_EQ(printable("Löffel 挖掘机 🚜"), "Löffel 挖掘机 🚜");
}

TEST(Printable, what_a_terminal_would_obey_is_spelled_out) {
  EXPECT_EQ(printable("a\x1b[2Jb"), "a\\u001b[2Jb");
  EXPECT_EQ(printable("a\r\nb\x7f"), "a\\u000d\\u000ab\\u007f");
  EXPECT_EQ(printable("\xc2\x9b"
                      "2J"),
            "\\u009b2J")
      << "C1, the one-character CSI";
  EXPECT_EQ(printable("\xe2\x80\xae"
                      "exe.txt"),
            "\\u202eexe.txt")
      << "right-to-left override";
}

TEST(Printable, bytes_that_are_not_utf8_are_spelled_out_one_by_one) {
  EXPECT_EQ(printable("Stra\xdf"
                      "e"),
            "Stra\\xdfe")
      << "Latin-1";
  EXPECT_EQ(printable("\x9b"
                      "2J"),
            "\\x9b2J");
  EXPECT_EQ(printable("\xe2\x80"), "\\xe2\\x80") << "cut off";
  EXPECT_EQ(printable("\xc0\xaf"), "\\xc0\\xaf") << "longer than needed";
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80") << "surrogate";
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80") << "beyond Unicode";
}

TEST(Printable, layout_stays_where_it_is_asked_for) {
  EXPECT_EQ(printable("a\n\tb\x1b", "\n\t"), "a\n\tb\\u001b");
}

}  // namespace
}  // namespace rigwire::hil
