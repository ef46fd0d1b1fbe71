#include "hil/configuration/plain_text.h"

#include <fmt/format.h>

#include <cstdint>

namespace rigwire::hil {
namespace {

struct CodePoint {
  std::size_t bytes = 0;  ///< 0: not UTF-8.
  std::uint32_t value = 0;
};

/// The code point that a text, which is not empty, begins with.
CodePoint first_of(std::string_view text) {
  const auto byte = [&](std::size_t at) {
    return at < text.size() ? static_cast<std::uint8_t>(text[at]) : std::uint8_t{0};
  };
  const std::uint8_t lead = byte(0);
  if (lead < 0x80) {
    return {1, lead};
  }
  const std::size_t bytes = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4) {
    return {};
  }
  // The lead's own bits, then six of each byte that continues it.
  std::uint32_t value = lead & (0x7FU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) {
      return {};
    }
    value = (value << 6U) | (byte(i) & 0x3FU);
  }
  const bool overlong = (bytes == 3 && value < 0x800) || (bytes == 4 && value < 0x10000);
  const bool surrogate = value >= 0xD800 && value <= 0xDFFF;
  return overlong || surrogate || value > 0x10FFFF ? CodePoint{} : CodePoint{bytes, value};
}

bool is_control(std::uint32_t value) {
  return value < 0x20 || (value >= 0x7F && value < 0xA0);
}

bool is_layout(std::uint32_t value) {
  return value == '\t' || value == '\n' || value == '\r';
}

}  // namespace

std::optional<TextFault> find_fault(std::string_view text, TextShape shape) {
  for (std::size_t at = 0; at < text.size();) {
    const CodePoint point = first_of(text.substr(at));
    if (point.bytes == 0) {
      return TextFault{at, "not UTF-8",
                       fmt::format("byte 0x{:02X}", static_cast<std::uint8_t>(text[at]))};
    }
    if (is_control(point.value) && (shape == TextShape::one_line || !is_layout(point.value))) {
      return TextFault{at, "a control character", fmt::format("U+{:04X}", point.value)};
    }
    at += point.bytes;
  }
  return std::nullopt;
}

std::string printable(std::string_view text) {
  std::string shown;
  while (!text.empty()) {
    const CodePoint point = first_of(text);
    const std::size_t bytes = point.bytes == 0 ? 1 : point.bytes;
    if (point.bytes == 0 || is_control(point.value)) {
      for (const char byte : text.substr(0, bytes)) {
        shown += fmt::format("\\x{:02X}", static_cast<std::uint8_t>(byte));
      }
    } else {
      shown += text.substr(0, bytes);
    }
    text.remove_prefix(bytes);
  }
  return shown;
}

}  // namespace rigwire::hil
