#include "sim/excavator/power_unit.h"

#include <algorithm>
#include <cmath>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;
using fields::plain;

namespace {

/// The pump controller leaves the engine this much of its torque to speed up with.
constexpr double kReserve = 0.03;
/// Below this speed loads are taken as at it: p Q / w must not grow without bound.
constexpr double kLeastSpeed_radps = 30.0;

}  // namespace

EngineParameters excavator_engine() {
  EngineParameters engine;
  engine.full_load = {{rpm(800), 420},  {rpm(1000), 540}, {rpm(1200), 630}, {rpm(1400), 660},
                      {rpm(1600), 650}, {rpm(1800), 605}, {rpm(2000), 549}};
  engine.inertia_kgm2 = 1.8;  // with the pumps
  engine.drag_nm = 45.0;
  engine.drag_nmsprad = 0.25;
  engine.idle_radps = rpm(900);
  engine.maximum_radps = rpm(2050);
  engine.cut_off_radps = rpm(2250);
  engine.governor_nmsprad = 60.0;
  engine.governor_integral_s = 0.5;
  engine.condition.tank_m3 = 0.300;
  return engine;
}

void visit(fields::Visitor& v, PowerUnitParameters& p) {
  v.section("engine", p.engine, "Torque curve, friction and governor.");
  v.number("set_speed", p.set_radps, in("rpm").between(0.1, 1e5),
           "Speed under full load, of the dial.");
  v.number("droop", p.droop, plain().between(0, 0.2),
           "Share by which the engine turns faster without load.");
  v.number("ramp", p.ramp_radps2, in("rad/s2").between(0.001, 1e6),
           "How fast the governed speed follows the dial.");
  v.number("auxiliary_torque", p.auxiliary_nm, in("N m").between(0, 500),
           "What fan, alternator and pilot pump take.");
  v.number("pump_rated_speed", p.pump_rated_radps, in("rpm").between(0.1, 1e5),
           "Speed from which on the pumps give their whole flow.");
  v.number("stroke_back", p.stroke_back, plain().between(0, 0.5),
           "Share of the pumps' flow that they move without being asked.");
}

void validate(const PowerUnitParameters& p) {
  fields::check(p);
  validate(p.engine);
  const auto rpm = [](double radps) { return fields::in("rpm").print(radps); };
  fields::require(p.set_radps >= p.engine.idle_radps && p.set_radps <= p.engine.maximum_radps,
                  "set_speed", rpm(p.set_radps),
                  rpm(p.engine.idle_radps) + " .. " + rpm(p.engine.maximum_radps) +
                      ", from idle to maximum of its engine");
}

PowerUnit::PowerUnit(const PowerUnitParameters& parameters, const SupplyParameters& supply)
    : parameters_(parameters),
      supply_(supply),
      limited_(supply),
      engine_(parameters.engine),
      reference_torque_nm_(engine_data().reference_torque_nm),
      condition_(parameters.engine.condition),
      governed_radps_(parameters.set_radps),
      speed_radps_(parameters.set_radps * (1.0 + parameters.droop)),
      full_load_nm_(engine_.full_load_nm(speed_radps_)) {
  limit();
}

void PowerUnit::command(const PowerUnitCommand& command) {
  if (!command.speed_radps) {
    command_.speed_radps.reset();
  } else if (std::isfinite(*command.speed_radps)) {
    command_.speed_radps = std::clamp(*command.speed_radps, parameters_.engine.idle_radps,
                                      parameters_.engine.maximum_radps);
  }
  if (std::isfinite(command.torque_limit_share)) {
    command_.torque_limit_share = std::clamp(command.torque_limit_share, 0.0, 1.0);
  }
}

double PowerUnit::limit_share() const {
  if (!defects_.fuel) {
    return 0.0;
  }
  const double share = std::min(command_.torque_limit_share, defects_.torque_share);
  return sim::limit_share(engine_, reference_torque_nm_, share, speed_radps_);
}

