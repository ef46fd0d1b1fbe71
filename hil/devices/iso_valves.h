// Hydraulic valves on ISO 11783: bus, valves, levers, amplifier.
#pragma once

#include <string>

#include "emulators/iso_valve/settings.h"
#include "fields/visitor.h"

namespace rigwire::hil {

/// A block of auxiliary valves on a J1939 bus.
struct IsoValvesConfiguration {
  static constexpr fields::Named kNamed{
      "iso-valves", "Block of auxiliary valves with joysticks, on CAN (ISO 11783)."};

  std::string bus = "can";  ///< One of the rig's buses.
  emulators::IsoValveSettings valves;
};

inline void visit(fields::Visitor& v, IsoValvesConfiguration& p) {
  v.text("bus", p.bus, "One of the rig's buses.");
  visit(v, p.valves);
}

inline void validate(const IsoValvesConfiguration& p) {
  validate(p.valves);
}

}  // namespace rigwire::hil
