// Hydraulic valve driver: wire and device.
#pragma once

#include <cstdint>
#include <string>

#include "emulators/valve_driver/valve_driver.h"
#include "fields/visitor.h"

namespace rigwire::hil {

/// Hydraulic valve driver on one of the rig's Modbus lines, or as a TCP server of its own.
struct ValveDriverConfiguration {
  static constexpr fields::Named kNamed{"valve-driver",
                                        "Eight-section hydraulic valve driver, Modbus TCP server."};

  std::string line;                   ///< One of the rig's Modbus lines; empty: its own server.
  std::string address = "127.0.0.1";  ///< Where its own server listens.
  std::uint16_t port = 1502;
  bool allow_remote = false;  ///< Needed to listen where other machines reach it.
  std::uint8_t unit = 1;      ///< On its Modbus line, 1 .. 247.
  Duration processing_delay = std::chrono::microseconds(300);  ///< Of its own server.
  std::string map;  ///< File of the registers (hil/files/valve_map_file.h); empty: Rigwire's own.
  emulators::ValveDriverSettings driver;
};
/// The driver's settings, with its map read. Throws ConfigurationError.
[[nodiscard]] emulators::ValveDriverSettings driver_settings(
    const ValveDriverConfiguration& configuration);

inline void visit(fields::Visitor& v, ValveDriverConfiguration& p) {
  v.text("line", p.line, "One of the rig's Modbus lines; empty = a TCP server of its own.");
  v.integer("unit", p.unit, fields::IntegerRule{1, 247}, "Modbus unit.");
  if (p.line.empty()) {
    v.text("address", p.address, "Where it listens.");
    v.integer("port", p.port, fields::IntegerRule{1, 65535},
              "TCP; the standard port 502 needs privileges.");
    v.boolean("allow_remote", p.allow_remote, "Permits listening where other machines reach it.");
    v.duration("processing_delay", p.processing_delay, {0, 1'000'000'000},
               "From a request to its answer.");
  } else {
    for (const char* key : {"address", "port", "allow_remote", "processing_delay"}) {
      v.refused(key, "the line has its own");
    }
  }
  v.file("map", p.map, "Registers from a file (docs/your-own-valve.md); empty: Rigwire's own.");
  visit(v, p.driver);
}

/// Throws std::invalid_argument: what is out of range, and every fault of the map's file.
void validate(const ValveDriverConfiguration& p);

}  // namespace rigwire::hil
