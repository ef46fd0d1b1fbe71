#include "emulators/velodyne/web_form.h"

#include <algorithm>
#include <charconv>

namespace rigwire::emulators {
namespace {

char lower_case(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

std::optional<std::string> decode(std::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char c = text[i];
    if (c == '+') {
      c = ' ';
    } else if (c == '%') {
      unsigned code = 0;
      const std::string_view digits = text.substr(i + 1, 2);
      const auto [end, error] =
          std::from_chars(digits.data(), digits.data() + digits.size(), code, 16);
      if (digits.size() != 2 || error != std::errc() || end != digits.data() + 2) {
        return std::nullopt;
      }
      c = static_cast<char>(code);
      i += 2;
    }
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F) {
      return std::nullopt;
    }
    decoded += c;
  }
  return decoded;
}

}  // namespace

std::optional<std::vector<FormField>> parse_form(std::string_view body) {
  while (body.ends_with('\n') || body.ends_with('\r')) {  // what a script's `echo` leaves behind
    body.remove_suffix(1);
  }
  std::vector<FormField> fields;
  while (!body.empty()) {
    const std::size_t end = std::min(body.find('&'), body.size());
    const std::string_view piece = body.substr(0, end);
    body.remove_prefix(std::min(end + 1, body.size()));
    if (piece.empty()) {
      continue;
    }
    const std::size_t equals = std::min(piece.find('='), piece.size());
    auto name = decode(piece.substr(0, equals));
    auto value = decode(piece.substr(std::min(equals + 1, piece.size())));
    if (!name || !value) {
      return std::nullopt;
    }
    fields.push_back({std::move(*name), std::move(*value)});
  }
  return fields;
}

std::optional<bool> parse_switch(std::string_view text) {
  if (same_word(text, "on")) {
    return true;
  }
  if (same_word(text, "off")) {
    return false;
  }
  return std::nullopt;
}

std::optional<int> parse_number(std::string_view text, int lower, int upper) {
  int value = 0;
  const bool digits =
      !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (!digits || error != std::errc() || value < lower || value > upper) {
    return std::nullopt;
  }
  return value;
}

bool is_ipv4_address(std::string_view text) {
  constexpr int kNumbers = 4;
  constexpr std::size_t kDigits = 3;
  for (int number = 0; number < kNumbers; ++number) {
    const bool last = number == kNumbers - 1;
    const std::size_t end = last ? text.size() : text.find('.');
    if (end > kDigits ||  // npos, too
        !parse_number(text.substr(0, end), 0, 255)) {
      return false;
    }
    text.remove_prefix(last ? end : end + 1);
  }
  return true;
}

bool same_word(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, {}, lower_case, lower_case);
}

}  // namespace rigwire::emulators
