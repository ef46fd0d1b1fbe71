// Text that came from outside (names in files, arguments, what a client sent) as it may be shown to
// people: nothing in it can steer their terminal.
#pragma once

#include <string>
#include <string_view>

namespace rigwire::hil {

/// `text` with every character that a terminal would obey spelled out as JSON and YAML do (\u001b):
/// C0 and C1 control codes, DEL, line separators and what changes the direction of writing (Unicode
/// 15.1, 23.1 and 23.2; ECMA-48, 5.3); bytes that are not UTF-8 as \xe9. `kept` stay as they are.
[[nodiscard]] std::string printable(std::string_view text, std::string_view kept = "");

/// A character in front of the rest.
struct Character {
  char32_t code = 0;
  std::size_t bytes = 1;
  bool valid = false;  ///< Else one byte that is no UTF-8 (RFC 3629).
};
/// Of a text that is not empty.
[[nodiscard]] Character first_character(std::string_view text);

}  // namespace rigwire::hil
