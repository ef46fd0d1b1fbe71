// Checks of the valve driver's settings.
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>

#include "emulators/valve_driver/valve_driver.h"

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

void check_text(const char* setting, const std::string& text) {
  constexpr std::size_t kLongest = 60;
  if (text.empty() || text.size() > kLongest) {
    refuse(setting, std::to_string(text.size()) + " characters", "1 .. 60 characters");
  }
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

}  // namespace

void validate(const ValveDriverSettings& settings) {
  check_sections(settings.sections);
  if (settings.watchdog != 0ms) {
    check("watchdog (unless 0)", settings.watchdog, 20ms, 5s);
    if (settings.watchdog % 1ms != 0ns) {
      refuse("watchdog", std::to_string(settings.watchdog.count()) + " ns", "whole milliseconds");
    }
  }
  if (settings.reaction > valve_registers::Reaction::floating) {
    refuse("reaction", std::to_string(static_cast<int>(settings.reaction)), "0 .. 2");
  }
  check("sample_period", settings.sample_period, 1ms, 1s);
  check("ramp_cycle", settings.ramp_cycle, 100us, 100ms);
  check("coil_current_full", settings.coil_current_full_ma, 1.0, 65535.0, "mA");
  check("coil_current_start", settings.coil_current_start_ma, 0.0, settings.coil_current_full_ma,
        "mA");
  check("supply_voltage", settings.supply_voltage_v, 9.0, 32.0, "V");
  check("driver_temperature", settings.driver_temperature_c, -40.0, 150.0, "degC");
  check("spool_tolerance", settings.spool_tolerance, 0.01, 2.0, "of full travel");
  check("spool_fault_delay", settings.spool_fault_delay, 0ms, 60s);
  check_text("vendor", settings.vendor);
  check_text("product_code", settings.product_code);
  check_text("revision", settings.revision);
  check_text("product_name", settings.product_name);
}

}  // namespace rigwire::emulators
