// Text that comes from outside: whether it is UTF-8 that can be shown, and how to show what is not.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace rigwire::hil {

/// What a text may hold beside what can be seen.
enum class TextShape {
  one_line,  ///< Nothing: a name, a value, an argument.
  lines,     ///< Tabs and ends of lines, too: a file.
};

struct TextFault {
  std::size_t offset = 0;  ///< Of the first byte that is wrong.
  std::string what;        ///< "not UTF-8", or "a control character".
  std::string found;       ///< "byte 0xE9", "U+001B".
};

/// The first place at which a text is not UTF-8 (Unicode 15.0, table 3-7: no overlong forms, no
/// surrogates, up to U+10FFFF) or has a control character (U+0000 to U+001F, U+007F to U+009F),
/// which a terminal would obey and not show.
[[nodiscard]] std::optional<TextFault> find_fault(std::string_view text, TextShape shape);

/// The text with `\xNN` for each byte of it that must not be shown.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace rigwire::hil
