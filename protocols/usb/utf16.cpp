#include "protocols/usb/utf16.h"

#include <cstdint>

namespace rigwire::protocols::usb {
namespace {

constexpr char32_t kReplacement = 0xFFFD;
constexpr char32_t kFirstSupplementary = 0x10000;
constexpr char32_t kLast = 0x10FFFF;

constexpr bool is_high_surrogate(char32_t c) {
  return c >= 0xD800 && c < 0xDC00;
}
constexpr bool is_low_surrogate(char32_t c) {
  return c >= 0xDC00 && c < 0xE000;
}

void append_utf8(std::string& out, char32_t c) {
  const auto put = [&out](char32_t byte) { out.push_back(static_cast<char>(byte)); };
  const auto tail = [&put, c](unsigned shift) { put(0x80U | ((c >> shift) & 0x3FU)); };
  if (c < 0x80) {
    put(c);
  } else if (c < 0x800) {
    put(0xC0U | (c >> 6U));
    tail(0);
  } else if (c < kFirstSupplementary) {
    put(0xE0U | (c >> 12U));
    tail(6);
    tail(0);
  } else {
    put(0xF0U | (c >> 18U));
    tail(12);
    tail(6);
    tail(0);
  }
}

}  // namespace

std::optional<std::u16string> utf16_from_utf8(std::string_view text) {
  std::u16string out;
  for (std::size_t at = 0; at < text.size();) {
    const auto first = static_cast<std::uint8_t>(text[at++]);
    const unsigned tails = first < 0x80 ? 0U : first < 0xE0 ? 1U : first < 0xF0 ? 2U : 3U;
    if ((first >= 0x80 && first < 0xC0) || first >= 0xF8 || text.size() - at < tails) {
      return std::nullopt;
    }
    char32_t c = tails == 0 ? first : first & (0x3FU >> tails);
    for (unsigned i = 0; i < tails; ++i) {
      const auto next = static_cast<std::uint8_t>(text[at++]);
      if ((next & 0xC0U) != 0x80) {
        return std::nullopt;
      }
      c = (c << 6U) | (next & 0x3FU);
    }
    constexpr char32_t kLeast[] = {0, 0x80, 0x800, kFirstSupplementary};
    if (c < kLeast[tails] || c > kLast || is_high_surrogate(c) || is_low_surrogate(c)) {
      return std::nullopt;
    }
    if (c < kFirstSupplementary) {
      out.push_back(static_cast<char16_t>(c));
    } else {
      out.push_back(static_cast<char16_t>(0xD800U + ((c - kFirstSupplementary) >> 10U)));
      out.push_back(static_cast<char16_t>(0xDC00U + ((c - kFirstSupplementary) & 0x3FFU)));
    }
  }
  return out;
}

std::string utf8_from_utf16(std::u16string_view text) {
  std::string out;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char32_t unit = text[at];
    if (is_high_surrogate(unit) && at + 1 < text.size() && is_low_surrogate(text[at + 1])) {
      append_utf8(out, kFirstSupplementary + ((unit - 0xD800U) << 10U) + (text[at + 1] - 0xDC00U));
      ++at;
    } else {
      append_utf8(out, is_high_surrogate(unit) || is_low_surrogate(unit) ? kReplacement : unit);
    }
  }
  return out;
}

}  // namespace rigwire::protocols::usb
