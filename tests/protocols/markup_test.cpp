#include "protocols/markup.h"

#include <gtest/gtest.h>

namespace rigwire::protocols {
namespace {

TEST(Markup, NamesCannotEndTheirAttributeOrOpenAnElement) {
  EXPECT_EQ(escape_markup("a\"b<c>&d"), "a&quot;b&lt;c>&amp;d");
  EXPECT_EQ(escape_markup("&lt;"), "&amp;lt;") << "escaped once more, not left";
  EXPECT_EQ(escape_markup("M\xC3\xBC"), "M\xC3\xBC");
}

TEST(Markup, BytesThatAreNoTextAreSpelledOut) {
  EXPECT_EQ(escape_markup("\xE9\x01 a\tb\n"), "\\xe9\\u0001 a\tb\n");
}

}  // namespace
}  // namespace rigwire::protocols
