// How an engine is doing beside its torque: temperatures, pressures, fuel, battery. For whatever
// engine is computed elsewhere; nothing acts back on its torque.
//
// Fuel      indicated power over a constant indicated efficiency (Willans' line without its curve),
//           by the heating value of diesel, 35.8 MJ/l.
// Coolant   one heat capacity that takes a share of the fuel's power and gives heat to the air
//           through a thermal resistance; the thermostat moves it between closed and open, linear
//           in temperature: C dT/dt = share P - (T - T_air) / R(T), by backward Euler.
// Oil       above the coolant by `oil_rise` times the load, behind a first-order lag. Its pressure
//           is a gear pump's behind a relief valve: in proportion to speed up to relief_speed.
// Battery   charging voltage while the alternator turns, else the voltage at rest; the alternator
//           carries the consumers, or the battery does.
// Breaks    where temperature acts on friction, viscosity or torque: it does not here.
#pragma once

#include "fields/rules.h"
#include "sim/samples/engine_sample.h"

namespace rigwire::sim {

/// Defaults: diesel of 5 litres and 170 kW in a truck of 24 V; estimates, sources in
/// docs/machines/drive-lines.md.
struct EngineConditionParameters {
  double tank_m3 = 0.160;
  double fuel_level = 0.8;  ///< When the run begins, 0 .. 1.
  double indicated_efficiency = 0.44;
  double coolant_share = 0.25;        ///< Share of the fuel's power that heats the coolant.
  double water_equivalent_kg = 70.0;  ///< Water with the heat capacity of engine and coolant.
  double closed_kpw = 0.02;           ///< Thermal resistance to the air, thermostat closed.
  double open_kpw = 5.0e-4;
  double thermostat_opens_c = 83.0;
  double thermostat_open_c = 95.0;
  double initial_c = 85.0;  ///< Initial temperature of coolant and oil: warmed up.
  double air_c = 20.0;
  double oil_rise_k = 20.0;
  double oil_lag_s = 120.0;
  double oil_relief_pa = 4.0e5;
  double oil_relief_radps = rpm(1200);
  double fuel_pressure_pa = 5.0e5;
  double coolant_level = 1.0;
  double oil_level = 0.9;
  double charging_v = 28.2;
  double rest_v = 25.2;
  double consumers_a = 20.0;
  double alternator_radps = rpm(500);  ///< Below it does not charge.

  friend bool operator==(const EngineConditionParameters&,
                         const EngineConditionParameters&) = default;
};
void visit(fields::Visitor& v, EngineConditionParameters& p);
/// Throws std::invalid_argument.
void validate(const EngineConditionParameters& parameters);

class EngineCondition {
 public:
  explicit EngineCondition(const EngineConditionParameters& parameters);

  /// Moves on by h seconds with the engine at that speed; `indicated_nm` is torque and friction
  /// together, `load_share` 0 .. 1 of what it could be.
  void step(double h, double speed_radps, double indicated_nm, double load_share);
  /// Fills all members that are neither speeds nor torques.
  void read(EngineSample& sample) const;

 private:
  EngineConditionParameters parameters_;
  double speed_radps_ = 0.0;
  double coolant_c_;
  double oil_c_;
  double fuel_rate_m3ps_ = 0.0;
  double fuel_used_m3_ = 0.0;
};

}  // namespace rigwire::sim
