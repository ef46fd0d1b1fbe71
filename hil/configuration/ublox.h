// A u-blox receiver of a rig: its line, its antenna, what the device does and how well it measures.
#pragma once

#include <string>

#include "emulators/ublox/settings.h"
#include "hil/configuration/fields.h"
#include "hil/configuration/gnss_sensor.h"
#include "hil/configuration/mount.h"
#include "hil/configuration/units.h"

namespace rigwire::hil {

/// u-blox NEO-7P on a serial line.
struct UbloxConfiguration {
  std::string path = "/tmp/rigwire/gnss";  ///< Symbolic link to the pty that a client opens.
  bool check_baud = true;    ///< A client at another speed hears garbage and is heard as garbage.
  MountConfiguration mount;  ///< Of the antenna.
  emulators::UbloxSettings receiver;
  sim::GnssParameters sensor;
};

template <class Visitor>
void visit(Visitor& v, UbloxConfiguration& p) {
  v.text("path", p.path, "Symbolic link to the pty; what a client opens.");
  v.rate("rate", p.receiver.measurement_period, in("Hz").above(0).at_most(20),
         "Navigation epochs; a client may change it by CFG-RATE.");
  v.integer("baud", p.receiver.baud, IntegerRule{4800, 460800}, "Of the line, 8N1, at power-on.");
  v.boolean("check_baud", p.check_baud,
            "A client at another speed hears garbage and is heard as garbage.");
  v.texts("nmea_sentences", p.receiver.nmea_sentences,
          "On at power-on: RMC VTG GGA GSA GSV GLL ZDA.");
  v.texts("ubx_messages", p.receiver.ubx_messages, "On at power-on: NAV-PVT, NAV-SOL and others.");
  v.duration("time_to_first_fix", p.receiver.time_to_first_fix, {0, 3'600'000'000'000},
             "From power-on; 0 = a fix in the first epoch.");
  v.duration("solution_latency", p.receiver.solution_latency, {0, 200'000'000},
             "From the epoch to the first byte.");
  v.duration("start_up", p.receiver.start_up, {0, 10'000'000'000},
             "From power-on to the first byte.");
  v.boolean("start_banner", p.receiver.start_banner, "TXT sentences after power-on.");
  v.integer("transmit_buffer", p.receiver.transmit_buffer_bytes, IntegerRule{1024, 65536},
            "Bytes that may wait for the line.");
  v.section("mount", p.mount, "Of the antenna.");
  v.section("sensor", p.sensor, "How well it knows where it is.");
}

inline void validate(const UbloxConfiguration& p) {
  validate(p.receiver);
  validate(p.sensor);
}

}  // namespace rigwire::hil
