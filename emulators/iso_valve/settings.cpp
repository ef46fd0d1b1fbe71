#include "emulators/iso_valve/settings.h"

#include <algorithm>
#include <stdexcept>
#include <string_view>

#include "fields/check.h"
#include "fields/visitor.h"
#include "protocols/iso11783/auxiliary_valve.h"

namespace rigwire::emulators {

using fields::in;
using fields::IntegerRule;

namespace {

/// In the order of JoystickAxis.
constexpr std::array<std::string_view, kJoystickAxes> kAxisNames{
    "x1", "y1", "grip_x1", "grip_y1", "theta1", "x2", "y2", "grip_x2", "grip_y2", "theta2"};

[[noreturn]] void refuse(const std::string& setting, const std::string& found,
                         const std::string& allowed) {
  throw std::invalid_argument("iso valves " + setting + ": found " + found + ", allowed " +
                              allowed);
}

}  // namespace

void visit(fields::Visitor& v, IsoValveSettings& p) {
  v.integer("source_address", p.source_address, IntegerRule{128, 247},
            "Preferred J1939 address; another one is claimed when it is lost.");
  v.integer("serial", p.serial, IntegerRule{0, (1 << 21) - 1},
            "Identity number in the NAME; unique on a bus.");
  v.integer("manufacturer", p.manufacturer, IntegerRule{0, 2047},
            "Manufacturer code in the NAME; 2047 = no number assigned.");
  v.integer("function", p.function, IntegerRule{0, 255},
            "Function in the NAME; 255 = not specified.");
  visit(v, p.identification);
  v.integer("first_valve", p.first_valve, IntegerRule{0, 15},
            "Auxiliary valve of section 1; the others follow.");
  v.integer("general_purpose_section", p.general_purpose_section, IntegerRule{0, 8},
            "Section of the general-purpose valve, from 1; 0 = none.");
  v.duration("command_timeout", p.command_timeout, {100'000'000, 10'000'000'000},
             "Without a command for this long a valve goes to its fail-safe mode.");
  v.duration("power_on", p.power_on, {0, fields::kYear_ns},
             "When the supply comes, from the start of the run.");
  v.duration("processing_delay", p.processing_delay, {0, 4'000'000},
             "Time from an event to its frame.");
  v.rate("rate", p.sample_period, in("Hz").between(1, 1000),
         "Readings of the transducers per second.");
  v.number("spool_travel", p.spool_travel_m, in("mm").between(0.1, 30),
           "Travel of a spool from neutral to full opening.");
  v.group(
      "joysticks",
      [&p](fields::Visitor& w) {
        for (std::size_t axis = 0; axis < kAxisNames.size(); ++axis) {
          w.text(kAxisNames[axis], p.levers[axis],
                 "Section that this axis moves; -section: turned round; empty: none.");
        }
      },
      "The operator's levers: BJM1, EJM1 and BJM2, EJM2.");
  visit(v, p.amplifier);
}

void validate(const IsoValveSettings& settings) {
  fields::check(settings);
  validate(settings.amplifier);
  const auto& names = settings.amplifier.sections;
  const std::size_t last_first = protocols::iso11783::kAuxiliaryValves - names.size();
  if (settings.first_valve > last_first) {
    refuse("first_valve", std::to_string(settings.first_valve),
           "0 .. " + std::to_string(last_first));
  }
  if (settings.general_purpose_section > names.size()) {
    refuse("general_purpose_section", std::to_string(settings.general_purpose_section),
           "0 .. " + std::to_string(names.size()));
  }
  for (const std::string& lever : settings.levers) {
    const std::string name = lever.starts_with("-") ? lever.substr(1) : lever;
    if (!lever.empty() && std::ranges::find(names, name) == names.end()) {
      std::string allowed = "a section, or - and a section:";
      for (const std::string& section : names) {
        allowed.append(" ").append(section);
      }
      refuse("joysticks", "\"" + lever + "\"", allowed);
    }
  }
}

}  // namespace rigwire::emulators
