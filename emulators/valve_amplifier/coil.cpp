#include "emulators/valve_amplifier/coil.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fields/visitor.h"

namespace rigwire::emulators {
namespace {

constexpr double kMilli = 1e-3;
constexpr double kReference_c = 20.0;
constexpr double kGreatestShort_ma = 60e3;  // what a current sensor of such a stage can show

}  // namespace

using fields::in;

void visit(fields::Visitor& v, ValveCoilParameters& p) {
  v.number("resistance", p.resistance_ohm, in("ohm").between(0.5, 500),
           "Resistance of the winding at 20 degC.");
  v.number("inductance", p.inductance_h, in("H").between(0, 10),
           "Inductance of the winding; 0 = the current is there at once.");
  v.number("thermal_resistance", p.thermal_resistance_kpw, in("K/W").between(0, 100),
           "Warming of the winding over the oil per watt.");
  v.number("thermal_time_constant", p.thermal_time_constant_s, in("s").between(1, 1e5),
           "How slowly the winding warms and cools.");
}

double warmed_c(double temperature_c, double surroundings_c, double power_w, double resistance_kpw,
                double time_constant_s, Duration span) {
  // First-order lag towards surroundings + R_th P, exact for a constant power.
  const double end_c = surroundings_c + resistance_kpw * power_w;
  return end_c + (temperature_c - end_c) * std::exp(-to_seconds(span) / time_constant_s);
}

double ValveCoil::resistance_ohm() const {
  // R(T) = R20 (1 + a (T - 20 degC)), IEC 60228; never below a tenth.
  return parameters_.resistance_ohm *
         std::max(0.1, 1.0 + kCopperPerKelvin * (temperature_c_ - kReference_c));
}

double ValveCoil::circuit_ohm() const {
  return drive_.shorted ? kShortResistance_ohm : resistance_ohm();
}

double ValveCoil::greatest_ma() const {
  if (drive_.open) {
    return 0.0;
  }
  return std::min(kGreatestShort_ma, drive_.supply_v / circuit_ohm() / kMilli);
}

void ValveCoil::drive(SimTime now, const CoilDrive& drive) {
  const double current_now_ma = current_ma(now);
  if (!settled_) {
    temperature_c_ = drive.surroundings_c;
    settled_ = true;
  }
  const double heating_a = drive_.shorted ? 0.0 : current_now_ma * kMilli;
  temperature_c_ = warmed_c(
      temperature_c_, drive_.surroundings_c, heating_a * heating_a * resistance_ohm(),
      parameters_.thermal_resistance_kpw, parameters_.thermal_time_constant_s, now - since_);
  start_ma_ = drive.open ? 0.0 : current_now_ma;
  drive_ = drive;
  since_ = now;
}

double ValveCoil::current_ma(SimTime now) const {
  if (drive_.open) {
    return 0.0;
  }
  if (drive_.shorted) {
    return drive_.set_ma > 0.0 ? greatest_ma() : 0.0;
  }
  const double resistance = resistance_ohm();
  const bool driven = drive_.set_ma >= start_ma_;
  // RL circuit, tau = L / R: towards U / R while driven, towards 0 through the diode.
  const double asymptote_ma = driven ? drive_.supply_v / resistance / kMilli : 0.0;
  const double rate_per_s =
      parameters_.inductance_h > 0.0 ? resistance / parameters_.inductance_h : 1e12;
  const double curve_ma =
      asymptote_ma + (start_ma_ - asymptote_ma) * std::exp(-to_seconds(now - since_) * rate_per_s);
  return driven ? std::min(drive_.set_ma, curve_ma) : std::max(drive_.set_ma, curve_ma);
}

double ValveCoil::dither_amplitude_ma(SimTime now, const ValveDither& dither) const {
  if (drive_.open || drive_.shorted || drive_.set_ma <= 0.0) {
    return 0.0;
  }
  const double current = current_ma(now);
  // Dither that the voltage left can drive through the reactance: (U - i R) / (2 pi f L).
  const double left_v = drive_.supply_v - current * kMilli * resistance_ohm();
  const double reactance_ohm =
      2.0 * std::numbers::pi * dither.frequency_hz * parameters_.inductance_h;
  const double possible_ma = reactance_ohm > 0.0 ? left_v / reactance_ohm / kMilli : 1e9;
  return std::clamp(std::min(possible_ma, current), 0.0, dither.amplitude_ma);
}

double ValveCoil::dither_ma(SimTime now, const ValveDither& dither) const {
  return dither_amplitude_ma(now, dither) *
         std::sin(2.0 * std::numbers::pi * std::fmod(dither.frequency_hz * to_seconds(now), 1.0));
}

}  // namespace rigwire::emulators
