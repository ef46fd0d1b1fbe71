#include "protocols/markup.h"

#include <gtest/gtest.h>

namespace rigwire::protocols {
namespace {

TEST(Markup, NamesCannotEndTheirAttributeOrOpenAnElement) {
  EXPECT_EQ(escape_markup("a\"b<c>&d"), "a&quot;b&lt;c>&amp;d");
  EXPECT_EQ(escape_markup("&lt;"), "&amp;lt;") << "escaped once more, not left";
  EXPECT_EQ(escape_markup("M\xC3\xBC"), "M\xC3\xBC");
}

}  // namespace
}  // namespace rigwire::protocols
