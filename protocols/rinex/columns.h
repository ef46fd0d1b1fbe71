// Lines of RINEX files under construction.
#pragma once

#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>

namespace rigwire::protocols::rinex {

/// Appends as std::printf would print; at most 255 characters.
[[gnu::format(printf, 2, 3)]] inline void append(std::string& out, const char* format, ...) {
  char buffer[256];
  std::va_list arguments;
  va_start(arguments, format);
  const int length = std::vsnprintf(buffer, sizeof buffer, format, arguments);
  va_end(arguments);
  if (length > 0) {
    out.append(buffer, static_cast<std::size_t>(length) < sizeof buffer
                           ? static_cast<std::size_t>(length)
                           : sizeof buffer - 1);
  }
}

/// Appends a header line: 60 columns of content, then its label.
inline void append_header(std::string& out, std::string_view content, std::string_view label) {
  constexpr std::size_t kLabelColumn = 60;
  content = content.substr(0, kLabelColumn);
  out.append(content).append(kLabelColumn - content.size(), ' ').append(label).append("\n");
}

/// `text` in exactly `width` columns, from the left.
[[nodiscard]] inline std::string padded(std::string_view text, std::size_t width) {
  std::string result(text.substr(0, width));
  result.resize(width, ' ');
  return result;
}

}  // namespace rigwire::protocols::rinex
