#include "sim/driveline/hydrostatic_drive.h"

#include <algorithm>
#include <cmath>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;
using fields::plain;

namespace {

// First-order lag towards a constant over h, exactly.
double lag(double value, double target, double h, double time_constant_s) {
  return time_constant_s > 0.0 ? target + (value - target) * std::exp(-h / time_constant_s)
                               : target;
}

}  // namespace

void visit(fields::Visitor& v, HydrostaticDriveParameters& p) {
  v.number("motor_displacement", p.motor_displacement_m3prad, in("m3/rad").between(1e-9, 1),
           "Oil that each motor takes per angle of its drum.");
  v.number("pump_displacement", p.pump_displacement_m3prad, in("m3/rad").between(1e-9, 1),
           "Oil that the pump gives per angle of the engine, at full swash.");
  v.number("oil_volume", p.oil_volume_m3, in("l").between(1e-4, 1e5), "Oil under pressure.");
  v.number("bulk_modulus", p.bulk_modulus_pa, in("MPa").between(1, 1e8),
           "Bulk modulus of oil and hoses.");
  v.number("leakage", p.leakage_m3pspa, in("m3/s/Pa").between(0, 1),
           "Leakage of pump and motors per pressure.");
  v.number("relief_pressure", p.relief_pressure_pa, in("MPa").between(0.001, 1000),
           "Relief pressure between the lines.");
  v.number("charge_pressure", p.charge_pressure_pa, in("MPa").between(0, 1000),
           "Pressure of the low side.");
  v.number("motor_friction", p.motor_friction_nmsprad, in("N m s/rad").between(0, 1e9),
           "Viscous friction of each motor at its drum.");
  v.number("ramp", p.ramp_mps2, in("m/s2").between(0.001, 1000), "Ramp of the travel set point.");
  v.number("swash_time_constant", p.swash_time_constant_s, in("ms").between(0, 1e6),
           "Lag of the pump's swash plate.");
  v.number("speed_max", p.speed_max_mps, in("km/h").between(0.1, 500),
           "Greatest speed, both ways.");
  v.number("engine_idle", p.engine_idle_radps, in("rpm").between(0.1, 1e5),
           "Governor's least speed.");
  v.number("engine_rated", p.engine_rated_radps, in("rpm").between(0.1, 1e5),
           "Governor's greatest speed.");
  v.number("engine_torque", p.engine_torque_nm, in("N m").between(0.01, 1e8),
           "Engine's greatest torque.");
  v.number("engine_drag", p.engine_drag_nm, in("N m").between(0, 1e8),
           "Engine's own friction, beside its torque; reported only.");
  v.number("engine_inertia", p.engine_inertia_kgm2, in("kg m2").between(1e-6, 1e9),
           "Inertia of crank and flywheel; reported only.");
  v.number("engine_droop", p.engine_droop, plain().between(0, 0.5),
           "Share of the engine's speed lost at greatest torque.");
  v.number("engine_time_constant", p.engine_time_constant_s, in("ms").between(0, 1e6),
           "Lag of the engine's governor.");
  v.boolean("flow_divider", p.flow_divider, "Always closed: both drums get half of the flow.");
  v.boolean("bypass", p.bypass, "Towing valves open: drums turn freely.");
}

void validate(const HydrostaticDriveParameters& p) {
  fields::check(p);
  fields::require(p.engine_rated_radps >= p.engine_idle_radps, "engine_rated",
                  in("rpm").print(p.engine_rated_radps),
                  "at least engine_idle, " + in("rpm").print(p.engine_idle_radps));
}

HydrostaticDrive::HydrostaticDrive(const HydrostaticDriveParameters& parameters, double radius_m)
    : parameters_(parameters),
      radius_m_(radius_m),
      engine_speed_radps_(parameters.engine_idle_radps),
      limit_pa_(parameters.bypass ? 0.0 : parameters.relief_pressure_pa),
      divided_(parameters.flow_divider) {
  validate(parameters);
}

