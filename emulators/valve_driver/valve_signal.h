// The quantities of a valve amplifier that a register can carry, by name.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>

namespace rigwire::emulators {

enum class ValveSignal : std::uint8_t {
  // The master writes these (and reads back what it wrote).
  command,
  command_a,
  command_b,
  enable,
  enable_section,
  fault_reset,
  floating,
  quick_stop,
  heartbeat,
  watchdog,
  watchdog_source,
  reaction,
  loss_position,
  dead_band_positive,
  dead_band_negative,
  ramp_up,
  ramp_down,
  gain,
  polarity,
  current_start,
  current_full,
  dither_amplitude,
  dither_frequency,
  stored,
  // The amplifier says these.
  ready,
  enabled,
  section_enabled,
  fault,
  watchdog_tripped,
  at_limit,
  fault_code,
  fault_section,
  heartbeat_echo,
  missed_cycles,
  measurement_count,
  set_point,
  spool_position,
  coil_current,
  coil_temperature,
  port_a_pressure,
  port_b_pressure,
  supply_pressure,
  tank_pressure,
  oil_temperature,
  swing_angle,
  swing_rate,
  supply_voltage,
  driver_temperature,
  // The map says these.
  constant,
  bits,
  text,
};

struct ValveSignalInfo {
  ValveSignal signal;
  std::string_view name;   ///< Name in a map's file.
  bool commanded = false;  ///< Writing it has an effect.
  bool per_section = false;
  std::string_view unit;  ///< Unit of the amplifier's values; empty: a number.
  std::string_view text;
  // What the amplifier can take, in that unit; without limits it takes everything.
  double least = -std::numeric_limits<double>::infinity();
  double greatest = std::numeric_limits<double>::infinity();
};

[[nodiscard]] std::span<const ValveSignalInfo> valve_signals();
[[nodiscard]] const ValveSignalInfo& info(ValveSignal signal);
/// Nothing when there is no such signal.
[[nodiscard]] std::optional<ValveSignal> find_valve_signal(std::string_view name);

/// What moves a spool: command, and its halves.
[[nodiscard]] constexpr bool is_spool_command(ValveSignal signal) {
  return signal == ValveSignal::command || signal == ValveSignal::command_a ||
         signal == ValveSignal::command_b;
}

/// How many of the signal's own unit one of `unit` is: 1000 for A where the signal is in mA. The
/// signal's own unit and an empty one are 1; nothing when the units do not belong together.
[[nodiscard]] std::optional<double> unit_factor(ValveSignal signal, std::string_view unit);

}  // namespace rigwire::emulators
