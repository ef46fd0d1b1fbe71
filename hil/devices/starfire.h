// A StarFire 3000 of a rig: its serial line, its bus, its antenna and how well it measures.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "emulators/starfire/settings.h"
#include "fields/visitor.h"
#include "hil/configuration/gnss_fault.h"
#include "hil/wires/baud_check.h"
#include "hil/world/mount.h"
#include "sim/gnss/gnss_parameters.h"

namespace rigwire::hil {

/// John Deere StarFire 3000.
struct StarFireConfiguration {
  static constexpr fields::Named kNamed{
      "starfire-3000", "John Deere StarFire 3000 satellite receiver (NMEA, J1939)."};

  std::string path =
      "/tmp/rigwire/starfire";  ///< Symbolic link to the pty; empty = no serial line.
  BaudCheck check_baud = BaudCheck::lenient;
  std::string bus;           ///< One of the rig's buses; empty = no node.
  MountConfiguration mount;  ///< Of the antenna.
  emulators::StarFireSettings receiver;
  sim::GnssParameters sensor;
  std::vector<GnssFaultConfiguration> faults;

  StarFireConfiguration() {
    sensor.systems.glonass = true;
    sensor.systems.sbas = true;
    sensor.corrections.kind = sim::CorrectionKind::service;
  }
};

/// Faults of the device that it does not have; everything else of the list it does.
[[nodiscard]] inline bool implements(const StarFireConfiguration&,
                                     const GnssFaultConfiguration& fault) {
  return !std::holds_alternative<FrozenFixFault>(fault.settings) &&
         !std::holds_alternative<WrongLeapSecondFault>(fault.settings) &&
         !std::holds_alternative<UartNoiseFault>(fault.settings);
}

inline void visit(fields::Visitor& v, StarFireConfiguration& p) {
  v.text("path", p.path, "Symbolic link to the pty; what a client opens; empty = no serial line.");
  v.choice("check_baud", p.check_baud, kBaudChecks, "When a client hears garbage.");
  v.text("bus", p.bus, "One of the rig's buses; empty = not on one.");
  visit(v, p.receiver);
  v.section("mount", p.mount, "Of the antenna.");
  v.section("sensor", p.sensor, "How well it knows where it is.");
  v.list("faults", p.faults, "What goes wrong, and when.");
}

inline void validate(const StarFireConfiguration& p) {
  if (p.path.empty() && p.bus.empty()) {
    throw std::invalid_argument("neither `path` nor `bus` is given, at least one is needed");
  }
  validate(p.receiver);
  validate(p.sensor);
}

}  // namespace rigwire::hil
