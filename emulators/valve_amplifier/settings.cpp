#include "emulators/valve_amplifier/settings.h"

#include <cmath>
#include <set>
#include <stdexcept>

namespace rigwire::emulators {
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

void check_parameters(const ValveAmplifierParameters& parameters) {
  if (parameters.watchdog != 0ms) {
    check("watchdog (unless 0)", parameters.watchdog, 1ms, 1h);
  }
  if (parameters.reaction > ValveReaction::position) {
    refuse("reaction", std::to_string(static_cast<int>(parameters.reaction)), "0 .. 3");
  }
  check("loss_position", parameters.loss_position, -1.0, 1.0, "of full travel");
  check("coil_current_full", parameters.current_full_ma, 1.0, 65535.0, "mA");
  check("coil_current_start", parameters.current_start_ma, 0.0, parameters.current_full_ma, "mA");
  check("dither_amplitude", parameters.dither.amplitude_ma, 0.0, 500.0, "mA");
  check("dither_frequency", parameters.dither.frequency_hz, 20.0, 400.0, "Hz");
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

void check_electronics(const ValveElectronics& electronics) {
  check("supply_voltage", electronics.supply_voltage_v, 5.0, 60.0, "V");
  check("under_voltage", electronics.under_voltage_v, 0.0, electronics.supply_voltage_v, "V");
  check("under_voltage_delay", electronics.under_voltage_delay, 0ms, 60s);
  check("over_current", electronics.over_current_ma, 1.0, 60e3, "mA");
  check("over_current_delay", electronics.over_current_delay, 0ms, 60s);
  check("open_share", electronics.open_share, 0.0, 1.0, "of the set current");
  check("open_delay", electronics.open_delay, 0ms, 60s);
  check("ambient_temperature", electronics.ambient_temperature_c, -40.0, 150.0, "degC");
  check("idle_power", electronics.idle_power_w, 0.0, 100.0, "W");
  check("output_resistance", electronics.output_resistance_ohm, 0.0, 10.0, "ohm");
  check("thermal_resistance", electronics.thermal_resistance_kpw, 0.0, 100.0, "K/W");
  check("thermal_time_constant", electronics.thermal_time_constant_s, 1.0, 1e5, "s");
  check("over_temperature", electronics.over_temperature_c, -40.0, 300.0, "degC");
}

void check_defect(const ValveDefect& defect, std::size_t sections) {
  if (defect.section >= sections) {
    refuse("faults: section", std::to_string(defect.section + 1),
           "1 .. " + std::to_string(sections));
  }
  check("faults: start", defect.start, 0ms, 8760h);
  check("faults: duration", defect.duration, 0ms, 8760h);
  if (defect.kind == ValveDefectKind::supply_voltage) {
    check("faults: value", defect.value, 0.0, 60.0, "V");
  } else if (defect.kind == ValveDefectKind::ambient_temperature) {
    check("faults: value", defect.value, -60.0, 200.0, "degC");
  }
}

}  // namespace

bool consistent(const ValveAmplifierParameters& parameters) {
  return parameters.current_start_ma < parameters.current_full_ma &&
         parameters.dither.amplitude_ma <= parameters.current_start_ma;
}

void validate(const ValveAmplifierSettings& settings) {
  check_sections(settings.sections);
  check_parameters(settings.parameters);
  check("ramp_cycle", settings.ramp_cycle, 100us, 100ms);
  check("coil resistance", settings.coil.resistance_ohm, 0.5, 500.0, "ohm");
  check("coil inductance", settings.coil.inductance_h, 0.0, 10.0, "H");
  check("coil thermal_resistance", settings.coil.thermal_resistance_kpw, 0.0, 100.0, "K/W");
  check("coil thermal_time_constant", settings.coil.thermal_time_constant_s, 1.0, 1e5, "s");
  check_electronics(settings.electronics);
  check("spool_time_constant", settings.spool_time_constant_s, 0.0, 1.0, "s");
  check("spool_tolerance", settings.spool_tolerance, 0.01, 2.0, "of full travel");
  check("spool_fault_delay", settings.spool_fault_delay, 0ms, 60s);
  for (const ValveDefect& defect : settings.defects) {
    check_defect(defect, settings.sections.size());
  }
}

}  // namespace rigwire::emulators
