// What the valve driver's registers read: every signal's value in its map's units and counts.
#include <algorithm>
#include <cmath>
#include <limits>

#include "emulators/valve_driver/signal_units.h"
#include "emulators/valve_driver/valve_driver.h"

namespace rigwire::emulators {
namespace {

constexpr double kPascalPerBar = 1e5;
constexpr double kDegreesPerRadian = 57.295779513082320877;

double milliseconds(Duration span) {
  return to_seconds(span) * 1e3;
}

}  // namespace

RegisterWords ValveDriver::words_of(const ValveRegister& entry, std::size_t index) const {
  if (entry.writable) {
    return image_.words(entry, index);
  }
  return encode_count(entry, count_of(entry, index));
}

double ValveDriver::count_of(const ValveRegister& entry, std::size_t index) const {
  if (entry.signal == ValveSignal::constant || entry.signal == ValveSignal::stored) {
    return entry.initial.value_or(0.0);
  }
  if (entry.signal == ValveSignal::bits) {
    std::uint32_t word = 0;
    for (const RegisterBit& bit : entry.bits) {
      const bool on = value_of(bit.signal, bit.section.value_or(0)) != 0.0;
      word |= (on != bit.inverted ? 1U : 0U) << bit.bit;
    }
    return word;
  }
  const std::size_t section = entry.section + index;
  if (info(entry.signal).per_section && section >= amplifier_.sections()) {
    return std::clamp(0.0, entry.least(), entry.greatest());
  }
  const double value = value_of(entry.signal, section);
  if (std::isnan(value)) {
    return entry.initial.value_or(0.0);  // nothing measured yet
  }
  const auto row = std::ranges::find(entry.values, value, &RegisterTranslation::value);
  if (row != entry.values.end()) {
    return row->count;
  }
  const double in_unit = value / unit_factor(entry.signal, entry.unit).value_or(1.0);
  return (in_unit - entry.offset) / entry.scale;
}

double ValveDriver::value_of(ValveSignal signal, std::size_t section) const {
  using enum ValveSignal;
  const auto bit = [](bool on) { return on ? 1.0 : 0.0; };
  switch (signal) {
    case command:
      return amplifier_.commanded(section) * kPercent;
    case command_a:
      return std::max(0.0, amplifier_.commanded(section)) * kPercent;
    case command_b:
      return std::max(0.0, -amplifier_.commanded(section)) * kPercent;
    case enable:
      return bit(map_.always_enabled);
    case enable_section:
      return bit(amplifier_.section_on(section));
    case section_enabled:
      return bit(amplifier_.section_enabled(section));
    case heartbeat:
    case heartbeat_echo:
      return heartbeat_;
    case watchdog_source:
      return static_cast<double>(feed_);
    case ready:
      return bit(amplifier_.fault() == ValveFault::none);
    case enabled:
      return bit(amplifier_.enabled());
    case fault:
      return bit(amplifier_.fault() != ValveFault::none);
    case watchdog_tripped:
      return bit(amplifier_.watchdog_tripped());
    case at_limit:
      return bit(amplifier_.at_limit());
    case fault_code:
      return static_cast<double>(amplifier_.fault());
    case fault_section:
      return amplifier_.fault_section() ? static_cast<double>(*amplifier_.fault_section() + 1)
                                        : 0.0;
    case missed_cycles:
      return missed_cycles_;
    case measurement_count:
      return static_cast<double>(amplifier_.measurements() & 0xFFFFU);
    case set_point:
      return amplifier_.set_point(section) * kPercent;
    case coil_current:
      return amplifier_.current_ma(now_, section);
    case coil_temperature:
      return amplifier_.coil_temperature_c(section);
    case supply_voltage:
      return amplifier_.supply_voltage_v();
    case driver_temperature:
      return amplifier_.driver_temperature_c();
    case floating:
      return bit(amplifier_.floating(section));
    default:
      return info(signal).commanded ? parameter_value(signal, section)
                                    : measured_value(signal, section);
  }
}

double ValveDriver::measured_value(ValveSignal signal, std::size_t section) const {
  using enum ValveSignal;
  if (amplifier_.measurements() == 0) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const ValveSample& measured = amplifier_.measured();
  switch (signal) {
    case spool_position:
      return amplifier_.position(now_, section) * kPercent;
    case port_a_pressure:
      return measured.port_a_pressure_pa[section] / kPascalPerBar;
    case port_b_pressure:
      return measured.port_b_pressure_pa[section] / kPascalPerBar;
    case supply_pressure:
      return measured.supply_pressure_pa / kPascalPerBar;
    case tank_pressure:
      return measured.tank_pressure_pa / kPascalPerBar;
    case oil_temperature:
      return measured.oil_temperature_c;
    case swing_angle:
      return measured.swing_angle_rad * kDegreesPerRadian;
    case swing_rate:
      return measured.swing_rate_radps * kDegreesPerRadian;
    default:
      return 0.0;
  }
}

double ValveDriver::parameter_value(ValveSignal signal, std::size_t section) const {
  using enum ValveSignal;
  const ValveAmplifierParameters& p = amplifier_.parameters();
  const ValveStageParameters& stage = p.stage[section];
  switch (signal) {
    case watchdog:
      return milliseconds(p.watchdog);
    case reaction:
      return static_cast<double>(p.reaction);
    case loss_position:
      return p.reaction == ValveReaction::hold ? kHold_percent + 1.0 : p.loss_position * kPercent;
    case dead_band_positive:
      return stage.dead_band_positive * kPercent;
    case dead_band_negative:
      return stage.dead_band_negative * kPercent;
    case ramp_up:
      return milliseconds(stage.ramp_up);
    case ramp_down:
      return milliseconds(stage.ramp_down);
    case gain:
      return stage.gain * kPercent;
    case polarity:
      return stage.polarity;
    case current_start:
      return p.current_start_ma;
    case current_full:
      return p.current_full_ma;
    case dither_amplitude:
      return p.dither.amplitude_ma;
    case dither_frequency:
      return p.dither.frequency_hz;
    default:
      return 0.0;
  }
}

}  // namespace rigwire::emulators
