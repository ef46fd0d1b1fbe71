// The Modbus lines of a rig: what devices share by naming a line and a unit.
//
//   modbus:
//     cab: {wire: rtu, path: /tmp/rigwire/modbus, baud: 19200, parity: even}
//   devices:
//     valves: {type: valve-driver, line: cab, unit: 3}
//
// docs/modbus.md says what a line does.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "emulators/modbus/modbus_rtu_server.h"
#include "emulators/modbus/modbus_server.h"
#include "fields/visitor.h"
#include "hil/wires/line_ports.h"

namespace rigwire::hil {

struct ModbusLineConfiguration {
  emulators::ModbusWire wire = emulators::ModbusWire::tcp;
  std::string address = "127.0.0.1";  ///< tcp: where it listens.
  std::uint16_t port = 1502;
  bool allow_remote = false;  ///< Needed to listen where other machines reach it.
  std::size_t clients_max = 32;
  emulators::ModbusServerSettings server;    ///< tcp; but for what server_settings() fills in.
  std::string path = "/tmp/rigwire/modbus";  ///< rtu: symbolic link to the pty.
  emulators::RtuFramerSettings line;
  BaudCheck check_baud = BaudCheck::lenient;
  emulators::ResponseDelaySettings response_delay;
  std::vector<emulators::ModbusFault> faults;
};

[[nodiscard]] inline emulators::ModbusServerSettings server_settings(
    const ModbusLineConfiguration& p, std::uint64_t seed) {
  emulators::ModbusServerSettings settings = p.server;
  settings.response_delay = p.response_delay;
  settings.faults = p.faults;
  settings.seed = seed;
  return settings;
}
[[nodiscard]] inline emulators::ModbusRtuSettings rtu_settings(const ModbusLineConfiguration& p,
                                                               std::uint64_t seed) {
  return {p.line, p.response_delay, p.faults, seed};
}

inline void visit(fields::Visitor& v, ModbusLineConfiguration& p) {
  v.choice("wire", p.wire, emulators::kModbusWires, "What carries the requests.");
  const bool is_tcp = p.wire == emulators::ModbusWire::tcp;
  v.only_if(is_tcp, "wire", "wire: tcp", [&p](fields::Visitor& keys) {
    keys.text("address", p.address, "Address at which it listens.");
    keys.integer("port", p.port, fields::IntegerRule{1, 65535},
                 "TCP port; the standard port 502 needs privileges.");
    keys.boolean("allow_remote", p.allow_remote,
                 "Permits listening where other machines reach it.");
    keys.integer("clients_max", p.clients_max, fields::IntegerRule{1, 1024},
                 "When all places are taken, the client silent longest makes room.");
    visit(keys, p.server);
  });
  v.only_if(!is_tcp, "wire", "wire: rtu", [&p](fields::Visitor& keys) {
    keys.text("path", p.path, "Symbolic link to the pty; what a client opens.");
    visit(keys, p.line);
    keys.choice("check_baud", p.check_baud, kBaudChecks, "When a client receives garbage.");
  });
  v.section("response_delay", p.response_delay, "Time from a request to its answer.");
  v.list("faults", p.faults, "What goes wrong on the line, and when.");
}

inline void validate(const ModbusLineConfiguration& p) {
  if (p.wire == emulators::ModbusWire::tcp) {
    validate(server_settings(p, 0));
  } else {
    validate(rtu_settings(p, 0));
  }
  for (const emulators::ModbusFault& fault : p.faults) {
    validate(fault, p.wire);
  }
}

}  // namespace rigwire::hil
