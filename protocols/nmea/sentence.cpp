#include "protocols/nmea/sentence.h"

#include <algorithm>
#include <charconv>

namespace rigwire::protocols::nmea {
namespace {

constexpr std::string_view kDigits = "0123456789ABCDEF";
constexpr std::size_t kTail = 1 /*star*/ + 2 /*checksum*/ + 2 /*line end*/;

int hex_value(char digit) {
  const char upper = digit >= 'a' && digit <= 'f' ? static_cast<char>(digit - 'a' + 'A') : digit;
  const auto at = kDigits.find(upper);
  return at == std::string_view::npos ? -1 : static_cast<int>(at);
}

Malformed fault(std::string_view reason, std::size_t offset) {
  return Malformed{reason, offset};
}

}  // namespace

std::string_view SentenceView::type() const {
  if (address.empty() || address[0] == 'P' || address.size() < 3) {
    return address;
  }
  return address.substr(address.size() - 3);
}

std::uint8_t checksum(std::string_view between_dollar_and_star) {
  std::uint8_t sum = 0;
  for (const char c : between_dollar_and_star) {
    sum = static_cast<std::uint8_t>(sum ^ static_cast<std::uint8_t>(c));
  }
  return sum;
}

// Finds the end of the line, compares the checksum (exclusive or of the characters between '$' and
// '*') and splits the content at its commas.
Decoded<SentenceView> decode_sentence(std::span<const std::uint8_t> bytes) {
  if (!bytes.empty() && bytes[0] != '$') {
    return fault("no NMEA start character", 0);
  }
  std::size_t end = 1;
  while (end < bytes.size() && bytes[end] != '\n') {
    const std::uint8_t byte = bytes[end];
    const bool last_return = byte == '\r' && (end + 1 == bytes.size() || bytes[end + 1] == '\n');
    if (byte == '$' || ((byte < 0x20 || byte > 0x7E) && !last_return)) {
      return fault("character that no NMEA sentence has", end);
    }
    ++end;
    if (end >= kMaximumSentence) {
      return fault("NMEA sentence too long", end);
    }
  }
  if (end >= bytes.size()) {
    return Incomplete{bytes.size() + 1, bytes.size()};
  }
  const std::size_t consumed = end + 1;
  if (bytes[end - 1] == '\r') {
    --end;
  }
  const std::string_view body(reinterpret_cast<const char*>(bytes.data()) + 1, end - 1);
  if (body.size() < 3 || body[body.size() - 3] != '*') {
    return fault("no NMEA checksum", end);
  }
  const std::string_view content = body.substr(0, body.size() - 3);
  const int high = hex_value(body[body.size() - 2]);
  const int low = hex_value(body[body.size() - 1]);
  if (high < 0 || low < 0 || high * 16 + low != checksum(content)) {
    return fault("NMEA checksum", end - 2);
  }
  SentenceView view;
  std::size_t comma = content.find(',');
  view.address = content.substr(0, comma);
  while (comma != std::string_view::npos) {
    if (view.field_count == kMaximumFields) {
      return fault("too many NMEA fields", comma);
    }
    const std::size_t next = content.find(',', comma + 1);
    view.fields[view.field_count++] = content.substr(
        comma + 1, next == std::string_view::npos ? std::string_view::npos : next - comma - 1);
    comma = next;
  }
  return {view, consumed};
}

std::size_t find_start(std::span<const std::uint8_t> bytes, std::size_t from) {
  const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(std::min(from, bytes.size()));
  return static_cast<std::size_t>(std::find(begin, bytes.end(), std::uint8_t{'$'}) - bytes.begin());
}

Sentence::Sentence(std::string_view address) {
  append("$");
  append(address);
}

void Sentence::append(std::string_view text) {
  const std::size_t room = characters_.size() - kTail - size_;
  const std::size_t taken = std::min(room, text.size());
  std::copy_n(text.begin(), taken, characters_.begin() + static_cast<std::ptrdiff_t>(size_));
  size_ += taken;
}

Sentence& Sentence::field(std::string_view text) {
  append(",");
  append(text);
  return *this;
}

Sentence& Sentence::decimal(int decimals, double value) {
  constexpr std::size_t kGreatest = 309 /*digits of a double*/ + 2 /*sign, point*/ + 16;
  std::array<char, kGreatest> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value,
                                 std::chars_format::fixed, decimals);
  const std::string_view printed(text.data(), end.ptr);
  const bool negative_zero = printed.find_first_not_of("-0.") == std::string_view::npos;
  return field(printed.substr(negative_zero && printed.starts_with('-') ? 1 : 0));
}

Sentence& Sentence::number(int digits, int value) {
  return field(Digits().put(digits, value).text());
}

Sentence& Sentence::hexadecimal(int value) {
  constexpr unsigned kBits = 4;
  std::array<char, 8> text{};
  std::size_t at = text.size();
  for (auto rest = static_cast<unsigned>(value); at == text.size() || rest != 0; rest >>= kBits) {
    text[--at] = kDigits[rest % (1U << kBits)];
  }
  return field({text.data() + at, text.size() - at});
}

Digits& Digits::put(int digits, std::int64_t value) {
  constexpr std::uint64_t kTen = 10;
  const auto size =
      value < 0 ? 0 - static_cast<std::uint64_t>(value) : static_cast<std::uint64_t>(value);
  // From the last digit to the first.
  std::array<char, 20> reversed{};
  std::size_t count = 0;
  for (std::uint64_t rest = size; count == 0 || rest != 0; rest /= kTen) {
    reversed[count++] = kDigits[rest % kTen];
  }
  if (value < 0) {
    letter('-');
    --digits;
  }
  for (auto zeros = static_cast<int>(count); zeros < digits; ++zeros) {
    letter('0');
  }
  while (count > 0) {
    letter(reversed[--count]);
  }
  return *this;
}

Digits& Digits::letter(char c) {
  if (size_ < characters_.size()) {
    characters_[size_++] = c;
  }
  return *this;
}

std::string_view Sentence::text() {
  if (!finished_) {
    finished_ = true;
    const std::uint8_t sum = checksum(std::string_view(characters_.data() + 1, size_ - 1));
    const std::array tail{'*', kDigits[sum / 16], kDigits[sum % 16], '\r', '\n'};
    std::ranges::copy(tail, characters_.begin() + static_cast<std::ptrdiff_t>(size_));
    size_ += tail.size();
  }
  return {characters_.data(), size_};
}

std::span<const std::uint8_t> Sentence::bytes() {
  const std::string_view all = text();
  return {reinterpret_cast<const std::uint8_t*>(all.data()), all.size()};
}

}  // namespace rigwire::protocols::nmea
