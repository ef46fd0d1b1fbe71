// Who a J1939 node says it is when it is asked: software, component and ECU identification, and on
// an ISO 11783 bus its functionalities. Payloads longer than a frame go by transport, to the one
// who asked.
//
// Layout and sources: protocols/vehicle/identification.h, protocols/iso11783/functionalities.h.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "emulators/j1939/j1939_node.h"
#include "fields/rules.h"
#include "protocols/iso11783/functionalities.h"

namespace rigwire::emulators {

/// Printable ASCII without "*", up to 32 characters each.
struct IdentificationSettings {
  std::string make = "Rigwire";
  std::string model{};
  std::string unit_number{};  ///< Of the machine that it belongs to.
  std::string software = "1.0";
  std::string part_number{};
  std::string hardware{};  ///< Its revision.
};

void visit(fields::Visitor& v, IdentificationSettings& p);

/// A key whose text is sent in such answers, to be called within a visit().
void visit_readable(fields::Visitor& v, std::string_view key, std::string& value,
                    std::string_view text);

/// Answers a request for group `pgn`, if it is one of these; `type` is what kind of unit it is.
/// With no functionalities that group is not answered.
[[nodiscard]] std::optional<J1939Answer> answer_identification(
    J1939Node& node, SimTime now, std::uint32_t pgn, std::uint8_t destination,
    const IdentificationSettings& settings, std::uint32_t serial, std::string_view type,
    std::span<const protocols::iso11783::SupportedFunctionality> functionalities);

}  // namespace rigwire::emulators
