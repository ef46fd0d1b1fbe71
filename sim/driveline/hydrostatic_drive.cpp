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
  v.number("motor_displacement", p.motor_displacement_m3prad, in("m3/rad").above(0),
           "Oil that each motor takes per angle of its drum.");
  v.number("pump_displacement", p.pump_displacement_m3prad, in("m3/rad").above(0),
           "Oil that the pump gives per angle of the engine, at full swash.");
  v.number("oil_volume", p.oil_volume_m3, in("l").above(0), "Oil under pressure.");
  v.number("bulk_modulus", p.bulk_modulus_pa, in("MPa").above(0), "Bulk modulus of oil and hoses.");
  v.number("leakage", p.leakage_m3pspa, in("m3/s/Pa").at_least(0),
           "Leakage of pump and motors per pressure.");
  v.number("relief_pressure", p.relief_pressure_pa, in("MPa").above(0),
           "Relief pressure between the lines.");
  v.number("charge_pressure", p.charge_pressure_pa, in("MPa").at_least(0),
           "Pressure of the low side.");
  v.number("motor_friction", p.motor_friction_nmsprad, in("N m s/rad").at_least(0),
           "Viscous friction of each motor at its drum.");
  v.number("ramp", p.ramp_mps2, in("m/s2").above(0), "Ramp of the travel set point.");
  v.number("swash_time_constant", p.swash_time_constant_s, in("ms").at_least(0),
           "Lag of the pump's swash plate.");
  v.number("speed_max", p.speed_max_mps, in("km/h").above(0), "Greatest speed, both ways.");
  v.number("engine_idle", p.engine_idle_radps, in("rpm").above(0), "Governor's least speed.");
  v.number("engine_rated", p.engine_rated_radps, in("rpm").above(0), "Governor's greatest speed.");
  v.number("engine_torque", p.engine_torque_nm, in("N m").above(0), "Engine's greatest torque.");
  v.number("engine_drag", p.engine_drag_nm, in("N m").at_least(0),
           "Engine's own friction, beside its torque; reported only.");
  v.number("engine_inertia", p.engine_inertia_kgm2, in("kg m2").above(0),
           "Inertia of crank and flywheel; reported only.");
  v.number("engine_droop", p.engine_droop, plain().between(0, 0.5),
           "Share of the engine's speed lost at greatest torque.");
  v.number("engine_time_constant", p.engine_time_constant_s, in("ms").at_least(0),
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
  const auto [after, mean] = ramp(h);
  mean_set_point_mps_ = mean;
  set_point_mps_ = after;

  // Droop: the governed speed falls by droop x load share; then the engine's lag.
  const double governor = demand_.ignition ? governor_radps() : 0.0;
  const double load = std::clamp(pump_torque_nm() / p.engine_torque_nm, -1.0, 1.0) * p.engine_droop;
  engine_speed_radps_ =
      lag(engine_speed_radps_, governor * (1.0 - load), h, p.engine_time_constant_s);

  swash_ =
      lag(swash_, asked_swash(set_point_mps_, engine_speed_radps_), h, p.swash_time_constant_s);
  connect();

  // Torque limit: displacement times pressure is at most the engine's torque. The flow's slope
  // against pressure goes into the solve, where it acts as a leak.
  const double pressure = pressure_pa();
  const double full = p.pump_displacement_m3prad * swash_ * pressure;
  limited_swash_ = swash_;
  double slope = 0.0;
  if (full > p.engine_torque_nm) {
    limited_swash_ = swash_ * p.engine_torque_nm / full;
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
    circuit.displacement_m3prad = displacement_m3prad(i);
    if (p.bypass) {
      circuit.law = {};
    }
  }
}

std::array<double, 2> HydrostaticDrive::ramp(double after_s) const {
  const HydrostaticDriveParameters& p = parameters_;
  const double wanted = std::clamp(demand_.travel_speed_mps, -p.speed_max_mps, p.speed_max_mps);
  const double away = wanted - set_point_mps_;
  const double ramp_s = std::min(after_s, std::abs(away) / p.ramp_mps2);
  // Over the step: the ramp's mean while it lasts, then its end.
  const double after = std::abs(away) <= p.ramp_mps2 * after_s
                           ? wanted
                           : set_point_mps_ + std::copysign(p.ramp_mps2 * after_s, away);
  const double mean =
      after_s > 0.0 ? after - (after - set_point_mps_) * 0.5 * ramp_s / after_s : after;
  return {after, mean};
}

double HydrostaticDrive::governor_radps() const {
  return std::clamp(demand_.engine_speed_radps, parameters_.engine_idle_radps,
                    parameters_.engine_rated_radps);
}

// The lever asks for a displacement: flow follows the engine's droop. An engine that still runs
// down from a higher speed gets less of it.
double HydrostaticDrive::asked_swash(double set_point_mps, double engine_radps) const {
  const HydrostaticDriveParameters& p = parameters_;
  // Flow that moves both drums' surface at the set point, 2 D v / R, over the pump's full flow.
  const double asked_flow = 2.0 * p.motor_displacement_m3prad * set_point_mps / radius_m_;
  const double asked =
      asked_flow / (std::max(governor_radps(), engine_radps) * p.pump_displacement_m3prad);
  return std::clamp(asked, -1.0, 1.0);
}

