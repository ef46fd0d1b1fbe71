// Who a J1939 node says it is when it is asked: software, component, ECU and vehicle
// identification, and on an ISO 11783 bus its functionalities. Payloads longer than a frame go by
// transport, to the one who asked.
//
// Layout and sources: protocols/vehicle/identification.h, protocols/iso11783/functionalities.h.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

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
  std::string type{};      ///< What kind of unit it is: "tractor ECU".
  std::string hardware{};  ///< Its revision.
  /// Of the whole machine: 17 letters (no I, O, Q) and digits; empty: it knows none.
  std::string vehicle_identification_number{};

  friend bool operator==(const IdentificationSettings&, const IdentificationSettings&) = default;
};

/// Its keys, among those of the device.
void visit(fields::Visitor& v, IdentificationSettings& p);

/// Answers a request for group `pgn`, if it is one of these. With no functionalities that group is
/// not answered, and without a number the vehicle identification is not.
[[nodiscard]] std::optional<J1939Answer> answer_identification(
    J1939Node& node, SimTime now, std::uint32_t pgn, std::uint8_t destination,
    const IdentificationSettings& settings, std::uint32_t serial,
    std::span<const protocols::iso11783::SupportedFunctionality> functionalities);

}  // namespace rigwire::emulators
