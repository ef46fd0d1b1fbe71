// What a valve amplifier is made of, and what its master may change while it runs.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "emulators/valve_amplifier/coil.h"
#include "emulators/valve_amplifier/fault.h"
#include "fields/rules.h"
#include "sim/samples/time.h"
#include "sim/samples/valve_sample.h"

namespace rigwire::emulators {

/// Parameters of the output stage of one section, as fractions.
struct ValveStageParameters {
  double dead_band_positive = 0.0;  ///< 0 .. 0.5 of spool travel.
  double dead_band_negative = 0.0;  ///< 0 .. 0.5 of spool travel.
  Duration ramp_up{0};              ///< Neutral to full command; 0 = at once.
  Duration ramp_down{0};            ///< Full command to neutral; 0 = at once.
  double gain = 1.0;                ///< 0 .. 2.
  double polarity = 1.0;            ///< 1 or -1.

  friend bool operator==(const ValveStageParameters&, const ValveStageParameters&) = default;
};

/// What the outputs do when the watchdog trips.
enum class ValveReaction : std::uint16_t {
  neutral = 0,
  hold = 1,
  floating = 2,
  position = 3,  ///< To ValveAmplifierParameters::loss_position, at once.
};

/// What the master may change.
struct ValveAmplifierParameters {
  Duration watchdog = std::chrono::milliseconds(200);  ///< 0 = off, 1 ms .. 1 h.
  ValveReaction reaction = ValveReaction::neutral;
  double loss_position = 0.0;       ///< -1 .. 1, of every section.
  double current_start_ma = 250.0;  ///< At the minimum opening.
  double current_full_ma = 750.0;   ///< At 100 % opening.
  ValveDither dither;
  std::array<ValveStageParameters, kValveSections> stage{};

  friend bool operator==(const ValveAmplifierParameters&,
                         const ValveAmplifierParameters&) = default;
};

/// Whether the parameters go together: start below full current, dither no more than the start
/// current (else it reaches through zero). If not, fault 8.
[[nodiscard]] bool consistent(const ValveAmplifierParameters& parameters);

/// Supply, output stage and its own temperature.
struct ValveElectronics {
  double supply_voltage_v = 24.0;  ///< 5 .. 60.
  double under_voltage_v = 8.5;    ///< Below it for the delay: fault 4. 0 .. supply.
  Duration under_voltage_delay = std::chrono::milliseconds(100);
  double over_current_ma = 3000.0;  ///< Above it for the delay: fault 3.
  Duration over_current_delay = std::chrono::milliseconds(2);
  double open_share = 0.2;  ///< Less than this share of the set current for the delay: fault 2.
  Duration open_delay = std::chrono::milliseconds(50);
  double ambient_temperature_c = 32.0;     ///< -40 .. 150.
  double idle_power_w = 2.0;               ///< 0 .. 100.
  double output_resistance_ohm = 0.3;      ///< Per output; heats the driver. 0 .. 10.
  double thermal_resistance_kpw = 4.0;     ///< 0 .. 100.
  double thermal_time_constant_s = 300.0;  ///< 1 .. 1e5.
  double over_temperature_c = 85.0;        ///< At it: fault 7.
};

void visit(fields::Visitor& v, ValveElectronics& p);

struct ValveAmplifierSettings {
  std::vector<std::string> sections = {"swing", "boom", "stick", "bucket"};  ///< 1 .. 8 names.
  ValveAmplifierParameters parameters;                                       ///< At power-up.
  Duration ramp_cycle = std::chrono::milliseconds(1);  ///< Output steps on a ramp, 0.1 .. 100 ms.
  ValveCoilParameters coil;
  ValveElectronics electronics;
  double spool_time_constant_s = 0.03;  ///< For the dither's trace in the position, 0 .. 1.
  double spool_tolerance = 0.3;         ///< Set point to measured position, 0.01 .. 2.
  Duration spool_fault_delay = std::chrono::milliseconds(500);  ///< Off for this long; 0 = never.
  std::vector<ValveDefect> defects;
};

/// Without the watchdog and its reaction, which not every device behind the amplifier uses.
void visit(fields::Visitor& v, ValveAmplifierSettings& p);

/// Throws std::invalid_argument naming the setting, what was found and what is allowed.
void validate(const ValveAmplifierSettings& settings);
/// Throws std::invalid_argument unless the defect is of one of that many sections, or of none.
void check_section(const ValveDefect& defect, std::size_t sections);

}  // namespace rigwire::emulators
