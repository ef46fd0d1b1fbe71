// The excavator's power unit: a diesel engine whose governor droops a little under load, and the
// pumps on its shaft.
//
//   J dw/dt = T(w) - T_pumps - T_auxiliary
//   T(w)      full-load curve and friction (sim/driveline/engine.h); the governor works towards
//             w_set + droop w_rated (1 - T/T_ref), so that w_set is the speed at full torque
//   T_pumps   p Q / (efficiency w): pressure and flow that the valves take, and at least what the
//             pumps' swash plates leave
// The governed speed follows a change of w_set at `ramp`. Speed is stepped by backward Euler in the
// governor's linear law, so that no step is too long for it; the energy that is missing from
// J w^2 / 2 + work is of second order in the step.
//
// Feedback to the hydraulics: the pumps turn with the engine; their flow is full from `pump_rated`
// on and proportional below. The pump controller limits the pumps' power to what the engine has at
// its present speed, so that they do not stall it. At the default speed neither limits before
// SupplyParameters' own limits do: the arm moves as it would without an engine.
//
// Defaults: a four-cylinder diesel of 115 kW at 2000 rpm, as 18 t machines have; estimates
// (docs/machines/excavator.md). Temperatures, oil, fuel and battery are sim/engine's. Not modelled:
// starting, emissions, turbo lag, the hydraulic oil's temperature.
#pragma once

#include "fields/rules.h"
#include "sim/driveline/engine.h"
#include "sim/engine/engine_condition.h"
#include "sim/engine/power_unit_fault.h"
#include "sim/hydraulics/parameters.h"
#include "sim/samples/power_unit_sample.h"

namespace rigwire::sim {

/// 660 Nm at 1400 rpm, 115 kW at 2000 rpm; the governor repeats its torque once in 0.5 s.
[[nodiscard]] EngineParameters excavator_engine();

struct PowerUnitParameters {
  EngineParameters engine = excavator_engine();
  double set_radps = rpm(1900);         ///< Initial speed set at the dial.
  double droop = 0.04;                  ///< Speed without load over speed at full load, less 1.
  double ramp_radps2 = rpm(600);        ///< Rate limit of the governed speed.
  double auxiliary_nm = 30.0;           ///< Fan, alternator, pilot pump.
  double pump_rated_radps = rpm(1700);  ///< Engine speed from which the full flow is available.
  double stroke_back = 0.03;            ///< Share of the pumps' flow without any request.

  friend bool operator==(const PowerUnitParameters&, const PowerUnitParameters&) = default;
};
void visit(fields::Visitor& v, PowerUnitParameters& p);
/// Throws std::invalid_argument.
void validate(const PowerUnitParameters& parameters);

class PowerUnit {
 public:
  /// Runs at its set speed, without load.
  PowerUnit(const PowerUnitParameters& parameters, const SupplyParameters& supply);

  /// Valid until the next. A speed or share that is not a number keeps its old value; both are cut
  /// to what the engine has.
  void command(const PowerUnitCommand& command);

  /// Valid until the next.
  void fail(const PowerUnitDefects& defects) { defects_ = defects; }

  /// What the pumps can give at present: the parameters' own limits, cut to the engine's.
  [[nodiscard]] const SupplyParameters& supply() const { return limited_; }

  /// Moves on by h > 0 seconds while the valves take `flow_m3ps` (the sum of all) at that pressure.
  /// The pumps give no more than supply() says; what a valve takes beyond for an instant is the
  /// hoses' own oil.
  void step(double h, double flow_m3ps, double supply_pressure_pa);

  [[nodiscard]] double speed_radps() const { return speed_radps_; }
  /// At the crank, what the pumps and auxiliaries get and what speeds it up.
  [[nodiscard]] double torque_nm() const { return torque_nm_; }
  [[nodiscard]] double pump_torque_nm() const { return pump_torque_nm_; }
  [[nodiscard]] double pump_flow_m3ps() const { return pump_flow_m3ps_; }
  /// Work at the crank since the start, J: of the engine, of pumps and auxiliaries.
  [[nodiscard]] double engine_work_j() const { return engine_work_j_; }
  [[nodiscard]] double load_work_j() const { return load_work_j_; }
  /// Everything but the pressure at the valves.
  [[nodiscard]] PowerUnitSample sample() const;
  [[nodiscard]] EngineData engine_data() const { return sim::engine_data(parameters_.engine); }

 private:
  /// The limit, commanded or by a defect, as a share of full load at the present speed.
  [[nodiscard]] double limit_share() const;
  void limit();

  PowerUnitParameters parameters_;
  SupplyParameters supply_;
  SupplyParameters limited_;
  Engine engine_;
  double reference_torque_nm_;  ///< Indicated, of its data sheet.
  EngineCondition condition_;
  PowerUnitCommand command_;
  PowerUnitDefects defects_;
  double governed_radps_;
  double speed_radps_;
  double full_load_nm_;  ///< At speed_radps_.
  double torque_nm_ = 0.0;
  double pump_torque_nm_ = 0.0;
  double pump_flow_m3ps_ = 0.0;
  double engine_work_j_ = 0.0;
  double load_work_j_ = 0.0;
};

}  // namespace rigwire::sim
