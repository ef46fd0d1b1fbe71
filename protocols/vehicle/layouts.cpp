#include "protocols/vehicle/layouts.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace rigwire::protocols::vehicle {
namespace {

std::string source_of(const j1939::Field& field) {
  return field.spn == 0 ? std::string() : "SPN " + std::to_string(field.spn);
}

can::SignalLayout begin_signal(const j1939::Field& field) {
  can::SignalLayout signal;
  signal.name = snake_case(field.name);
  signal.bit = field.bit;
  signal.width = field.width;
  signal.text = source_of(field);
  signal.spn = field.spn;
  return signal;
}

}  // namespace

std::string snake_case(std::string_view words) {
  std::string name;
  for (const char c : words) {
    const auto character = static_cast<unsigned char>(c);
    if (std::isalnum(character) != 0) {
      name += static_cast<char>(std::tolower(character));
    } else if (c != '\'' && !name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  while (!name.empty() && name.back() == '_') {
    name.pop_back();
  }
  return name;
}

can::MessageLayout begin_layout(const Group& group, const LayoutEnds& ends) {
  can::MessageLayout message;
  message.name = snake_case(group.name);
  message.id = pack(j1939::Identifier{group.priority, group.pgn, ends.destination, ends.source});
  message.extended = true;
  message.j1939 = true;
  message.length = kMessageBytes;
  message.period_ms = static_cast<std::uint32_t>(group.period.count());
  message.sender = ends.sender;
  message.text = std::string(group.name) + ", parameter group " + std::to_string(group.pgn);
  return message;
}

can::SignalLayout number_layout(const j1939::Field& field, double sign, const SaeUnit& sae) {
  can::SignalLayout signal = begin_signal(field);
  signal.scale = sign * field.scale;
  signal.offset = sign * field.offset;
  signal.lower = std::min(sign * field.lower, sign * field.upper);
  signal.upper = std::max(sign * field.lower, sign * field.upper);
  signal.unit = field.unit == "1" ? std::string_view() : field.unit;
  signal.document_unit = sae.unit.empty() ? std::string_view(signal.unit) : sae.unit;
  signal.document_size = sign * sae.size;
  constexpr unsigned kWidestNamed = 16;  // wider values do not fit the readers' integers
  if (field.width <= kWidestNamed) {
    signal.values = {{j1939::error_value(field.width), "error"},
                     {j1939::not_available_value(field.width), "not available"}};
  }
  return signal;
}

can::SignalLayout switch_layout(const j1939::Field& field) {
  can::SignalLayout signal = begin_signal(field);
  signal.upper = 3.0;
  signal.values = {{0, "off"}, {1, "on"}, {2, "error"}, {3, "not available"}};
  return signal;
}

can::SignalLayout code_layout(const j1939::Field& field) {
  can::SignalLayout signal = begin_signal(field);
  signal.upper = code_not_available(field.width);
  signal.values = {{code_not_available(field.width), "not available"}};
  return signal;
}

can::MessageLayout trouble_layout(const Group& group, const LayoutEnds& ends) {
  // SPN in two parts, as its greatest bits follow the failure mode's byte from the top.
  static constexpr std::array kLamps{
      j1939::Field{"protect lamp", 987, 0, 2}, j1939::Field{"amber warning lamp", 624, 2, 2},
      j1939::Field{"red stop lamp", 623, 4, 2}, j1939::Field{"malfunction indicator", 1213, 6, 2}};
  static constexpr std::array kParts{
      j1939::Field{"number low", 1214, 16, 16}, j1939::Field{"failure mode", 1215, 32, 5},
      j1939::Field{"number high", 1214, 37, 3}, j1939::Field{"occurrences", 1216, 40, 7}};
  can::MessageLayout message = begin_layout(group, ends);
  message.text += "; with two codes or more longer than a frame";
  for (const j1939::Field& lamp : kLamps) {
    message.fields.push_back(switch_layout(lamp));
  }
  for (const j1939::Field& part : kParts) {
    can::SignalLayout signal = begin_signal(part);
    signal.upper = static_cast<double>((1U << part.width) - 1U);
    message.fields.push_back(std::move(signal));
  }
  return message;
}

}  // namespace rigwire::protocols::vehicle
