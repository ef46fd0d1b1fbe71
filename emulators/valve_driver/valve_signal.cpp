#include "emulators/valve_driver/valve_signal.h"

#include <algorithm>
#include <array>

#include "fields/constants.h"

namespace rigwire::emulators {
namespace {

using enum ValveSignal;

constexpr std::array kSignals{
    ValveSignalInfo{command, "command", true, true, "%", "spool command, positive opens port A",
                    -100, 100},
    ValveSignalInfo{command_a, "command_a", true, true, "%",
                    "opening towards port A; less command_b it is the command", 0, 100},
    ValveSignalInfo{command_b, "command_b", true, true, "%",
                    "opening towards port B; taken from command_a it is the command", 0, 100},
    ValveSignalInfo{enable, "enable", true, false, "", "outputs follow commands"},
    ValveSignalInfo{enable_section, "enable_section", true, true, "",
                    "the section's output follows its command, while enabled"},
    ValveSignalInfo{fault_reset, "fault_reset", true, false, "", "acts on the change to 1"},
    ValveSignalInfo{floating, "float", true, true, "", "ports to tank"},
    ValveSignalInfo{quick_stop, "quick_stop", true, false, "", "neutral at once"},
    ValveSignalInfo{heartbeat, "heartbeat", true, false, "", "master's cycle counter"},
    ValveSignalInfo{watchdog, "watchdog", true, false, "ms", "time-out; 0 = off", 0, 3.6e6},
    ValveSignalInfo{watchdog_source, "watchdog_source", true, false, "",
                    "0 any request, 1 changed heartbeat, 2 any write, 3 a written command", 0, 3},
    ValveSignalInfo{reaction, "reaction", true, false, "",
                    "of the watchdog: 0 neutral, 1 hold, 2 float, 3 loss_position", 0, 3},
    ValveSignalInfo{loss_position, "loss_position", true, false, "%",
                    "set point when the watchdog trips; above 100 holds", -100, 101},
    ValveSignalInfo{dead_band_positive, "dead_band_positive", true, true, "%",
                    "travel that the smallest positive command jumps to", 0, 50},
    ValveSignalInfo{dead_band_negative, "dead_band_negative", true, true, "%",
                    "travel that the smallest negative command jumps to", 0, 50},
    ValveSignalInfo{ramp_up, "ramp_up", true, true, "ms", "neutral to 100 %", 0, 3.6e6},
    ValveSignalInfo{ramp_down, "ramp_down", true, true, "ms", "100 % to neutral", 0, 3.6e6},
    ValveSignalInfo{gain, "gain", true, true, "%", "command times gain", 0, 200},
    ValveSignalInfo{polarity, "polarity", true, true, "", "1, or -1 to exchange the ports", -1, 1},
    ValveSignalInfo{current_start, "current_start", true, false, "mA", "at the least opening", 0,
                    65535},
    ValveSignalInfo{current_full, "current_full", true, false, "mA", "at 100 % opening", 0, 65535},
    ValveSignalInfo{dither_amplitude, "dither_amplitude", true, false, "mA", "0 = none", 0, 500},
    ValveSignalInfo{dither_frequency, "dither_frequency", true, false, "Hz", "", 20, 400},
    ValveSignalInfo{stored, "stored", true, false, "", "kept and read back, without effect"},
    ValveSignalInfo{ready, "ready", false, false, "", "no fault"},
    ValveSignalInfo{enabled, "enabled", false, false, "", "outputs follow commands"},
    ValveSignalInfo{section_enabled, "section_enabled", false, true, "",
                    "the section's output follows its command"},
    ValveSignalInfo{fault, "fault", false, false, "", "a fault is latched"},
    ValveSignalInfo{watchdog_tripped, "watchdog_tripped", false, false, "", ""},
    ValveSignalInfo{at_limit, "at_limit", false, false, "", "an output at its limit"},
    ValveSignalInfo{fault_code, "fault_code", false, false, "", "0 none, 1 .. 8"},
    ValveSignalInfo{fault_section, "fault_section", false, false, "", "from 1; 0: all"},
    ValveSignalInfo{heartbeat_echo, "heartbeat_echo", false, false, "", "last heartbeat written"},
    ValveSignalInfo{missed_cycles, "missed_cycles", false, false, "", "skipped heartbeat steps"},
    ValveSignalInfo{measurement_count, "measurement_count", false, false, "", "wraps"},
    ValveSignalInfo{set_point, "set_point", false, true, "%", "after ramp, gain, jump, polarity"},
    ValveSignalInfo{spool_position, "spool_position", false, true, "%", "measured"},
    ValveSignalInfo{coil_current, "coil_current", false, true, "mA", "with dither"},
    ValveSignalInfo{coil_temperature, "coil_temperature", false, true, "degC", ""},
    ValveSignalInfo{port_a_pressure, "port_a_pressure", false, true, "bar", ""},
    ValveSignalInfo{port_b_pressure, "port_b_pressure", false, true, "bar", ""},
    ValveSignalInfo{supply_pressure, "supply_pressure", false, false, "bar", "pump"},
    ValveSignalInfo{tank_pressure, "tank_pressure", false, false, "bar", "return line"},
    ValveSignalInfo{oil_temperature, "oil_temperature", false, false, "degC", ""},
    ValveSignalInfo{swing_angle, "swing_angle", false, false, "deg", "left positive"},
    ValveSignalInfo{swing_rate, "swing_rate", false, false, "deg/s", "left positive"},
    ValveSignalInfo{supply_voltage, "supply_voltage", false, false, "V", "electrical"},
    ValveSignalInfo{driver_temperature, "driver_temperature", false, false, "degC", ""},
    ValveSignalInfo{constant, "constant", false, false, "", "always the initial value"},
    ValveSignalInfo{bits, "bits", false, false, "", "made of bits, each a signal"},
    ValveSignalInfo{ValveSignal::text, "text", false, false, "", "characters, two per register"},
};
static_assert(std::ranges::is_sorted(kSignals, {}, &ValveSignalInfo::signal));
static_assert(kSignals.size() == static_cast<std::size_t>(ValveSignal::text) + 1);

struct UnitFactor {
  std::string_view of;
  std::string_view unit;
  double factor;
};
constexpr std::array kUnits{UnitFactor{"%", "1", 100.0},
                            UnitFactor{"mA", "A", 1000.0},
                            UnitFactor{"ms", "s", 1000.0},
                            UnitFactor{"bar", "Pa", 1e-5},
                            UnitFactor{"bar", "kPa", 1e-2},
                            UnitFactor{"bar", "MPa", 10.0},
                            UnitFactor{"bar", "psi", 0.0689475729},
                            UnitFactor{"V", "mV", 1e-3},
                            UnitFactor{"Hz", "kHz", 1000.0},
                            UnitFactor{"deg", "rad", kDegreesPerRadian},
                            UnitFactor{"deg/s", "rad/s", kDegreesPerRadian}};

}  // namespace

std::span<const ValveSignalInfo> valve_signals() {
  return kSignals;
}

const ValveSignalInfo& info(ValveSignal signal) {
  return kSignals[static_cast<std::size_t>(signal)];
}

std::optional<ValveSignal> find_valve_signal(std::string_view name) {
  const auto found = std::ranges::find(kSignals, name, &ValveSignalInfo::name);
  return found == kSignals.end() ? std::nullopt : std::optional(found->signal);
}

std::optional<double> unit_factor(ValveSignal signal, std::string_view unit) {
  const std::string_view own = info(signal).unit;
  if (unit.empty() || unit == own || own.empty()) {
    return 1.0;
  }
  for (const UnitFactor& row : kUnits) {
    if (row.of == own && row.unit == unit) {
      return row.factor;
    }
  }
  return std::nullopt;
}

}  // namespace rigwire::emulators
