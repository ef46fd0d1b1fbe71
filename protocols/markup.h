// Text within XML or HTML.
#pragma once

#include <string>
#include <string_view>

namespace rigwire::protocols {

/// `text` as content of an element or of an attribute in double quotes.
[[nodiscard]] std::string escape_markup(std::string_view text);

}  // namespace rigwire::protocols
