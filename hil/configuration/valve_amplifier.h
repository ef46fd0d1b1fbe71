// The amplifier of a valve block, on whatever bus: outputs, coils, supply, supervision, faults.
#pragma once

#include <array>
#include <cstddef>

#include "emulators/valve_amplifier/settings.h"
#include "fields/visitor.h"

namespace rigwire::emulators {

inline constexpr std::array<fields::Choice<emulators::ValveReaction>, 4> kValveReactions{
    {{emulators::ValveReaction::neutral, "neutral", "Spools to neutral."},
     {emulators::ValveReaction::hold, "hold", "Spools stay where they are."},
     {emulators::ValveReaction::floating, "floating", "Ports to tank."},
     {emulators::ValveReaction::position, "position", "Spools to loss_position."}}};

inline constexpr std::array<fields::Choice<emulators::ValveDefectKind>, 7> kValveDefects{
    {{emulators::ValveDefectKind::open_coil, "open_coil", "A wire of a section's coil is broken."},
     {emulators::ValveDefectKind::short_circuit, "short_circuit", "Of a section's coil."},
     {emulators::ValveDefectKind::stuck_spool, "stuck_spool", "A section's spool stays."},
     {emulators::ValveDefectKind::sensor_failure, "sensor_failure",
      "A section's position is not measured."},
     {emulators::ValveDefectKind::connector_off, "connector_off",
      "Neither coil nor sensor of a section."},
     {emulators::ValveDefectKind::supply_voltage, "supply_voltage", "Is `value`, in V."},
     {emulators::ValveDefectKind::ambient_temperature, "ambient_temperature",
      "Is `value`, in degC."}}};

inline void visit(fields::Visitor& v, emulators::ValveDefect& p) {
  std::size_t section_from_1 = p.section + 1;
  v.required("at");
  v.duration("at", p.start, {0, fields::kYear_ns}, "From the start of the run.");
  v.duration("for", p.duration, {0, fields::kYear_ns}, "How long; 0 = to the end.");
  v.required("type");
  v.choice("type", p.kind, kValveDefects, "What happens.");
  v.integer("section", section_from_1, fields::IntegerRule{1, 8}, "Whose, from 1.");
  v.number("value", p.value, fields::plain().between(-60, 200),
           "V or degC, of supply and surroundings.");
  p.section = section_from_1 - 1;
}

inline void visit(fields::Visitor& v, emulators::ValveCoilParameters& p) {
  v.number("resistance", p.resistance_ohm, fields::plain().between(0.5, 500), "ohm at 20 degC.");
  v.number("inductance", p.inductance_h, fields::plain().between(0, 10), "H.");
  v.number("thermal_resistance", p.thermal_resistance_kpw, fields::plain().between(0, 100),
           "K/W, coil to oil.");
  v.number("thermal_time_constant", p.thermal_time_constant_s, fields::in("s").between(1, 1e5),
           "Of the winding's temperature.");
}

inline void visit(fields::Visitor& v, emulators::ValveElectronics& p) {
  v.number("supply_voltage", p.supply_voltage_v, fields::plain().between(5, 60), "V.");
  v.number("under_voltage", p.under_voltage_v, fields::plain().between(0, 60),
           "V; below it fault 4.");
  v.duration("under_voltage_delay", p.under_voltage_delay, {0, 60'000'000'000},
             "How long it must last.");
  v.number("over_current", p.over_current_ma, fields::plain().between(1, 60e3),
           "mA; above it fault 3.");
  v.duration("over_current_delay", p.over_current_delay, {0, 60'000'000'000},
             "How long it must last.");
  v.number("open_share", p.open_share, fields::in("1").between(0, 1),
           "Of the set current; less for the delay is fault 2.");
  v.duration("open_delay", p.open_delay, {0, 60'000'000'000}, "How long it must last.");
  v.number("ambient_temperature", p.ambient_temperature_c, fields::in("degC").between(-40, 150),
           "Around the driver.");
  v.number("idle_power", p.idle_power_w, fields::in("W").between(0, 100), "Heats the driver.");
  v.number("output_resistance", p.output_resistance_ohm, fields::plain().between(0, 10),
           "ohm of each output; heats the driver.");
  v.number("thermal_resistance", p.thermal_resistance_kpw, fields::plain().between(0, 100),
           "K/W, driver to its surroundings.");
  v.number("thermal_time_constant", p.thermal_time_constant_s, fields::in("s").between(1, 1e5),
           "Of the driver's temperature.");
  v.number("over_temperature", p.over_temperature_c, fields::in("degC").between(-40, 300),
           "At it fault 7.");
}

inline void visit(fields::Visitor& v, emulators::ValveAmplifierSettings& p) {
  v.texts("sections", p.sections, "Functions of the valve sections, from section 1.");
  v.duration("ramp_cycle", p.ramp_cycle, {100'000, 100'000'000}, "Of the output steps.");
  v.number("coil_current_start", p.parameters.current_start_ma, fields::plain().between(0, 65535),
           "mA at the least opening.");
  v.number("coil_current_full", p.parameters.current_full_ma,
           fields::plain().above(0).at_most(65535), "mA at full opening.");
  v.number("dither_amplitude", p.parameters.dither.amplitude_ma, fields::plain().between(0, 500),
           "mA; 0 = none.");
  v.number("dither_frequency", p.parameters.dither.frequency_hz, fields::in("Hz").between(20, 400),
           "Of the current's ripple.");
  v.section("coil", p.coil, "Of each section.");
  v.section("electronics", p.electronics, "Supply, output stage, supervision.");
  v.number("spool_time_constant", p.spool_time_constant_s, fields::in("s").between(0, 1),
           "Of the dither's trace in the position.");
  v.number("spool_tolerance", p.spool_tolerance, fields::plain().between(0.01, 2),
           "Set point to measured position.");
  v.duration("spool_fault_delay", p.spool_fault_delay, {0, 60'000'000'000},
             "Outside the tolerance for this long is a fault; 0 = never.");
  v.list("faults", p.defects, "What happens to coils, spools, sensors, supply, surroundings.");
}

}  // namespace rigwire::emulators
