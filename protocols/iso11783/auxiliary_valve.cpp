#include "protocols/iso11783/auxiliary_valve.h"

#include <algorithm>
#include <string>

#include "protocols/vehicle/message.h"

namespace rigwire::protocols::iso11783 {
namespace {

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

/// "AV00C" with another number.
std::string name_of(std::string_view group, unsigned valve) {
  std::string name(group);
  if (name.starts_with("AV00")) {
    name[2] = static_cast<char>('0' + valve / 10);
    name[3] = static_cast<char>('0' + valve % 10);
  }
  return name;
}

template <class Message>
void append(std::vector<can::OwnedMessage>& list, unsigned valve, std::uint8_t address,
            const std::string& sender, const std::string& text) {
  const std::string name = name_of(Message::kGroup.name, valve);
  Group group = Message::kGroup;
  group.name = name;
  group.pgn += valve;
  can::OwnedMessage layout = vehicle::layout<Message>({sender, address}, group);
  layout.text = "ISO 11783-7 " + text;
  for (can::OwnedSignal& signal : layout.signals) {
    signal.spn = parameter_number(signal.spn, valve);
    signal.text = signal.spn == 0 ? "ISO 11783-7" : "SPN " + std::to_string(signal.spn);
  }
  list.push_back(std::move(layout));
}

}  // namespace

std::vector<can::OwnedMessage> message_layouts(unsigned first_valve, unsigned valves,
                                               std::uint8_t address, const std::string& sender) {
  std::vector<can::OwnedMessage> list;
  const unsigned end = std::min(first_valve + valves, kAuxiliaryValves);
  for (unsigned valve = first_valve; valve < end; ++valve) {
    append<AuxiliaryValveEstimate>(list, valve, address, sender, "estimated flow");
    append<AuxiliaryValveMeasuredFlow>(list, valve, address, sender, "measured flow");
    append<AuxiliaryValveMeasuredPosition>(list, valve, address, sender, "measured position");
    append<AuxiliaryValveCommand>(list, valve, j1939::kNullAddress, "", "command");
  }
  return list;
}

}  // namespace rigwire::protocols::iso11783
