#include "protocols/slcan/slcan.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <string_view>

namespace rigwire::protocols::slcan {

using Line = std::span<const std::uint8_t>;
using can::BusError;
using can::ControllerReport;

namespace {

unsigned letter_of(const ControllerReport& report) {
  switch (report.error) {
    case BusError::acknowledgement:
      return kNoAcknowledge;
    case BusError::bit:
      return report.dominant ? kDominantBit : kRecessiveBit;
    case BusError::crc:
      return kCrcError;
    case BusError::form:
      return kFormError;
    case BusError::stuff:
      return kStuffError;
    case BusError::none:
      break;
  }
  return 0;
}

constexpr std::string_view kStateLetters = "awpb";
constexpr std::string_view kErrorLetters = "abBcfoOs";

std::optional<std::uint32_t> hexadecimal(Line line, std::size_t offset, std::size_t digits) {
  if (offset + digits > line.size()) {
    return std::nullopt;
  }
  std::uint32_t value = 0;
  for (const std::uint8_t c : line.subspan(offset, digits)) {
    std::uint32_t digit = 0;
    if (c >= '0' && c <= '9') {
      digit = static_cast<std::uint32_t>(c - '0');
    } else if (c >= 'A' && c <= 'F') {
      digit = static_cast<std::uint32_t>(c - 'A' + 10);
    } else if (c >= 'a' && c <= 'f') {
      digit = static_cast<std::uint32_t>(c - 'a' + 10);
    } else {
      return std::nullopt;
    }
    value = (value << 4U) | digit;
  }
  return value;
}

std::optional<std::uint16_t> decimal3(Line line, std::size_t offset) {
  std::uint16_t value = 0;
  for (const std::uint8_t c : line.subspan(offset, 3)) {
    if (c < '0' || c > '9') {
      return std::nullopt;
    }
    value = static_cast<std::uint16_t>(value * 10 + (c - '0'));
  }
  return value;
}

void put_hexadecimal(Text& text, std::uint32_t value, unsigned digits) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  for (unsigned i = digits; i-- > 0;) {
    text.push(static_cast<std::uint8_t>(kDigits[(value >> (4 * i)) & 0xFU]));
  }
}

void put_decimal3(Text& text, unsigned value) {
  const unsigned limited = std::min(value, 999U);
  text.push(static_cast<std::uint8_t>('0' + limited / 100));
  text.push(static_cast<std::uint8_t>('0' + limited / 10 % 10));
  text.push(static_cast<std::uint8_t>('0' + limited % 10));
}

void put_bus_errors(Text& text, unsigned letters) {
  letters &= 0xFFU;
  text.push('e');
  text.push(static_cast<std::uint8_t>('0' + std::popcount(letters)));
  for (std::size_t i = 0; i < kErrorLetters.size(); ++i) {
    if ((letters >> i & 1U) != 0) {
      text.push(static_cast<std::uint8_t>(kErrorLetters[i]));
    }
  }
}

/// The frame at the start of the line; consumed() says where it ends.
Decoded<can::Frame> parse_frame(Line line) {
  can::Frame frame;
  frame.extended = line[0] == 'T' || line[0] == 'R';
  frame.remote = line[0] == 'r' || line[0] == 'R';
  const std::size_t digits = frame.extended ? 8 : 3;
  const auto id = hexadecimal(line, 1, digits);
  if (!id || *id > (frame.extended ? 0x1FFFFFFFU : 0x7FFU)) {
    return Malformed{"identifier is not 3 (t, r) or 8 (T, R) digits within its format", 1};
  }
  frame.id = *id;
  const std::size_t length_at = 1 + digits;
  if (length_at >= line.size() || line[length_at] < '0' || line[length_at] > '8') {
    return Malformed{"length is one digit 0..8", length_at};
  }
  frame.length = static_cast<std::uint8_t>(line[length_at] - '0');
  std::size_t position = length_at + 1;
  for (std::size_t i = 0; !frame.remote && i < frame.length; ++i, position += 2) {
    const auto byte = hexadecimal(line, position, 2);
    if (!byte) {
      return Malformed{"data is two digits per byte", position};
    }
    frame.data[i] = static_cast<std::uint8_t>(*byte);
  }
  return {frame, position};
}

/// A command that is no frame, in the order of Verb: its letter, and how many digits follow. One
/// digit is decimal and at most `greatest`, more are registers.
struct Form {
  char letter;
  unsigned digits = 0;
  char greatest = '0';
};
constexpr std::array kForms{
    Form{'O'}, Form{'L'}, Form{'C'},    Form{'S', 1, '9'}, Form{'s', 4},      Form{'t'},
    Form{'F'}, Form{'V'}, Form{'v'},    Form{'N'},         Form{'Z', 1, '1'}, Form{'X', 1, '1'},
    Form{'P'}, Form{'A'}, Form{'M', 8}, Form{'m', 8},      Form{'W', 1, '1'}, Form{'U', 1, '6'}};
static_assert(kForms.size() == static_cast<std::size_t>(Verb::line_speed) + 1);

bool begins_frame(Line line) {
  return line[0] == 't' || line[0] == 'T' || line[0] == 'r' || line[0] == 'R';
}

Decoded<Reply> parse_bus_state(Line line) {
  if (line.size() != 1 + 1 + 3 + 3) {
    return Malformed{"bus state is a letter and two counters of three digits", 1};
  }
  const auto letter = kStateLetters.find(static_cast<char>(line[1]));
  const auto receive = decimal3(line, 2);
  const auto transmit = decimal3(line, 5);
  if (letter == std::string_view::npos || !receive || !transmit) {
    return Malformed{"bus state is one of a w p b and two counters of three digits", 1};
  }
  Reply reply;
  reply.kind = ReplyKind::bus_state;
  reply.state = static_cast<can::ErrorState>(letter);
  reply.receive_errors = *receive;
  reply.transmit_errors = *transmit;
  return {reply, line.size()};
}

Decoded<Reply> parse_bus_errors(Line line) {
  const bool counted = line.size() >= 2 && line[1] >= '0' && line[1] <= '9';
  const std::size_t count = counted ? static_cast<std::size_t>(line[1] - '0') : 0;
  unsigned letters = 0;
  bool known = counted && line.size() == 2 + count;
  for (std::size_t i = 2; known && i < line.size(); ++i) {
    const auto letter = kErrorLetters.find(static_cast<char>(line[i]));
    known = letter != std::string_view::npos;
    letters |= known ? 1U << letter : 0U;
  }
  if (!known) {
    return Malformed{"bus errors are a count digit and as many letters of abBcfoOs", 1};
  }
  Reply reply;
  reply.kind = ReplyKind::bus_errors;
  reply.number = static_cast<std::uint16_t>(letters);
  return {reply, line.size()};
}

}  // namespace

