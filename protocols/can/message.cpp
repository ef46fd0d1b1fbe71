#include "protocols/can/message.h"

#include <cctype>

namespace rigwire::protocols::can {

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

OwnedSignal owned(const Signal& signal) {
  OwnedSignal result;
  static_cast<Coding&>(result) = signal;
  result.name = snake_case(signal.name);
  result.unit = signal.unit == "1" ? std::string_view() : signal.unit;
  result.text = signal.text;
  if (result.text.empty() && signal.spn != 0) {
    result.text = "SPN " + std::to_string(signal.spn);
  }
  result.spn = signal.spn;
  for (const NamedValue& value : signal.values) {
    result.values.push_back({value.raw, std::string(value.text)});
  }
  constexpr unsigned kWidestNamed = 16;
  if (signal.reserved == Reserved::j1939 && signal.width <= kWidestNamed) {
    result.values.push_back({static_cast<std::int64_t>(error_value(signal.width)), "error"});
    result.values.push_back(
        {static_cast<std::int64_t>(not_available_value(signal.width)), "not available"});
  }
  result.document_unit = signal.document_unit;
  result.document_size = signal.document_size;
  result.multiplexor = signal.multiplexor;
  result.present_at.assign(signal.present_at.begin(), signal.present_at.end());
  return result;
}

OwnedMessage owned(const Message& message) {
  OwnedMessage result;
  result.name = snake_case(message.name);
  result.id = message.id;
  result.extended = message.extended;
  result.j1939 = message.j1939;
  result.length = message.length;
  result.fill = message.fill;
  result.period_ms = message.period_ms;
  result.sender = message.sender;
  result.text = message.text;
  for (const Signal& signal : message.signals) {
    result.signals.push_back(owned(signal));
  }
  return result;
}

}  // namespace rigwire::protocols::can
