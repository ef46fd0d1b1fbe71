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
#include "hil/configuration/modbus_fault.h"
#include "hil/wires/baud_check.h"

namespace rigwire::emulators {

inline constexpr std::array<fields::Choice<emulators::ModbusWire>, 2> kModbusWires{
    {{emulators::ModbusWire::tcp, "tcp", "A TCP server."},
     {emulators::ModbusWire::rtu, "rtu", "A serial line on a pty, RTU."}}};

}  // namespace rigwire::emulators

namespace rigwire::hil {

using protocols::modbus::SerialCharacter;
inline constexpr std::array<fields::Choice<SerialCharacter>, 4> kModbusParities{
    {{SerialCharacter::even_8e1, "even", "8E1, 11 bits; the standard's default."},
     {SerialCharacter::odd_8o1, "odd", "8O1, 11 bits."},
     {SerialCharacter::none_8n2, "none", "8N2, 11 bits."},
     {SerialCharacter::none_8n1, "none_one_stop", "8N1, 10 bits; common, not standard."}}};

using emulators::DelayDistribution;
inline constexpr std::array<fields::Choice<DelayDistribution>, 3> kDelayDistributions{
    {{DelayDistribution::constant, "constant", "Always `typical`."},
     {DelayDistribution::uniform, "uniform", "Between `minimum` and `maximum`."},
     {DelayDistribution::normal, "normal",
      "Mean `typical`, deviation `sigma`, held within `minimum` .. `maximum`."}}};

struct ModbusLineConfiguration {
  emulators::ModbusWire wire = emulators::ModbusWire::tcp;
  std::string address = "127.0.0.1";  ///< tcp: where it listens.
  std::uint16_t port = 1502;
  bool allow_remote = false;  ///< Needed to listen where other machines reach it.
  std::size_t clients_max = 32;
  std::size_t transactions_max = 16;
  Duration idle_timeout{0};
  std::string path = "/tmp/rigwire/modbus";  ///< rtu: symbolic link to the pty.
  emulators::RtuFramerSettings line;
  BaudCheck check_baud = BaudCheck::lenient;
  emulators::ResponseDelaySettings response_delay;
  std::vector<ModbusFaultConfiguration> faults;
};

[[nodiscard]] inline emulators::ModbusServerSettings server_settings(
    const ModbusLineConfiguration& p, std::uint64_t seed) {
  return {p.response_delay, p.transactions_max, p.idle_timeout, modbus_faults(p.faults), seed};
}
[[nodiscard]] inline emulators::ModbusRtuSettings rtu_settings(const ModbusLineConfiguration& p,
                                                               std::uint64_t seed) {
  return {p.line, p.response_delay, modbus_faults(p.faults), seed};
}

namespace detail {
inline void visit_tcp(fields::Visitor& v, ModbusLineConfiguration& p) {
  v.text("address", p.address, "Where it listens.");
  v.integer("port", p.port, fields::IntegerRule{1, 65535},
            "TCP; the standard port 502 needs privileges.");
  v.boolean("allow_remote", p.allow_remote, "Permits listening where other machines reach it.");
  v.integer("clients_max", p.clients_max, fields::IntegerRule{1, 1024},
            "When all places are taken, the client silent longest makes room.");
  v.integer("transactions_max", p.transactions_max, fields::IntegerRule{1, 16},
            "Unanswered requests per client; more get exception 06.");
  v.duration("idle_timeout", p.idle_timeout, {0, 86'400'000'000'000},
             "Closes a client silent for this long; 0 = never, else at least 1 s.");
}
inline void visit_rtu(fields::Visitor& v, ModbusLineConfiguration& p) {
  v.text("path", p.path, "Symbolic link to the pty.");
  v.integer("baud", p.line.timing.baud, fields::IntegerRule{300, 1'000'000}, "bit/s.");
  v.choice("parity", p.line.timing.character, kModbusParities, "And stop bits.");
  v.boolean("strict_gaps", p.line.strict_gaps,
            "More than 1.5 characters of silence inside a request spoil it, as on a wire.");
  v.duration("gap_tolerance", p.line.gap_tolerance, {0, 5'000'000'000},
             "Without strict gaps: how long the rest of a request may take to come.");
  v.choice("check_baud", p.check_baud, kBaudChecks, "Which client speeds are garbage.");
}
}  // namespace detail

}  // namespace rigwire::hil

namespace rigwire::emulators {

inline void visit(fields::Visitor& v, emulators::ResponseDelaySettings& p) {
  v.choice("distribution", p.distribution, hil::kDelayDistributions, "How it is drawn.");
  v.duration("typical", p.typical, {0, 10'000'000'000}, "constant, normal.");
  v.duration("sigma", p.sigma, {0, 10'000'000'000}, "normal.");
  v.duration("minimum", p.minimum, {0, 10'000'000'000}, "uniform, normal.");
  v.duration("maximum", p.maximum, {0, 10'000'000'000}, "uniform, normal.");
}

}  // namespace rigwire::emulators

namespace rigwire::hil {

inline void visit(fields::Visitor& v, ModbusLineConfiguration& p) {
  v.choice("wire", p.wire, emulators::kModbusWires, "What carries it.");
  if (p.wire == emulators::ModbusWire::tcp) {
    detail::visit_tcp(v, p);
    for (const char* key :
         {"path", "baud", "parity", "strict_gaps", "gap_tolerance", "check_baud"}) {
      v.refused(key, "only with wire: rtu");
    }
  } else {
    detail::visit_rtu(v, p);
    for (const char* key :
         {"address", "port", "allow_remote", "clients_max", "transactions_max", "idle_timeout"}) {
      v.refused(key, "only with wire: tcp");
    }
  }
  v.section("response_delay", p.response_delay, "From a request to its answer.");
  v.list("faults", p.faults, "What goes wrong, and when.");
}

inline void validate(const ModbusLineConfiguration& p) {
  if (p.wire == emulators::ModbusWire::tcp) {
    validate(server_settings(p, 0));
  } else {
    validate(rtu_settings(p, 0));
  }
  for (const ModbusFaultConfiguration& fault : p.faults) {
    validate(modbus_fault(fault), p.wire);
    if (fault.table == ModbusFaultTable::any && (fault.first != 0 || fault.last != 65535)) {
      throw std::invalid_argument(
          "modbus fault, first and last: found without a table, allowed "
          "with table: coils, discrete, holding, input");
    }
  }
}

}  // namespace rigwire::hil