std::optional<Reply> state_line(const ControllerReport& report) {
  if (!report.state_changed && !report.restarted) {
    return std::nullopt;
  }
  Reply reply;
  reply.kind = ReplyKind::bus_state;
  reply.state = report.state;
  reply.receive_errors = report.receive_errors;
  reply.transmit_errors = report.transmit_errors;
  return reply;
}

std::optional<Reply> error_line(const ControllerReport& report) {
  const unsigned letters = letter_of(report) |
                           (report.receive_overflow ? unsigned{kReceiveOverflow} : 0U) |
                           (report.transmit_overflow ? unsigned{kTransmitOverflow} : 0U);
  if (letters == 0) {
    return std::nullopt;
  }
  Reply reply;
  reply.kind = ReplyKind::bus_errors;
  reply.number = static_cast<std::uint16_t>(letters);
  return reply;
}

ControllerReport report_of(const Reply& reply) {
  assert(reply.kind == ReplyKind::bus_state || reply.kind == ReplyKind::bus_errors);
  ControllerReport report;
  if (reply.kind == ReplyKind::bus_state) {
    report.state = reply.state;
    report.state_changed = true;
    report.receive_errors = reply.receive_errors;
    report.transmit_errors = reply.transmit_errors;
    return report;
  }
  const unsigned letters = reply.number;
  const auto take = [&](unsigned letter, BusError error) {
    if ((letters & letter) != 0) {
      report.error = error;
    }
  };
  take(kNoAcknowledge, BusError::acknowledgement);
  take(kDominantBit | kRecessiveBit, BusError::bit);
  take(kCrcError, BusError::crc);
  take(kFormError, BusError::form);
  take(kStuffError, BusError::stuff);
  // The driver's own order: these concern a frame that was being sent.
  report.transmitting = (letters & (kNoAcknowledge | kDominantBit | kRecessiveBit)) != 0;
  report.dominant = (letters & kDominantBit) != 0;
  report.receive_overflow = (letters & kReceiveOverflow) != 0;
  report.transmit_overflow = (letters & kTransmitOverflow) != 0;
  return report;
}

// Reads a command of the host: a frame, or a letter with the number of digits that kForms gives.
Decoded<Command> parse_command(Line line) {
  if (line.empty()) {
    return Malformed{"empty line", 0};
  }
  if (begins_frame(line)) {
    const auto frame = parse_frame(line);
    if (!frame.ok()) {
      return frame.fault();
    }
    if (frame.consumed() != line.size()) {
      return Malformed{"more digits than the length says", frame.consumed()};
    }
    return {Command{Verb::frame, 0, *frame}, line.size()};
  }
  const auto form = std::ranges::find(kForms, static_cast<char>(line[0]), &Form::letter);
  if (form == kForms.end()) {
    return Malformed{"unknown command", 0};
  }
  const bool whole = line.size() == 1 + form->digits;
  const auto number = whole ? hexadecimal(line, 1, form->digits) : std::nullopt;
  if (form->digits == 0 && !whole) {
    return Malformed{"the command has no argument", 1};
  }
  if (form->digits == 1 && (!number || line[1] > form->greatest)) {
    return Malformed{"the argument is one digit within its range", 1};
  }
  if (!number) {
    return Malformed{"register values are two digits per byte", 1};
  }
  return {Command{static_cast<Verb>(form - kForms.begin()), *number, {}}, line.size()};
}

