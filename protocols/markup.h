// Text within XML or HTML.
#pragma once

#include <string>
#include <string_view>

namespace rigwire::protocols {

/// Returns `text` as content of an element or of an attribute in double quotes. The result is UTF-8
/// without control characters but tabs and ends of lines, whatever bytes the text has.
[[nodiscard]] std::string escape_markup(std::string_view text);

}  // namespace rigwire::protocols
