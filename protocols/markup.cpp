#include "protocols/markup.h"

#include "protocols/plain_text.h"

namespace rigwire::protocols {

std::string escape_markup(std::string_view text) {
  std::string result;
  for (const char c : printable(text, "\t\n")) {
    switch (c) {
      case '<':
        result += "&lt;";
        break;
      case '&':
        result += "&amp;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
        break;
    }
  }
  return result;
}

}  // namespace rigwire::protocols