void PowerUnit::limit() {
  const double speed_radps = std::max(speed_radps_, kLeastSpeed_radps);
  // A pump's flow is displacement times speed, cut back above the rated one.
  limited_.pump_flow_m3ps = defects_.flow_share * supply_.pump_flow_m3ps *
                            std::min(1.0, speed_radps_ / parameters_.pump_rated_radps);
  // Load limiting: what is left of full load at this speed.
  const double left_nm =
      (1.0 - kReserve) * (limit_share() * full_load_nm_) - parameters_.auxiliary_nm;
  limited_.power_limit_w = std::clamp(left_nm * speed_radps, 1.0, supply_.power_limit_w);
}

void PowerUnit::step(double h, double flow_m3ps, double supply_pressure_pa) {
  const PowerUnitParameters& p = parameters_;
  // Set speed, at a limited rate.
  const double wanted = command_.speed_radps.value_or(p.set_radps);
  governed_radps_ += std::clamp(wanted - governed_radps_, -h * p.ramp_radps2, h * p.ramp_radps2);

  // Pumps: the flow that the valves take, at most what the pumps can deliver, at least what the
  // swash plates leave; T = p Q / (eta w).
  const double power_flow_m3ps =
      supply_pressure_pa > 0.0 ? limited_.power_limit_w * supply_.efficiency / supply_pressure_pa
                               : limited_.pump_flow_m3ps;
  pump_flow_m3ps_ = std::max(std::min({flow_m3ps, limited_.pump_flow_m3ps, power_flow_m3ps}),
                             p.stroke_back * limited_.pump_flow_m3ps);
  const double speed_radps = std::max(speed_radps_, kLeastSpeed_radps);
  pump_torque_nm_ = supply_pressure_pa * pump_flow_m3ps_ / (supply_.efficiency * speed_radps);
  const double load_nm = pump_torque_nm_ + (speed_radps_ > 0.0 ? p.auxiliary_nm : 0.0);

  // Droop: the governor's aim falls with the share of the reference torque that it gives.
  const double share = std::clamp(torque_nm_ / engine_.reference_torque_nm(), 0.0, 1.0);
  EngineDemand demand;
  demand.control = EngineControl::speed;
  demand.speed_radps = governed_radps_ * (1.0 + p.droop * (1.0 - share));
  demand.limit_share = limit_share();
  demand.fuel = defects_.fuel;
  engine_.advance(h, speed_radps_, demand);

  // J (w' - w) / h = T - c (w' - w) - T_load, T cut to its limits.
  const EngineTorque at = engine_.torque(speed_radps_);
  const double inertia = p.engine.inertia_kgm2;
  double change = h * (at.torque_nm - load_nm) / (inertia + h * at.damping_nmsprad);
  torque_nm_ = std::clamp(at.torque_nm - at.damping_nmsprad * change, at.least_nm, at.greatest_nm);
  change = h * (torque_nm_ - load_nm) / inertia;
  const double next = std::max(0.0, speed_radps_ + change);
  engine_work_j_ += h * torque_nm_ * 0.5 * (speed_radps_ + next);
  load_work_j_ += h * load_nm * 0.5 * (speed_radps_ + next);
  speed_radps_ = next;
  full_load_nm_ = engine_.full_load_nm(next);
  const double friction_nm = engine_.friction_nm(next);
  const double indicated_nm = torque_nm_ + friction_nm;
  condition_.step(h, next, indicated_nm, indicated_nm / (full_load_nm_ + friction_nm));
  limit();
}

PowerUnitSample PowerUnit::sample() const {
  const EngineParameters& engine = parameters_.engine;
  PowerUnitSample sample;
  sample.engine.speed_radps = speed_radps_;
  sample.engine.torque_nm = torque_nm_;
  sample.engine.friction_nm = speed_radps_ > 0.0 ? engine_.friction_nm(speed_radps_) : 0.0;
  sample.engine.full_load_nm = full_load_nm_;
  sample.engine.desired_radps = governed_radps_;
  condition_.read(sample.engine);
  sample.dial_radps = parameters_.set_radps;
  sample.dial_share =
      (parameters_.set_radps - engine.idle_radps) / (engine.maximum_radps - engine.idle_radps);
  sample.pump_flow_m3ps = pump_flow_m3ps_;
  sample.pump_torque_nm = pump_torque_nm_;
  return sample;
}

}  // namespace rigwire::sim
