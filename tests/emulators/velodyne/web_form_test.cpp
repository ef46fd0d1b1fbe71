#include "emulators/velodyne/web_form.h"

#include <gtest/gtest.h>

namespace rigwire::emulators {
namespace {

using Fields = std::vector<FormField>;

TEST(VelodyneWebForm, TakesFieldsInTheirOrder) {
  EXPECT_EQ(parse_form("laser=Off&rpm=0&returns=Strongest"),
            (Fields{{"laser", "Off"}, {"rpm", "0"}, {"returns", "Strongest"}}));
  EXPECT_EQ(parse_form("submit"), (Fields{{"submit", ""}}));
  EXPECT_EQ(parse_form("&&a=b=c&"), (Fields{{"a", "b=c"}}));
  EXPECT_EQ(parse_form(""), Fields{});
}

TEST(VelodyneWebForm, DecodesEscapes) {
  EXPECT_EQ(parse_form("addr=192%2E168.1%2e5"), (Fields{{"addr", "192.168.1.5"}}));
  EXPECT_EQ(parse_form("a+b=%2B+"), (Fields{{"a b", "+ "}}));
}

TEST(VelodyneWebForm, LineEndOfAScriptIsNoField) {
  EXPECT_EQ(parse_form("rpm=600\r\n"), (Fields{{"rpm", "600"}}));
}

TEST(VelodyneWebForm, RefusesBrokenEscapesAndControlCharacters) {
  for (const char* body : {"rpm=%", "rpm=%6", "rpm=%6g", "rpm=%-1", "rpm=%00", "rpm=%0a", "%zz=1",
                           "a=1\nb=2", "rpm=\x01"}) {
    EXPECT_EQ(parse_form(body), std::nullopt) << body;
  }
}

TEST(VelodyneWebForm, NumbersAreDigitsWithinTheirRange) {
  EXPECT_EQ(parse_number("0", 0, 359), 0);
  EXPECT_EQ(parse_number("0359", 0, 359), 359);
  for (const char* text : {"", "-1", "+1", "1.0", " 1", "1 ", "0x10", "360", "99999999999999"}) {
    EXPECT_EQ(parse_number(text, 0, 359), std::nullopt) << text;
  }
}

TEST(VelodyneWebForm, AddressesHaveFourNumbers) {
  EXPECT_TRUE(is_ipv4_address("192.168.1.201"));
  EXPECT_TRUE(is_ipv4_address("255.255.255.255"));
  for (const char* text : {"", "1.2.3", "1.2.3.4.5", "1.2.3.256", "1..3.4", "1.2.3.4 ", "a.b.c.d",
                           "1.2.3.0004", "1.2.3.-4", "::1", "1.2.3."}) {
    EXPECT_FALSE(is_ipv4_address(text)) << text;
  }
}

TEST(VelodyneWebForm, WordsMatchInAnyCase) {
  EXPECT_EQ(parse_switch("On"), true);
  EXPECT_EQ(parse_switch("OFF"), false);
  EXPECT_EQ(parse_switch("1"), std::nullopt);
  EXPECT_FALSE(same_word("Dual", "Duals"));
}

}  // namespace
}  // namespace rigwire::emulators
