// A proportional valve's coil behind a current-regulated output: current, dither, temperature.
//
// The output switches the supply on and off (PWM, well above the coil's own time constant, so that
// only the mean counts) until the wanted current flows; falling current runs down through the
// free-wheeling diode, whose drop is left out. With U the supply, R(T) = R20 (1 + a (T - 20 degC))
// the copper's resistance and tau = L / R:
//
//   rising    i(t) = min(i_set, U/R + (i0 - U/R) exp(-t / tau))
//   falling   i(t) = max(i_set, i0 exp(-t / tau))
//
// so that the mean current ends at min(i_set, U / R(T)). The coil's temperature is a first-order
// lag towards surroundings + R_th i^2 R, exact for a current that does not change; between two
// calls of drive() the current at the interval's end counts for all of it.
//
// Dither is a sine on the set current. Its amplitude is what the voltage that is left allows: at
// most (U - i R) / (2 pi f L), and no more than the mean current itself. It is computed for the
// instant asked for and integrates nowhere, so that no step has to resolve it.
//
// Source: the RL circuit; copper's coefficient IEC 60228 (0.00393 / K at 20 degC). Resistance,
// inductance and thermal values are estimates for a 24 V pilot solenoid, not a maker's data.
#pragma once

#include "fields/rules.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

struct ValveCoilParameters {
  double resistance_ohm = 21.0;            ///< At 20 degC, 0.5 .. 500.
  double inductance_h = 0.2;               ///< 0 .. 10; 0: the current is there at once.
  double thermal_resistance_kpw = 4.0;     ///< Coil to oil, 0 .. 100.
  double thermal_time_constant_s = 600.0;  ///< 1 .. 1e5.

  friend bool operator==(const ValveCoilParameters&, const ValveCoilParameters&) = default;
};

void visit(fields::Visitor& v, ValveCoilParameters& p);

struct ValveDither {
  double amplitude_ma = 0.0;    ///< 0 = none, up to 500.
  double frequency_hz = 130.0;  ///< 20 .. 400.

  friend bool operator==(const ValveDither&, const ValveDither&) = default;
};

/// What a coil is connected to.
struct CoilDrive {
  double set_ma = 0.0;
  double supply_v = 0.0;
  bool open = false;     ///< No current flows.
  bool shorted = false;  ///< Seen by the output: kShortResistance_ohm, no inductance.
  double surroundings_c = 20.0;
};

class ValveCoil {
 public:
  static constexpr double kShortResistance_ohm = 0.2;
  static constexpr double kCopperPerKelvin = 0.00393;

  explicit ValveCoil(const ValveCoilParameters& parameters) : parameters_(parameters) {}

  /// Sets what drives the coil from `now` on. Times must not decrease.
  void drive(SimTime now, const CoilDrive& drive);
  /// Returns the current without dither. `now` is not before the last drive().
  [[nodiscard]] double current_ma(SimTime now) const;
  /// Return the present amplitude of the dither, and its momentary value.
  [[nodiscard]] double dither_amplitude_ma(SimTime now, const ValveDither& dither) const;
  [[nodiscard]] double dither_ma(SimTime now, const ValveDither& dither) const;
  /// Returns the steady-state maximum current at the present supply voltage: U / R(T); 0 if the
  /// coil is open.
  [[nodiscard]] double greatest_ma() const;
  [[nodiscard]] double temperature_c() const { return temperature_c_; }
  [[nodiscard]] double resistance_ohm() const;

 private:
  [[nodiscard]] double circuit_ohm() const;

  ValveCoilParameters parameters_;
  CoilDrive drive_;
  SimTime since_{};
  double start_ma_ = 0.0;  ///< At `since_`.
  double temperature_c_ = 20.0;
  bool settled_ = false;  ///< The temperature has begun at the surroundings'.
};

/// First-order temperature: after `span` in surroundings with a constant power.
[[nodiscard]] double warmed_c(double temperature_c, double surroundings_c, double power_w,
                              double resistance_kpw, double time_constant_s, Duration span);

}  // namespace rigwire::emulators
