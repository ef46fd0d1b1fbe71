#include "emulators/j1939/identity.h"

#include <algorithm>

namespace rigwire::emulators {

using fields::IntegerRule;

namespace {

/// Returns whether `value` can be sent as a field that ends with "*".
bool is_field(const std::string& value) {
  constexpr std::size_t kGreatest = 32;
  return value.size() <= kGreatest &&
         std::ranges::all_of(value, [](char c) { return c >= ' ' && c <= '~' && c != '*'; });
}

bool is_vin_or_empty(const std::string& value) {
  return value.empty() || (value.size() == 17 && std::ranges::all_of(value, [](char c) {
                             return (c >= '0' && c <= '9') ||
                                    (c >= 'A' && c <= 'Z' && c != 'I' && c != 'O' && c != 'Q');
                           }));
}

}  // namespace

void visit(fields::Visitor& v, J1939NameSettings& p) {
  v.integer("manufacturer", p.manufacturer, IntegerRule{0, 2047},
            "Manufacturer code in the NAME; 0 is reserved.");
  v.integer("function", p.function, IntegerRule{0, 255},
            "Function in the NAME: 23 vehicle navigation, 30 management computer; with "
            "industry_group 2 and device_class 0, 134 tractor ECU.");
  v.integer("function_instance", p.function_instance, IntegerRule{0, 31},
            "Number among several such functions, in the NAME.");
  v.integer("device_class", p.device_class, IntegerRule{0, 127},
            "Device class (vehicle system) in the NAME; 0 = none in particular.");
  v.integer("industry_group", p.industry_group, IntegerRule{0, 7},
            "Industry group in the NAME: 0 global, 1 road, 2 agriculture, 3 construction.");
}

protocols::j1939::Name make_name(const J1939NameSettings& settings, std::uint32_t serial,
                                 bool arbitrary_address) {
  protocols::j1939::Name name;
  name.identity = serial;
  name.manufacturer = settings.manufacturer;
  name.function = settings.function;
  name.function_instance = settings.function_instance;
  name.vehicle_system = settings.device_class;
  name.industry_group = settings.industry_group;
  name.arbitrary_address = arbitrary_address;
  return name;
}

void visit(fields::Visitor& v, IdentificationSettings& p) {
  const auto field = [&v](std::string_view key, std::string& value, std::string_view text) {
    visit_sendable(v, key, value, text, is_field, "up to 32 printable ASCII characters without *");
  };
  field("make", p.make, "Make, in component and ECU identification.");
  field("model", p.model, "Model, in component identification.");
  field("unit_number", p.unit_number, "Unit number, in component identification.");
  field("software", p.software, "Software identification.");
  field("part_number", p.part_number, "Part number, in ECU identification.");
  field("unit_type", p.type, "Kind of unit, in ECU identification.");
  field("hardware", p.hardware, "Hardware version, in ECU identification.");
  visit_sendable(v, "vehicle_identification_number", p.vehicle_identification_number,
                 "Answer to requests for the machine's identification (VIN); empty = none.",
                 is_vin_or_empty, "17 digits and capitals without I, O and Q (ISO 3779), or none");
}

}  // namespace rigwire::emulators
