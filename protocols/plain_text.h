// Text that comes from outside (files, arguments, what a client sent): whether it is UTF-8 that can
// be shown, and how to show the rest, so that nothing in it can steer a terminal.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace rigwire::protocols {

/// What a text may hold beside what can be seen.
enum class TextShape {
  one_line,  ///< Nothing: a name, a value, an argument.
  lines,     ///< Tabs and ends of lines, too: a file.
};

struct TextFault {
  std::size_t offset = 0;  ///< Offset of the first invalid byte.
  std::string what;        ///< "not UTF-8", or "a control character".
  std::string found;       ///< "byte 0xE9", "U+001B".
};

/// The first place at which a text is not UTF-8 (Unicode 15.0, table 3-7: no overlong forms, no
/// surrogates, up to U+10FFFF) or has a control character (U+0000 to U+001F, U+007F to U+009F),
/// which a terminal would obey and not show.
[[nodiscard]] std::optional<TextFault> find_fault(std::string_view text, TextShape shape);

/// `text` with every character that a terminal would obey spelled out as JSON and YAML do (\u001b):
/// C0 and C1 control codes, DEL, line separators and what changes the direction of writing (Unicode
/// 15.1, 23.1 and 23.2; ECMA-48, 5.3); bytes that are not UTF-8 as \xe9. `kept` stay as they are.
[[nodiscard]] std::string printable(std::string_view text, std::string_view kept = "");

/// First character of a text.
struct Character {
  char32_t code = 0;
  std::size_t bytes = 1;
  bool valid = false;  ///< False: one byte that is not UTF-8 (RFC 3629).
};
/// Returns the first character. Precondition: the text is not empty.
[[nodiscard]] Character first_character(std::string_view text);

}  // namespace rigwire::protocols
