// Hydraulic valves on ISO 11783: bus, valves, levers, amplifier.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "emulators/iso_valve/settings.h"
#include "fields/visitor.h"
#include "hil/configuration/valve_amplifier.h"

namespace rigwire::hil {

/// A block of auxiliary valves on a J1939 bus.
struct IsoValvesConfiguration {
  static constexpr fields::Named kNamed{
      "iso-valves", "Block of auxiliary valves with joysticks, on CAN (ISO 11783)."};

  std::string bus = "can";  ///< One of the rig's buses.
  emulators::IsoValveSettings valves;
};

/// The axes of the two joysticks, in the order of emulators::JoystickAxis.
struct JoystickMapping {
  std::array<std::string, emulators::kJoystickAxes>& axes;
};
inline constexpr std::array<std::string_view, emulators::kJoystickAxes> kJoystickAxisNames{
    "x1", "y1", "grip_x1", "grip_y1", "theta1", "x2", "y2", "grip_x2", "grip_y2", "theta2"};

inline void visit(fields::Visitor& v, JoystickMapping& p) {
  for (std::size_t axis = 0; axis < kJoystickAxisNames.size(); ++axis) {
    v.text(kJoystickAxisNames[axis], p.axes[axis],
           "Section that this axis moves; -section: turned round; empty: none.");
  }
}

inline void visit(fields::Visitor& v, IsoValvesConfiguration& p) {
  v.text("bus", p.bus, "One of the rig's buses.");
  v.integer("source_address", p.valves.source_address, fields::IntegerRule{128, 247},
            "Preferred J1939 address; another one is claimed when it is lost.");
  v.integer("serial", p.valves.serial, fields::IntegerRule{0, (1 << 21) - 1},
            "In the NAME; unique on a bus.");
  v.integer("manufacturer", p.valves.manufacturer, fields::IntegerRule{0, 2047}, "In the NAME.");
  v.integer("function", p.valves.function, fields::IntegerRule{0, 255}, "In the NAME.");
  v.integer("first_valve", p.valves.first_valve, fields::IntegerRule{0, 15},
            "Auxiliary valve of section 1; the others follow.");
  v.integer("general_purpose_section", p.valves.general_purpose_section, fields::IntegerRule{0, 8},
            "Section of the general-purpose valve, from 1; 0 = none.");
  v.duration("command_timeout", p.valves.command_timeout, {100'000'000, 10'000'000'000},
             "Without a command for this long a valve goes to its fail-safe mode.");
  v.duration("power_on", p.valves.power_on, {0, 3'600'000'000'000}, "From the start of the run.");
  v.duration("processing_delay", p.valves.processing_delay, {0, 4'000'000},
             "From an event to its frame.");
  v.rate("rate", p.valves.sample_period, fields::in("Hz").between(1, 1000), "Of the transducers.");
  v.number("spool_travel", p.valves.spool_travel_m, fields::in("mm").between(0.1, 30),
           "Neutral to full.");
  JoystickMapping joysticks{p.valves.levers};
  v.section("joysticks", joysticks, "The operator's levers: BJM1, EJM1 and BJM2, EJM2.");
  visit(v, p.valves.amplifier);
}

inline void validate(const IsoValvesConfiguration& p) {
  validate(p.valves);
}

}  // namespace rigwire::hil
