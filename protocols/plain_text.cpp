#include "protocols/plain_text.h"

#include <array>
#include <cstdio>

namespace rigwire::protocols {
namespace {

bool is_control(char32_t code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0);
}

bool is_layout(char32_t code) {
  return code == '\t' || code == '\n' || code == '\r';
}

/// Marks and isolates of bidirectional text, line and paragraph separators.
bool steers_direction(char32_t code) {
  return code == 0x061C || code == 0x200E || code == 0x200F || (code >= 0x2028 && code <= 0x202E) ||
         (code >= 0x2066 && code <= 0x2069);
}

std::string code_text(const char* format, char32_t code) {
  std::array<char, 24> text{};
  std::snprintf(text.data(), text.size(), format, static_cast<unsigned>(code));
  return text.data();
}

}  // namespace

Character first_character(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned head = byte(0);
  if (head < 0x80) {
    return {head, 1, true};
  }
  // Length by the leading byte, and the lowest code of that length: no other spelling is valid.
  const std::size_t length = head >= 0xF0 ? 4 : head >= 0xE0 ? 3 : 2;
  if (head < 0xC2 || head > 0xF4 || text.size() < length) {
    return {head, 1, false};
  }
  char32_t code = head & (0x7FU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) {
      return {head, 1, false};
    }
    code = (code << 6U) | (byte(i) & 0x3FU);
  }
  const char32_t least = length == 4 ? 0x10000 : length == 3 ? 0x800 : 0x80;
  const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
  if (code < least || code > 0x10FFFF || surrogate) {
    return {head, 1, false};
  }
  return {code, length, true};
}

std::optional<TextFault> find_fault(std::string_view text, TextShape shape) {
  for (std::size_t at = 0; at < text.size();) {
    const Character next = first_character(text.substr(at));
    if (!next.valid) {
      return TextFault{at, "not UTF-8", code_text("byte 0x%02X", next.code)};
    }
    if (is_control(next.code) && (shape == TextShape::one_line || !is_layout(next.code))) {
      return TextFault{at, "a control character", code_text("U+%04X", next.code)};
    }
    at += next.bytes;
  }
  return std::nullopt;
}

std::string printable(std::string_view text, std::string_view kept) {
  std::string shown;
  shown.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const Character next = first_character(text.substr(at));
    const std::string_view bytes = text.substr(at, next.bytes);
    if (kept.find(bytes.front()) != std::string_view::npos && next.bytes == 1) {
      shown += bytes;
    } else if (!next.valid) {
      shown += code_text("\\x%02x", next.code);
    } else if (is_control(next.code) || steers_direction(next.code)) {
      shown += code_text("\\u%04x", next.code);
    } else {
      shown += bytes;
    }
    at += next.bytes;
  }
  return shown;
}

}  // namespace rigwire::protocols
