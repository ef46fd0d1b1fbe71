#include "protocols/socketcand/socketcand.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <span>

#include "protocols/markup.h"

namespace rigwire::protocols::socketcand {
namespace {

using Words = std::vector<std::string_view>;

constexpr std::uint32_t kRemoteFlag = 0x4000'0000U;
constexpr std::uint32_t kErrorFlag = 0x2000'0000U;
constexpr std::uint32_t kGreatestExtended = 0x1FFF'FFFFU;
constexpr std::uint32_t kGreatestStandard = 0x7FFU;
constexpr std::size_t kExtendedDigits = 8;

template <class Number>
std::optional<Number> number(std::string_view word, int base) {
  Number value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value, base);
  return error == std::errc() && end == word.data() + word.size() ? std::optional(value)
                                                                  : std::nullopt;
}

/// A byte as the daemon's sscanf reads it with %hhx: a sign and 0x may come first, and of a number
/// of up to 64 bits the lowest eight count. Clients print a byte as a signed number (SavvyCAN).
std::optional<std::uint8_t> scanned_byte(std::string_view word) {
  const bool negative = word.starts_with('-');
  if (negative || word.starts_with('+')) {
    word.remove_prefix(1);
  }
  if (word.size() > 2 && (word.starts_with("0x") || word.starts_with("0X"))) {
    word.remove_prefix(2);
  }
  const auto value = number<std::uint64_t>(word, 16);
  return value ? std::optional(static_cast<std::uint8_t>(negative ? 0U - *value : *value))
               : std::nullopt;
}

Words words_of(std::string_view element) {
  Words words;
  std::size_t begin = 0;
  while (begin < element.size()) {
    const std::size_t end = std::min(element.find_first_of(" \t\r\n<>", begin), element.size());
    if (end > begin) {
      words.push_back(element.substr(begin, end - begin));
    }
    begin = end + 1;
  }
  return words;
}

bool read_identifier(std::string_view word, can::Frame& frame) {
  const auto id = number<std::uint32_t>(word, 16);
  if (!id || word.size() > kExtendedDigits || (*id & kErrorFlag) != 0) {
    return false;
  }
  frame.remote = (*id & kRemoteFlag) != 0;
  frame.id = *id & kGreatestExtended;
  frame.extended = word.size() == kExtendedDigits || frame.id > kGreatestStandard;
  return true;
}

bool read_bytes(std::span<const std::string_view> words, std::span<std::uint8_t> bytes) {
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const auto byte = scanned_byte(words[i]);
    if (!byte) {
      return false;
    }
    bytes[i] = *byte;
  }
  return true;
}

/// Identifier, length and exactly as many bytes.
bool read_frame(std::span<const std::string_view> words, can::Frame& frame) {
  if (words.size() < 2 || !read_identifier(words[0], frame)) {
    return false;
  }
  const auto length = number<std::uint8_t>(words[1], 10);
  if (!length || *length > frame.data.size() || words.size() != 2U + *length) {
    return false;
  }
  frame.length = *length;
  return read_bytes(words.subspan(2), std::span(frame.data).first(frame.length));
}

bool read_interval(std::span<const std::string_view> words, std::chrono::microseconds& interval) {
  if (words.size() < 2) {
    return false;
  }
  const auto seconds = number<std::uint32_t>(words[0], 10);
  const auto microseconds = number<std::uint32_t>(words[1], 10);
  if (!seconds || !microseconds) {
    return false;
  }
  interval = std::chrono::seconds(*seconds) + std::chrono::microseconds(*microseconds);
  return true;
}

bool read_masks(std::span<const std::string_view> words, std::vector<Mask>& masks) {
  const auto count = words.empty() ? std::nullopt : number<std::size_t>(words[0], 10);
  if (!count || *count < 2 || *count > kMostMasks || words.size() < 1 + *count * Mask{}.size()) {
    return false;
  }
  masks.resize(*count);
  for (std::size_t i = 0; i < *count; ++i) {
    if (!read_bytes(words.subspan(1 + i * Mask{}.size()), masks[i])) {
      return false;
    }
  }
  return true;
}

