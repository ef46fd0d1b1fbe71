#include "protocols/vehicle/message.h"

#include <array>

#include "protocols/j1939/message.h"

namespace rigwire::protocols::vehicle {

std::optional<Malformed> refuse(const can::Frame& frame, std::uint32_t pgn) {
  const auto identifier = j1939::identify(frame);
  if (!identifier || identifier->pgn != pgn) {
    return Malformed{"another parameter group, or no 29-bit data frame", 0};
  }
  if (frame.length != kMessageBytes) {
    return Malformed{"the message has exactly 8 bytes", frame.length};
  }
  return std::nullopt;
}

can::Frame finish(const Group& group, std::uint8_t source, std::uint8_t destination,
                  const Payload& payload) {
  return j1939::make_frame({group.priority, group.pgn, destination, source}, payload);
}

can::OwnedMessage begin_layout(const Group& group, const LayoutEnds& ends) {
  can::OwnedMessage message;
  message.name = can::snake_case(group.name);
  message.id = pack(j1939::Identifier{group.priority, group.pgn, ends.destination, ends.source});
  message.extended = true;
  message.j1939 = true;
  message.length = kMessageBytes;
  message.fill = group.fill;
  message.period_ms = static_cast<std::uint32_t>(group.period.count());
  message.sender = ends.sender;
  message.text = std::string(group.name) + ", parameter group " + std::to_string(group.pgn);
  return message;
}

can::OwnedMessage trouble_layout(const Group& group, const LayoutEnds& ends) {
  // SPN in two parts: its highest bits are the upper ones of the failure mode's byte.
  static constexpr std::array kSignals{
      code_signal("protect lamp", 987, {1, 1}, 2, kSwitchValues),
      code_signal("amber warning lamp", 624, {1, 3}, 2, kSwitchValues),
      code_signal("red stop lamp", 623, {1, 5}, 2, kSwitchValues),
      code_signal("malfunction indicator", 1213, {1, 7}, 2, kSwitchValues),
      code_signal("number low", 1214, {3}, 16, {}),
      code_signal("failure mode", 1215, {5}, 5, {}),
      code_signal("number high", 1214, {5, 6}, 3, {}),
      code_signal("occurrences", 1216, {6}, 7, {})};
  can::OwnedMessage message = begin_layout(group, ends);
  message.text += "; with two codes or more longer than a frame";
  for (const can::Signal& signal : kSignals) {
    message.signals.push_back(can::owned(signal));
  }
  return message;
}

}  // namespace rigwire::protocols::vehicle
