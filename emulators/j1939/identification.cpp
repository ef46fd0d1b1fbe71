#include "emulators/j1939/identification.h"

#include <algorithm>
#include <string_view>

#include "fields/visitor.h"
#include "protocols/vehicle/identification.h"

namespace rigwire::emulators {

namespace iso = protocols::iso11783;
namespace vehicle = protocols::vehicle;

namespace {

/// A text of these answers.
void visit_readable(fields::Visitor& v, std::string_view key, std::string& value,
                    std::string_view text) {
  constexpr std::size_t kGreatest = 32;
  v.text(key, value, text);
  const bool plain =
      std::ranges::all_of(value, [](char c) { return c >= ' ' && c <= '~' && c != '*'; });
  v.check(plain && value.size() <= kGreatest, key, "cannot be sent", "\"" + value + "\"",
          "up to 32 printable ASCII characters without *");
}

bool is_vin_character(char c) {
  return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z' && c != 'I' && c != 'O' && c != 'Q');
}

}  // namespace

void visit(fields::Visitor& v, IdentificationSettings& p) {
  visit_readable(v, "make", p.make, "Make, in component and ECU identification.");
  visit_readable(v, "model", p.model, "Model, in component identification.");
  visit_readable(v, "unit_number", p.unit_number, "Unit number, in component identification.");
  visit_readable(v, "software", p.software, "Software identification.");
  visit_readable(v, "part_number", p.part_number, "Part number, in ECU identification.");
  visit_readable(v, "unit_type", p.type, "Kind of unit, in ECU identification.");
  visit_readable(v, "hardware", p.hardware, "Hardware version, in ECU identification.");
  constexpr std::string_view kVin = "vehicle_identification_number";
  const std::string& vin = p.vehicle_identification_number;
  v.text(kVin, p.vehicle_identification_number,
         "Answer to requests for the machine's identification (VIN); empty = none.");
  v.check(vin.empty() || (vin.size() == 17 && std::ranges::all_of(vin, is_vin_character)), kVin,
          "is no VIN", "\"" + vin + "\"",
          "17 digits and capitals without I, O and Q (ISO 3779), or nothing");
}

std::optional<J1939Answer> answer_identification(
    J1939Node& node, SimTime now, std::uint32_t pgn, std::uint8_t destination,
    const IdentificationSettings& settings, std::uint32_t serial,
    std::span<const iso::SupportedFunctionality> functionalities) {
  const auto send = [&](std::span<const std::uint8_t> payload) {
    return node.send_answer(now, pgn, destination, payload);
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
      return send(vehicle::make_identification({settings.part_number, number, "", settings.type,
                                                settings.make, settings.hardware})
                      .payload());
    case vehicle::kVehicleIdentificationPgn:
      if (!settings.vehicle_identification_number.empty()) {
        return send(
            vehicle::make_identification({settings.vehicle_identification_number}).payload());
      }
      break;
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
