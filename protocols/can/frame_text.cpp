#include "protocols/can/frame_text.h"

namespace rigwire::protocols::can {
namespace {

constexpr std::string_view kDigits = "0123456789ABCDEF";

std::optional<std::uint32_t> hexadecimal(std::string_view text) {
  std::uint32_t value = 0;
  for (const char c : text) {
    const char upper = c >= 'a' && c <= 'f' ? static_cast<char>(c - 'a' + 'A') : c;
    const auto digit = kDigits.find(upper);
    if (digit == std::string_view::npos) {
      return std::nullopt;
    }
    value = value << 4U | static_cast<std::uint32_t>(digit);
  }
  return value;
}

/// A length code above eight that a classic frame of eight bytes had on the wire: "_9" to "_F". A
/// frame keeps the eight.
std::string_view without_raw_code(std::string_view text) {
  const bool has = text.size() >= 2 && text[text.size() - 2] == '_';
  const auto code = has ? hexadecimal(text.substr(text.size() - 1)) : std::nullopt;
  return code && *code > 8 ? text.substr(0, text.size() - 2) : text;
}

bool parse_remote(std::string_view length, Frame& frame) {
  frame.remote = true;
  if (length.size() > 1 || (length.size() == 1 && (length[0] < '0' || length[0] > '8'))) {
    return false;
  }
  frame.length = length.empty() ? std::uint8_t{0} : static_cast<std::uint8_t>(length[0] - '0');
  return true;
}

bool parse_data(std::string_view text, Frame& frame) {
  while (!text.empty()) {
    const auto byte = text.size() < 2 ? std::nullopt : hexadecimal(text.substr(0, 2));
    if (!byte || frame.length == 8) {
      return false;
    }
    frame.data[frame.length++] = static_cast<std::uint8_t>(*byte);
    text.remove_prefix(2);
    if (text.size() > 1 && text.front() == '.') {
      text.remove_prefix(1);
    }
  }
  return true;
}

void put(std::string& text, std::uint32_t value, unsigned digits) {
  for (unsigned i = digits; i-- > 0;) {
    text += kDigits[value >> (4 * i) & 0xFU];
  }
}

}  // namespace

std::optional<Frame> parse_frame_text(std::string_view text) {
  const auto mark = text.find('#');
  if (mark != 3 && mark != 8) {
    return std::nullopt;
  }
  Frame frame;
  frame.extended = mark == 8;
  const auto id = hexadecimal(text.substr(0, mark));
  if (!id || *id > (frame.extended ? 0x1FFFFFFFU : 0x7FFU)) {
    return std::nullopt;
  }
  frame.id = *id;
  const std::string_view rest = text.substr(mark + 1);
  const bool remote = !rest.empty() && (rest.front() == 'R' || rest.front() == 'r');
  const std::string_view plain = without_raw_code(rest);
  if (!(remote ? parse_remote(plain.substr(1), frame) : parse_data(plain, frame)) ||
      (plain.size() != rest.size() && frame.length != 8)) {
    return std::nullopt;
  }
  return frame;
}

std::string frame_text(const Frame& frame) {
  std::string text;
  put(text, frame.id, frame.extended ? 8 : 3);
  text += '#';
  if (frame.remote) {
    text += 'R';
    if (frame.length != 0) {
      put(text, frame.length, 1);
    }
  }
  for (const std::uint8_t byte : frame.payload()) {
    put(text, byte, 2);
  }
  return text;
}

}  // namespace rigwire::protocols::can
