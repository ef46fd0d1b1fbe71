// A StarFire 3000 of a rig: its serial line, its bus, its antenna and how well it measures.
#pragma once

#include <string>

#include "emulators/starfire/settings.h"
#include "hil/configuration/fields.h"
#include "hil/configuration/gnss_sensor.h"
#include "hil/configuration/mount.h"
#include "hil/configuration/units.h"

namespace rigwire::hil {

/// John Deere StarFire 3000 on a serial line and, where `bus` names one, on J1939.
struct StarFireConfiguration {
  std::string path = "/tmp/rigwire/starfire";  ///< Symbolic link to the pty that a client opens.
  std::string bus;                             ///< One of the rig's buses; empty = serial only.
  MountConfiguration mount;                    ///< Of the antenna.
  emulators::StarFireSettings receiver;
  sim::GnssParameters sensor;
};

template <class Visitor>
void visit(Visitor& v, StarFireConfiguration& p) {
  emulators::StarFireSettings& r = p.receiver;
  v.text("path", p.path, "Symbolic link to the pty; what a client opens.");
  v.text("bus", p.bus, "One of the rig's buses; empty = serial only.");
  v.integer("baud", r.baud, IntegerRule{4800, 115200}, "Of the line, 8N1.");
  v.rate("sentence_rate", r.sentence_period, in("Hz").at_least(1).at_most(10),
         "Epochs on the serial line: 1, 5 or 10 a second.");
  v.texts("sentences", r.sentences, "In this order: GGA GSA RMC VTG ZDA.");
  v.text("talker", r.talker, "GP or GN.");
  v.duration("power_on", r.power_on, {0, 86'400'000'000'000}, "From the start of the run.");
  v.duration("start_up", r.start_up, {0, 600'000'000'000}, "From power-on to the first epoch.");
  v.duration("latency", r.latency, {0, 90'000'000}, "From an epoch to what it sends.");
  v.integer("source_address", r.source_address, IntegerRule{0, 253}, "Preferred J1939 address.");
  v.integer("serial", r.serial, IntegerRule{1, (1 << 21) - 1}, "In the NAME; unique on a bus.");
  v.section("mount", p.mount, "Of the antenna.");
  v.section("sensor", p.sensor, "How well it knows where it is.");
}

inline void validate(const StarFireConfiguration& p) {
  validate(p.receiver);
  validate(p.sensor);
}

}  // namespace rigwire::hil