bool read_arguments(std::span<const std::string_view> words, Command& command) {
  const bool times = words.size() > 2;
  switch (command.verb) {
    case Verb::open:
      command.bus = words.empty() ? "" : words[0];
      return !words.empty();
    case Verb::send:
    case Verb::update:
      return read_frame(words, command.frame);
    case Verb::add:
      return times && read_interval(words, command.interval) &&
             read_frame(words.subspan(2), command.frame);
    case Verb::remove:
    case Verb::unsubscribe:
      return words.size() == 1 && read_identifier(words[0], command.frame);
    case Verb::subscribe:
      return words.size() == 3 && read_interval(words, command.interval) &&
             read_identifier(words[2], command.frame);
    case Verb::filter:
      if (!times || !read_interval(words, command.interval) ||
          !read_frame(words.subspan(2), command.frame)) {
        return false;
      }
      command.masks.push_back(command.frame.data);
      return true;
    case Verb::mux_filter:
      return times && read_interval(words, command.interval) &&
             read_identifier(words[2], command.frame) &&
             read_masks(words.subspan(3), command.masks);
    case Verb::statistics: {
      const auto interval = words.size() == 1 ? number<std::uint32_t>(words[0], 10) : std::nullopt;
      command.interval = std::chrono::milliseconds(interval.value_or(0));
      return interval.has_value();
    }
    default:
      return true;
  }
}

struct Word {
  std::string_view text;
  Verb verb;
};
constexpr std::array<Word, 14> kWords{{{"open", Verb::open},
                                       {"rawmode", Verb::raw_mode},
                                       {"bcmmode", Verb::bcm_mode},
                                       {"controlmode", Verb::control_mode},
                                       {"echo", Verb::echo},
                                       {"send", Verb::send},
                                       {"add", Verb::add},
                                       {"update", Verb::update},
                                       {"delete", Verb::remove},
                                       {"subscribe", Verb::subscribe},
                                       {"filter", Verb::filter},
                                       {"muxfilter", Verb::mux_filter},
                                       {"unsubscribe", Verb::unsubscribe},
                                       {"statistics", Verb::statistics}}};

template <class... Numbers>
std::string print(const char* format, Numbers... numbers) {
  std::array<char, 96> text{};
  const int size = std::snprintf(text.data(), text.size(), format, numbers...);
  return {text.data(), static_cast<std::size_t>(size)};
}

std::string time_text(Stamp stamp) {
  constexpr std::int64_t kPerSecond = 1'000'000;
  return print("%lld.%06lld", static_cast<long long>(stamp.count() / kPerSecond),
               static_cast<long long>(stamp.count() % kPerSecond));
}

}  // namespace

Command parse_command(std::string_view element) {
  Command command;
  const Words words = words_of(element);
  if (words.empty()) {
    return command;
  }
  const auto known = std::ranges::find(kWords, words.front(), &Word::text);
  if (known == kWords.end()) {
    return command;
  }
  command.verb = known->verb;
  if (!read_arguments(std::span(words).subspan(1), command)) {
    command.verb = Verb::malformed;
  }
  return command;
}

std::optional<std::string_view> ElementSplitter::push(char byte) {
  if (ended_) {
    element_.clear();
    ended_ = false;
  }
  if (element_.empty() && byte != '<') {
    return std::nullopt;
  }
  if (element_.size() == kLongestElement) {
    overflowed_ = true;
    element_.clear();
    return std::nullopt;
  }
  element_ += byte;
  ended_ = byte == '>';
  return ended_ ? std::optional<std::string_view>(element_) : std::nullopt;
}

std::string frame_element(const can::Frame& frame, Stamp stamp, DataStyle style) {
  std::string text =
      "< frame " + print(frame.extended ? "%08X" : "%03X", frame.id) + " " + time_text(stamp) + " ";
  for (const std::uint8_t byte : frame.payload()) {
    text += print(style == DataStyle::apart ? "%02X " : "%02X", unsigned{byte});
  }
  return text + " >";
}

std::string error_element(std::uint32_t error_class, Stamp stamp) {
  return "< error " + print("%03X", error_class & kGreatestExtended) + " " + time_text(stamp) +
         " >";
}

std::string statistics_element(const Statistics& s) {
  return print("< stat %u %u %u %u >", s.received_bytes, s.received_frames, s.sent_bytes,
               s.sent_frames);
}

std::string beacon(std::string_view name, std::string_view description, std::string_view address,
                   std::uint16_t port, const std::vector<std::string>& buses) {
  std::string text = "<CANBeacon name=\"" + escape_markup(name) +
                     "\" type=\"SocketCAN\" description=\"" + escape_markup(description) +
                     "\">\n<URL>can://" + std::string(address) + ":" + std::to_string(port) +
                     "</URL>";
  for (const std::string& bus : buses) {
    text += "<Bus name=\"" + escape_markup(bus) + "\"/>";
  }
  return text + "</CANBeacon>";
}

}  // namespace rigwire::protocols::socketcand