void HydrostaticDrive::begin(double h) {
  const HydrostaticDriveParameters& p = parameters_;
  const double wanted = std::clamp(demand_.travel_speed_mps, -p.speed_max_mps, p.speed_max_mps);
  const double away = wanted - set_point_mps_;
  const double ramp_s = std::min(h, std::abs(away) / p.ramp_mps2);
  // Over the step: the ramp's mean while it lasts, then its end.
  const double after = std::abs(away) <= p.ramp_mps2 * h
                           ? wanted
                           : set_point_mps_ + std::copysign(p.ramp_mps2 * h, away);
  mean_set_point_mps_ = after - (after - set_point_mps_) * 0.5 * ramp_s / h;
  set_point_mps_ = after;

  // Droop: the governed speed falls by droop x load share; then the engine's lag.
  const double governor = runs() ? governor_radps() : 0.0;
  const double load = std::clamp(pump_torque_nm() / p.engine_torque_nm, -1.0, 1.0) * p.engine_droop;
  engine_speed_radps_ =
      lag(engine_speed_radps_, governor * (1.0 - load), h, p.engine_time_constant_s);

  swash_ = lag(swash_, asked_swash(), h, p.swash_time_constant_s);
  connect();

  // Torque limit: displacement times pressure is at most the engine's torque. The flow's slope
  // against pressure goes into the solve, where it acts as a leak.
  const double pressure = pressure_pa();
  const double full = p.pump_displacement_m3prad * swash_ * pressure;
  limited_swash_ = swash_;
  double slope = 0.0;
  const double limit_nm = torque_limit_nm();
  if (full > limit_nm) {
    limited_swash_ = swash_ * limit_nm / full;
    slope = engine_speed_radps_ * p.pump_displacement_m3prad * limited_swash_ / pressure;
  }
  pump_flow_m3ps_ = engine_speed_radps_ * p.pump_displacement_m3prad * limited_swash_;

  const double share = divided_ ? 0.5 : 1.0;
  const double capacity = share * p.oil_volume_m3 / p.bulk_modulus_pa;
  for (std::size_t i = 0; i < circuits(); ++i) {
    HydrostaticCircuit& circuit = circuits_[i];
    const double flow = share * (pump_flow_m3ps_ + slope * pressure);
    // C dp/dt = Q - leak p - D w by backward Euler: p = offset - gain (D w at the step's end).
    const double scale = 1.0 / (1.0 + h * share * (p.leakage_m3pspa + slope) / capacity);
    circuit.law.offset = (pressure_pa_[i] + h * flow / capacity) * scale;
    circuit.law.gain = h / capacity * scale;
    circuit.displacement_m3prad = {divided_ && i == 1 ? 0.0 : p.motor_displacement_m3prad,
                                   divided_ && i == 0 ? 0.0 : p.motor_displacement_m3prad};
    if (p.bypass) {
      circuit.law = {};
    }
  }
}

double HydrostaticDrive::torque_limit_nm() const {
  const HydrostaticDriveParameters& p = parameters_;
  // A share of what the cylinders give at most, less what the engine takes itself.
  return defects_.torque_share < 1.0
             ? std::max(0.0, defects_.torque_share * (p.engine_torque_nm + p.engine_drag_nm) -
                                 p.engine_drag_nm)
             : p.engine_torque_nm;
}

double HydrostaticDrive::governor_radps() const {
  return std::clamp(demand_.engine_speed_radps, parameters_.engine_idle_radps,
                    parameters_.engine_rated_radps);
}

// The lever asks for a displacement: flow follows the engine's droop. An engine that still runs
// down from a higher speed gets less of it.
double HydrostaticDrive::asked_swash() const {
  const HydrostaticDriveParameters& p = parameters_;
  // Flow that moves both drums' surface at the set point, 2 D v / R, over the pump's full flow.
  const double asked_flow = 2.0 * p.motor_displacement_m3prad * set_point_mps_ / radius_m_;
  const double asked =
      asked_flow / (std::max(governor_radps(), engine_speed_radps_) * p.pump_displacement_m3prad);
  return std::clamp(asked, -1.0, 1.0);
}

void HydrostaticDrive::connect() {
  if (demand_.flow_divider != divided_ && !parameters_.flow_divider) {
    divided_ = demand_.flow_divider;
    if (!divided_) {
      pressure_pa_.fill(0.5 * (pressure_pa_[0] + pressure_pa_[1]));
    }
  }
}

void HydrostaticDrive::finish(const std::array<double, 2>& pressures_pa) {
  pressure_pa_ = {pressures_pa[0], divided_ ? pressures_pa[1] : pressures_pa[0]};
}

double HydrostaticDrive::pressure_pa() const {
  return 0.5 * (pressure_pa_[0] + pressure_pa_[1]);
}

double HydrostaticDrive::gauge_pressure_pa() const {
  return parameters_.charge_pressure_pa +
         std::max(std::abs(pressure_pa_[0]), std::abs(pressure_pa_[1]));
}

double HydrostaticDrive::pump_torque_nm() const {
  return parameters_.pump_displacement_m3prad * limited_swash_ * pressure_pa();
}

EngineData HydrostaticDrive::engine_data() const {
  const HydrostaticDriveParameters& p = parameters_;
  EngineData data;
  for (std::size_t i = 0; i < EngineData::kPoints; ++i) {
    const double way = static_cast<double>(i) / (EngineData::kPoints - 1);
    // Full load is reached with the droop.
    const double last_radps = p.engine_rated_radps * (1.0 - p.engine_droop);
    data.full_load[i] = {p.engine_idle_radps + way * (last_radps - p.engine_idle_radps),
                         p.engine_torque_nm, p.engine_drag_nm};
  }
  data.high_idle_radps = p.engine_rated_radps;
  data.reference_torque_nm = p.engine_torque_nm + p.engine_drag_nm;
  const double droop_radps = p.engine_droop * p.engine_rated_radps;
  data.governor_nmsprad = droop_radps > 0.0 ? p.engine_torque_nm / droop_radps : kNotMeasured;
  data.inertia_kgm2 = p.engine_inertia_kgm2;
  return data;
}

EngineSample HydrostaticDrive::engine_sample() const {
  EngineSample sample;
  sample.speed_radps = engine_speed_radps_;
  sample.torque_nm = pump_torque_nm();
  sample.friction_nm = engine_speed_radps_ > 0.0 ? parameters_.engine_drag_nm : 0.0;
  sample.full_load_nm = parameters_.engine_torque_nm;
  sample.desired_radps = runs() ? governor_radps() : 0.0;
  return sample;
}

double HydrostaticDrive::engine_torque_share() const {
  return std::clamp(pump_torque_nm() / parameters_.engine_torque_nm, -1.0, 1.0);
}

}  // namespace rigwire::sim