// Reads a reply of the adapter by its first character (table in slcan.h). A received frame may be
// followed by four digits of time stamp.
Decoded<Reply> parse_reply(Line line) {
  Reply reply;
  if (line.empty()) {
    return {reply, 0};
  }
  switch (line[0]) {
    case kBell:
      reply.kind = ReplyKind::refused;
      return {reply, 1};
    case 'z':
    case 'Z':
      if (line.size() != 1) {
        return Malformed{"z and Z stand alone", 1};
      }
      reply.kind = ReplyKind::frame_taken;
      return {reply, 1};
    case 'F': {
      const auto flags = hexadecimal(line, 1, 2);
      if (!flags || line.size() != 3) {
        return Malformed{"status flags are two digits", 1};
      }
      reply.kind = ReplyKind::status_flags;
      reply.number = static_cast<std::uint16_t>(*flags);
      return {reply, line.size()};
    }
    case 'A':
      if (line.size() != 1) {
        return Malformed{"A has no arguments", 1};
      }
      reply.kind = ReplyKind::all_polled;
      return {reply, 1};
    case 'V':
    case 'v':
    case 'N':
      reply.kind = ReplyKind::information;
      return {reply, line.size()};
    case 's':
      return parse_bus_state(line);
    case 'e':
      return parse_bus_errors(line);
    default: {
      if (!begins_frame(line)) {
        return Malformed{"unknown reply", 0};
      }
      const auto frame = parse_frame(line);
      if (!frame.ok()) {
        return frame.fault();
      }
      reply.kind = ReplyKind::frame;
      reply.frame = *frame;
      const std::size_t rest = line.size() - frame.consumed();
      if (rest == 4) {
        const auto stamp = hexadecimal(line, frame.consumed(), 4);
        if (!stamp) {
          return Malformed{"a time stamp is four digits", frame.consumed()};
        }
        reply.time_stamp_ms = static_cast<std::uint16_t>(*stamp);
      } else if (rest != 0) {
        return Malformed{"only a time stamp may follow the data", frame.consumed()};
      }
      return {reply, line.size()};
    }
  }
}

Text write_frame(const can::Frame& frame, std::optional<std::uint16_t> time_stamp_ms) {
  assert(frame.length <= 8);
  Text text;
  if (frame.extended) {
    text.push(frame.remote ? 'R' : 'T');
    put_hexadecimal(text, frame.id & 0x1FFFFFFFU, 8);
  } else {
    text.push(frame.remote ? 'r' : 't');
    put_hexadecimal(text, frame.id & 0x7FFU, 3);
  }
  text.push(static_cast<std::uint8_t>('0' + frame.length));
  for (const std::uint8_t byte : frame.payload()) {
    put_hexadecimal(text, byte, 2);
  }
  if (time_stamp_ms) {
    put_hexadecimal(text, *time_stamp_ms, 4);
  }
  text.push(kEnd);
  return text;
}

Text write_command(const Command& command) {
  if (command.verb == Verb::frame) {
    return write_frame(command.frame);
  }
  const Form& form = kForms[static_cast<std::size_t>(command.verb)];
  Text text;
  text.push(static_cast<std::uint8_t>(form.letter));
  if (form.digits == 1) {
    text.push(static_cast<std::uint8_t>('0' + command.number % 10));
  } else {
    put_hexadecimal(text, command.number, form.digits);
  }
  text.push(kEnd);
  return text;
}

Text write_reply(const Reply& reply) {
  Text text;
  switch (reply.kind) {
    case ReplyKind::refused:
      text.push(kBell);
      return text;
    case ReplyKind::frame:
      return write_frame(reply.frame, reply.time_stamp_ms);
    case ReplyKind::done:
    case ReplyKind::information:
      break;
    case ReplyKind::frame_taken:
      text.push(reply.frame.extended ? 'Z' : 'z');
      break;
    case ReplyKind::status_flags:
      text.push('F');
      put_hexadecimal(text, reply.number, 2);
      break;
    case ReplyKind::bus_state:
      text.push('s');
      text.push(static_cast<std::uint8_t>(kStateLetters[static_cast<std::size_t>(reply.state)]));
      put_decimal3(text, reply.receive_errors);
      put_decimal3(text, reply.transmit_errors);
      break;
    case ReplyKind::bus_errors:
      put_bus_errors(text, reply.number);
      break;
    case ReplyKind::all_polled:
      text.push('A');
      break;
  }
  text.push(kEnd);
  return text;
}

std::optional<LineSplitter::Line> LineSplitter::push(std::uint8_t byte) {
  if (byte == kBell) {
    size_ = 0;
    too_long_ = false;
    buffer_[0] = kBell;
    return Line{std::span(buffer_).first(1), false};
  }
  if (byte == kEnd) {
    const Line line{std::span(buffer_).first(too_long_ ? 0 : size_), too_long_};
    size_ = 0;
    too_long_ = false;
    return line;
  }
  if (byte == '\n') {
    return std::nullopt;
  }
  if (size_ == buffer_.size()) {
    too_long_ = true;
  } else {
    buffer_[size_++] = byte;
  }
  return std::nullopt;
}

}  // namespace rigwire::protocols::slcan
