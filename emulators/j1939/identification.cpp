#include "emulators/j1939/identification.h"

#include <algorithm>

#include "fields/visitor.h"
#include "protocols/vehicle/identification.h"

namespace rigwire::emulators {

namespace iso = protocols::iso11783;
namespace vehicle = protocols::vehicle;

void visit_readable(fields::Visitor& v, std::string_view key, std::string& value,
                    std::string_view text) {
  constexpr std::size_t kGreatest = 32;
  v.text(key, value, text);
  const bool plain =
      std::ranges::all_of(value, [](char c) { return c >= ' ' && c <= '~' && c != '*'; });
  v.check(plain && value.size() <= kGreatest, key, "cannot be sent", "\"" + value + "\"",
          "up to 32 printable ASCII characters without *");
}

void visit(fields::Visitor& v, IdentificationSettings& p) {
  visit_readable(v, "make", p.make, "Make, in component and ECU identification.");
  visit_readable(v, "model", p.model, "Model, in component identification.");
  visit_readable(v, "unit_number", p.unit_number, "Unit number, in component identification.");
  visit_readable(v, "software", p.software, "Software identification.");
  visit_readable(v, "part_number", p.part_number, "Part number, in ECU identification.");
  visit_readable(v, "hardware", p.hardware, "Hardware version, in ECU identification.");
}

std::optional<J1939Answer> answer_identification(
    J1939Node& node, SimTime now, std::uint32_t pgn, std::uint8_t destination,
    const IdentificationSettings& settings, std::uint32_t serial, std::string_view type,
    std::span<const iso::SupportedFunctionality> functionalities) {
  const auto send = [&](std::span<const std::uint8_t> payload) {
    protocols::j1939::Identifier identifier;
    identifier.pgn = pgn;
    identifier.destination = destination;
    return node.send(now, identifier, payload) ? J1939Answer::sent : J1939Answer::busy;
  };
  const std::string number = std::to_string(serial);
  switch (pgn) {
    case vehicle::kSoftwareIdentificationPgn:
      return send(vehicle::make_software_identification({settings.software}).payload());
    case vehicle::kComponentIdentificationPgn:
      return send(vehicle::make_identification(
                      {settings.make, settings.model, number, settings.unit_number})
                      .payload());
    case vehicle::kEcuIdentificationPgn:
      return send(vehicle::make_identification(
                      {settings.part_number, number, "", type, settings.make, settings.hardware})
                      .payload());
    case iso::kFunctionalitiesPgn:
      if (!functionalities.empty()) {
        return send(iso::make_functionalities(functionalities));
      }
      break;
    default:
      break;
  }
  return std::nullopt;
}

}  // namespace rigwire::emulators
