// Hydraulic valve driver: wire and device.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "emulators/modbus/modbus_server.h"
#include "emulators/valve_driver/valve_driver.h"
#include "hil/configuration/fields.h"
#include "hil/configuration/units.h"

namespace rigwire::hil {

/// Hydraulic valve driver as a Modbus TCP server.
struct ValveDriverConfiguration {
  std::string address = "127.0.0.1";  ///< Where it listens.
  std::uint16_t port = 1502;
  bool allow_remote = false;  ///< Needed to listen where other machines reach it.
  std::uint8_t unit = 1;      ///< On its Modbus line, 1 .. 247.
  emulators::ModbusServerSettings server;
  emulators::ValveDriverSettings driver;
};

inline constexpr std::array<Choice<emulators::valve_registers::Reaction>, 3> kValveReactions{
    {{emulators::valve_registers::Reaction::neutral, "neutral", "Spools to neutral."},
     {emulators::valve_registers::Reaction::hold, "hold", "Spools stay where they are."},
     {emulators::valve_registers::Reaction::floating, "floating", "Ports to tank."}}};

template <class Visitor>
void visit(Visitor& v, ValveDriverConfiguration& p) {
  v.text("address", p.address, "Where it listens.");
  v.integer("port", p.port, IntegerRule{1, 65535}, "TCP; the standard port 502 needs privileges.");
  v.boolean("allow_remote", p.allow_remote, "Permits listening where other machines reach it.");
  v.texts("sections", p.driver.sections, "Functions of the valve sections, from section 1.");
  v.integer("unit", p.unit, IntegerRule{1, 247}, "Modbus unit.");
  v.duration("processing_delay", p.server.processing_delay, {0, 1'000'000'000},
             "From a request to its answer.");
  v.duration("watchdog", p.driver.watchdog, {0, 5'000'000'000},
             "Without a request for this long the reaction follows; 0 = off.");
  v.choice("reaction", p.driver.reaction, kValveReactions, "When the watchdog runs out.");
  v.rate("rate", p.driver.sample_period, in("Hz").between(1, 1000), "Of the transducers.");
  v.duration("ramp_cycle", p.driver.ramp_cycle, {100'000, 100'000'000}, "Of the output steps.");
  v.number("coil_current_start", p.driver.coil_current_start_ma, plain().between(0, 65535),
           "mA at the least opening.");
  v.number("coil_current_full", p.driver.coil_current_full_ma, plain().above(0).at_most(65535),
           "mA at full opening.");
  v.number("supply_voltage", p.driver.supply_voltage_v, plain().between(9, 32), "V, reported.");
  v.number("driver_temperature", p.driver.driver_temperature_c, in("degC").between(-40, 150),
           "Reported.");
  v.number("spool_tolerance", p.driver.spool_tolerance, plain().between(0.01, 2),
           "Set point to measured position.");
  v.duration("spool_fault_delay", p.driver.spool_fault_delay, {0, 3'600'000'000'000},
             "Outside the tolerance for this long is a fault; 0 = never.");
  v.text("vendor", p.driver.vendor, "Identification.");
  v.text("product_code", p.driver.product_code, "Identification.");
  v.text("revision", p.driver.revision, "Identification.");
  v.text("product_name", p.driver.product_name, "Identification.");
}

inline void validate(const ValveDriverConfiguration& p) {
  validate(p.server);
  validate(p.driver);
}

}  // namespace rigwire::hil
