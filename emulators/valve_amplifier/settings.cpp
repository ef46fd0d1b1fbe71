#include "emulators/valve_amplifier/settings.h"

#include <cmath>
#include <set>
#include <stdexcept>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::emulators {

using fields::in;

namespace {

using namespace std::chrono_literals;

[[noreturn]] void refuse(const std::string& setting, const std::string& found,
                         const std::string& allowed) {
  throw std::invalid_argument("valve driver " + setting + ": found " + found + ", allowed " +
                              allowed);
}

void check(const char* setting, double value, double lower, double upper, const char* unit) {
  if (!(value >= lower && value <= upper)) {
    refuse(setting, std::to_string(value) + " " + unit,
           std::to_string(lower) + " .. " + std::to_string(upper) + " " + unit);
  }
}

void check(const char* setting, Duration value, Duration lower, Duration upper) {
  check(setting, to_seconds(value) * 1e3, to_seconds(lower) * 1e3, to_seconds(upper) * 1e3, "ms");
}

void check_sections(const std::vector<std::string>& sections) {
  if (sections.empty() || sections.size() > kValveSections) {
    refuse("sections", std::to_string(sections.size()) + " names",
           "1 .. " + std::to_string(kValveSections));
  }
  std::set<std::string> seen;
  for (const std::string& name : sections) {
    if (name.empty() || !seen.insert(name).second) {
      refuse("sections", "\"" + name + "\"", "names that are not empty and differ");
    }
  }
}

/// What only a master sets, over the wire: no key names it.
void check_parameters(const ValveAmplifierParameters& parameters) {
  if (parameters.watchdog != 0ms) {
    check("watchdog (unless 0)", parameters.watchdog, 1ms, 1h);
  }
  if (parameters.reaction > ValveReaction::position) {
    refuse("reaction", std::to_string(static_cast<int>(parameters.reaction)), "0 .. 3");
  }
  check("loss_position", parameters.loss_position, -1.0, 1.0, "of full travel");
  for (const ValveStageParameters& stage : parameters.stage) {
    check("dead_band_positive", stage.dead_band_positive, 0.0, 0.5, "of full travel");
    check("dead_band_negative", stage.dead_band_negative, 0.0, 0.5, "of full travel");
    check("ramp_up", stage.ramp_up, 0ms, 1h);
    check("ramp_down", stage.ramp_down, 0ms, 1h);
    check("gain", stage.gain, 0.0, 2.0, "");
    if (std::abs(stage.polarity) != 1.0) {
      refuse("polarity", std::to_string(stage.polarity), "1 or -1");
    }
  }
}

}  // namespace

bool consistent(const ValveAmplifierParameters& parameters) {
  return parameters.current_start_ma < parameters.current_full_ma &&
         parameters.dither.amplitude_ma <= parameters.current_start_ma;
}

void visit(fields::Visitor& v, ValveElectronics& p) {
  v.number("supply_voltage", p.supply_voltage_v, in("V").between(5, 60), "Voltage of the supply.");
  v.number("under_voltage", p.under_voltage_v, in("V").between(0, 60),
           "Supply voltage below which fault 4 follows; at most supply_voltage.");
  v.duration("under_voltage_delay", p.under_voltage_delay, {0, 60'000'000'000},
             "How long the voltage must be too low for fault 4.");
  v.number("over_current", p.over_current_ma, in("mA").stored_as("mA").between(1, 60e3),
           "Current of an output above which fault 3 follows.");
  v.duration("over_current_delay", p.over_current_delay, {0, 60'000'000'000},
             "How long the current must be too high for fault 3.");
  v.number("open_share", p.open_share, in("1").between(0, 1),
           "Share of the set current below which fault 2, an open coil, follows.");
  v.duration("open_delay", p.open_delay, {0, 60'000'000'000},
             "How long the current must be missing for fault 2.");
  v.number("ambient_temperature", p.ambient_temperature_c, in("degC").between(-40, 150),
           "Temperature around the driver.");
  v.number("idle_power", p.idle_power_w, in("W").between(0, 100),
           "Power that heats the driver when no coil is driven.");
  v.number("output_resistance", p.output_resistance_ohm, in("ohm").between(0, 10),
           "Resistance of each output, which heats the driver.");
  v.number("thermal_resistance", p.thermal_resistance_kpw, in("K/W").between(0, 100),
           "Warming of the driver over its surroundings per watt.");
  v.number("thermal_time_constant", p.thermal_time_constant_s, in("s").between(1, 1e5),
           "How slowly the driver warms and cools.");
  v.number("over_temperature", p.over_temperature_c, in("degC").between(-40, 300),
           "Temperature of the driver at which fault 7 follows.");
}

void visit(fields::Visitor& v, ValveAmplifierSettings& p) {
  v.texts("sections", p.sections, "Functions of the valve sections, from section 1.");
  v.duration("ramp_cycle", p.ramp_cycle, {100'000, 100'000'000},
             "Time from one step of an output on a ramp to the next.");
  v.number("coil_current_start", p.parameters.current_start_ma,
           in("mA").stored_as("mA").between(0, 65535),
           "Coil current at the least opening; at most coil_current_full.");
  v.number("coil_current_full", p.parameters.current_full_ma,
           in("mA").stored_as("mA").between(1, 65535), "Coil current at full opening.");
  v.number("dither_amplitude", p.parameters.dither.amplitude_ma,
           in("mA").stored_as("mA").between(0, 500), "Ripple of the coil current; 0 = none.");
  v.number("dither_frequency", p.parameters.dither.frequency_hz, in("Hz").between(20, 400),
           "Frequency of the coil current's ripple.");
  v.section("coil", p.coil, "Coil of each section.");
  v.section("electronics", p.electronics, "Supply, output stage, supervision.");
  v.number("spool_time_constant", p.spool_time_constant_s, in("s").between(0, 1),
           "How slowly a spool follows the dither, for its trace in the measured position.");
  v.number("spool_tolerance", p.spool_tolerance, in("1").between(0.01, 2),
           "Share of full travel by which a measured position may miss its set point.");
  v.duration("spool_fault_delay", p.spool_fault_delay, {0, 60'000'000'000},
             "A spool outside its tolerance for this long is fault 5; 0 = never.");
}

void validate(const ValveAmplifierSettings& settings) {
  fields::check(settings);
  check_sections(settings.sections);
  check_parameters(settings.parameters);
  check("coil_current_start", settings.parameters.current_start_ma, 0.0,
        settings.parameters.current_full_ma, "mA");
  check("under_voltage", settings.electronics.under_voltage_v, 0.0,
        settings.electronics.supply_voltage_v, "V");
  for (const ValveDefect& defect : settings.defects) {
    fields::check(defect);
    check_section(defect, settings.sections.size());
  }
}

void check_section(const ValveDefect& defect, std::size_t sections) {
  if (const auto section = section_of(defect); section >= sections) {
    refuse("faults: section", std::to_string(*section + 1), "1 .. " + std::to_string(sections));
  }
}

}  // namespace rigwire::emulators
