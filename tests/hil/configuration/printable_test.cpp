#include "hil/configuration/printable.h"

#include <gtest/gtest.h>

namespace rigwire::hil {
namespace {

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
