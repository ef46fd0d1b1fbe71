#include "protocols/iso11783/auxiliary_valve.h"

#include <algorithm>
#include <cctype>
#include <string>

namespace rigwire::protocols::iso11783 {
namespace {

std::string snake_case(std::string_view name) {
  std::string result;
  for (const char letter : name) {
    if (letter != ',') {
      result += letter == ' ' || letter == '-' || letter == '/' ? '_' : letter;
    }
  }
  return result;
}

/// The suspect parameter number of valve `valve` where valve 0's is `first`: commands and measured
/// flows have twelve numbers per valve with a gap after the eighth, the newer ones one or two.
unsigned parameter_number(unsigned first, unsigned valve) {
  if (first == 0) {
    return 0;
  }
  if (first >= 7000) {
    return first + valve;
  }
  if (first >= 5000) {
    return first + 2 * valve;
  }
  return first + 12 * valve + (valve >= 8 ? 256 : 0);
}

template <class Message>
void append(std::vector<can::MessageLayout>& list, unsigned valve, std::uint8_t address,
            const std::string& sender, const std::string& text) {
  can::MessageLayout layout;
  layout.name = snake_case(Message::kGroup.name);
  std::ranges::transform(layout.name, layout.name.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (layout.name.starts_with("av00")) {
    layout.name[2] = static_cast<char>('0' + valve / 10);
    layout.name[3] = static_cast<char>('0' + valve % 10);
  }
  layout.id = encode(valve, Message{}, address).id;
  layout.extended = true;
  layout.j1939 = true;
  layout.period_ms = static_cast<std::uint32_t>(Message::kGroup.period.count());
  layout.sender = sender;
  layout.text = text;
  for (const auto& row : Message::parameters()) {
    can::SignalLayout field;
    field.name = snake_case(row.field.name);
    field.bit = row.field.bit;
    field.width = row.field.width;
    field.scale = row.field.scale;
    field.offset = row.field.offset;
    field.lower = row.field.lower;
    field.upper = row.field.upper;
    field.unit = std::string(row.field.unit);
    if (field.name == "state") {
      field.values = {{0, "neutral"}, {1, "extend"}, {2, "retract"},       {3, "float"},
                      {10, "init"},   {14, "error"}, {15, "not available"}};
    }
    const unsigned number = parameter_number(row.field.spn, valve);
    field.text = number == 0 ? "ISO 11783-7" : "SPN " + std::to_string(number);
    layout.fields.push_back(std::move(field));
  }
  list.push_back(std::move(layout));
}

}  // namespace

std::vector<can::MessageLayout> message_layouts(unsigned valves, std::uint8_t address,
                                                const std::string& sender) {
  std::vector<can::MessageLayout> list;
  for (unsigned valve = 0; valve < std::min(valves, kAuxiliaryValves); ++valve) {
    append<AuxiliaryValveEstimate>(list, valve, address, sender, "estimated flow");
    append<AuxiliaryValveMeasuredFlow>(list, valve, address, sender, "measured flow");
    append<AuxiliaryValveMeasuredPosition>(list, valve, address, sender, "measured position");
    append<AuxiliaryValveCommand>(list, valve, j1939::kNullAddress, "", "command");
  }
  append<GeneralPurposeValveEstimate>(list, 0, address, sender, "estimated flow");
  append<GeneralPurposeValveCommand>(list, 0, j1939::kNullAddress, "", "command, to one node");
  return list;
}

}  // namespace rigwire::protocols::iso11783
