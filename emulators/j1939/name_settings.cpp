#include "emulators/j1939/name_settings.h"

#include "fields/visitor.h"

namespace rigwire::emulators {

using fields::IntegerRule;

void visit(fields::Visitor& v, J1939NameSettings& p) {
  v.integer("manufacturer", p.manufacturer, IntegerRule{0, 2047},
            "Manufacturer code in the NAME; 0 is reserved and nobody's.");
  v.integer("function", p.function, IntegerRule{0, 255},
            "Function in the NAME: 23 vehicle navigation, 30 management computer; with "
            "industry_group 2 and device_class 0, 134 tractor ECU.");
  v.integer("function_instance", p.function_instance, IntegerRule{0, 31},
            "Which of several such functions it is, in the NAME.");
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

}  // namespace rigwire::emulators