double HydrostaticDrive::allowed_swash(double swash, double pressure_pa) const {
  // Hyperbola of constant torque, D alpha p <= T_max.
  const double full = parameters_.pump_displacement_m3prad * swash * pressure_pa;
  return full > parameters_.engine_torque_nm ? swash * parameters_.engine_torque_nm / full : swash;
}

void HydrostaticDrive::connect() {
  if (demand_.flow_divider != divided_ && !parameters_.flow_divider) {
    divided_ = demand_.flow_divider;
    if (!divided_) {
      pressure_pa_.fill(0.5 * (pressure_pa_[0] + pressure_pa_[1]));
    }
  }
}

HydrostaticState HydrostaticDrive::state() const {
  return {pressure_pa_, engine_speed_radps_, swash_};
}

double HydrostaticDrive::capacity_m3ppa() const {
  return (divided_ ? 0.5 : 1.0) * parameters_.oil_volume_m3 / parameters_.bulk_modulus_pa;
}

std::array<double, 2> HydrostaticDrive::displacement_m3prad(std::size_t circuit) const {
  return {divided_ && circuit == 1 ? 0.0 : parameters_.motor_displacement_m3prad,
          divided_ && circuit == 0 ? 0.0 : parameters_.motor_displacement_m3prad};
}

HydrostaticDrive::Present HydrostaticDrive::present(const HydrostaticState& state,
                                                    double after_s) const {
  const HydrostaticDriveParameters& p = parameters_;
  Present at;
  at.pressure_pa = 0.5 * (state.pressure_pa[0] + state.pressure_pa[1]);
  const double asked = asked_swash(ramp(after_s)[0], state.engine_speed_radps);
  at.swash = p.swash_time_constant_s > 0.0 ? state.swash : asked;
  at.asked_swash = asked;
  at.limited_swash = allowed_swash(at.swash, at.pressure_pa);
  // Pump torque D alpha p, the engine's droop under it, flow w D alpha.
  const double torque = p.pump_displacement_m3prad * at.limited_swash * at.pressure_pa;
  const double load = std::clamp(torque / p.engine_torque_nm, -1.0, 1.0) * p.engine_droop;
  at.governed_radps = demand_.ignition ? governor_radps() * (1.0 - load) : 0.0;
  at.engine_radps = p.engine_time_constant_s > 0.0 ? state.engine_speed_radps : at.governed_radps;
  at.flow_m3ps = at.engine_radps * p.pump_displacement_m3prad * at.limited_swash;
  return at;
}

HydrostaticState HydrostaticDrive::rates(const HydrostaticState& state, double after_s,
                                         const std::array<double, 2>& drum_radps) const {
  const HydrostaticDriveParameters& p = parameters_;
  const Present at = present(state, after_s);
  HydrostaticState rate;
  if (p.engine_time_constant_s > 0.0) {
    rate.engine_speed_radps =
        (at.governed_radps - state.engine_speed_radps) / p.engine_time_constant_s;
  }
  if (p.swash_time_constant_s > 0.0) {
    rate.swash = (at.asked_swash - state.swash) / p.swash_time_constant_s;
  }
  if (p.bypass) {
    return rate;
  }
  const double share = divided_ ? 0.5 : 1.0;
  for (std::size_t i = 0; i < circuits(); ++i) {
    const std::array<double, 2> d = displacement_m3prad(i);
    // Continuity of each circuit: C dp/dt = Q_pump - k_leak p - sum(D_i w_i).
    rate.pressure_pa[i] = (share * (at.flow_m3ps - p.leakage_m3pspa * state.pressure_pa[i]) -
                           d[0] * drum_radps[0] - d[1] * drum_radps[1]) /
                          capacity_m3ppa();
  }
  if (!divided_) {
    rate.pressure_pa[1] = rate.pressure_pa[0];
  }
  return rate;
}

HydrostaticSlopes HydrostaticDrive::slopes(const HydrostaticState& state) const {
  const HydrostaticDriveParameters& p = parameters_;
  const Present at = present(state, 0.0);
  const bool limited = at.limited_swash != at.swash;
  // Along the hyperbola Q = w T_max / p falls with p as a leak of Q / p does.
  const double slope = limited ? std::abs(at.flow_m3ps / at.pressure_pa) : 0.0;
  const double scale = (divided_ ? 0.5 : 1.0) / capacity_m3ppa();
  return {scale * (p.leakage_m3pspa + slope), scale * p.pump_displacement_m3prad * at.limited_swash,
          limited ? 0.0 : scale * p.pump_displacement_m3prad * at.engine_radps};
}

void HydrostaticDrive::advance(double h, const HydrostaticState& found) {
  const Present at = present(found, h);
  const auto [after, mean] = ramp(h);
  set_point_mps_ = after;
  mean_set_point_mps_ = mean;
  engine_speed_radps_ = at.engine_radps;
  swash_ = at.swash;
  limited_swash_ = at.limited_swash;
  pump_flow_m3ps_ = at.flow_m3ps;
  finish({std::clamp(found.pressure_pa[0], -limit_pa_, limit_pa_),
          std::clamp(found.pressure_pa[1], -limit_pa_, limit_pa_)});
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
  sample.desired_radps = demand_.ignition ? governor_radps() : 0.0;
  return sample;
}

double HydrostaticDrive::engine_torque_share() const {
  return std::clamp(pump_torque_nm() / parameters_.engine_torque_nm, -1.0, 1.0);
}

}  // namespace rigwire::sim
