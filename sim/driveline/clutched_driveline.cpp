#include "sim/driveline/clutched_driveline.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

WheelVector shares_of(AxleDrive drive) {
  return drive == AxleDrive::centre_differential ? WheelVector(0.25, 0.25, 0.25, 0.25)
                                                 : WheelVector(0.0, 0.0, 0.5, 0.5);
}

}  // namespace

ClutchedDriveline::ClutchedDriveline(const EngineParameters& engine, const ClutchParameters& clutch,
                                     const AxleParameters& axles)
    : axles_(axles),
      shares_(shares_of(axles.drive)),
      share_matrix_(shares_ * shares_.transpose()),
      engine_(engine, clutch),
      reference_torque_nm_(sim::engine_data(engine).reference_torque_nm),
      locks_(axles) {
  make_equations();
}

void ClutchedDriveline::command(const VehicleCommand& command) {
  const double share = command_.engine_torque_share;
  const double speed = command_.engine_speed_radps;
  command_ = command;
  command_.engine_torque_share = std::isfinite(command.engine_torque_share)
                                     ? std::clamp(command.engine_torque_share, 0.0, 1.0)
                                     : share;
  command_.engine_speed_radps =
      std::isfinite(command.engine_speed_radps)
          ? std::clamp(command.engine_speed_radps, 0.0, engine_.engine().parameters().cut_off_radps)
          : speed;
  locks_.request(command.lock);
  request(command_);
}

EngineDemand ClutchedDriveline::driver_demand() const {
  const EngineParameters& p = engine_.engine().parameters();
  return {command_.engine_control, command_.engine_torque_share,
          std::clamp(command_.engine_speed_radps, p.idle_radps, p.maximum_radps), 1.0,
          command_.ignition};
}

void ClutchedDriveline::begin(double h, double wheel_inertia_kgm2, WheelVector& rates) {
  if (!(h > 0.0)) {
    return;
  }
  const double axle = axles_.ratio();
  // Inertia seen by the wheels, i^2 J s s^T: output shaft, and the engine while the clutch sticks.
  double reflected = axles_.output_inertia_kgm2 * axle * axle;
  if (engine_.sticks()) {
    reflected += engine_.inertia_kgm2() * overall_ratio() * overall_ratio();
  }
  const WheelMatrix inertia =
      WheelMatrix::Identity() * wheel_inertia_kgm2 + reflected * share_matrix_;
  const WheelVector before = rates;
  if (locks_.advance(h, inertia, rates)) {
    // Plastic impact: the kinetic energy that engaging locks take.
    lock_heat_j_ += 0.5 * (before.dot(inertia * before) - rates.dot(inertia * rates));
    engine_.follow(transmission_.ratio * output_radps(rates));
  }

  output_radps_ = output_radps(rates);
  advance(h, output_radps_, transmission_);
  limit(transmission_.demand);
  engine_.begin(h, transmission_.demand, transmission_.capacity_share, transmission_.ratio != 0.0,
                transmission_.ratio * output_radps_);
  make_equations();
}

void ClutchedDriveline::limit(EngineDemand& demand) const {
  demand.fuel = demand.fuel && defects_.fuel;
  if (defects_.torque_share < 1.0) {
    demand.limit_share =
        std::min(demand.limit_share, limit_share(engine_.engine(), reference_torque_nm_,
                                                 defects_.torque_share, engine_.speed_radps()));
  }
}

void ClutchedDriveline::make_equations() {
  const double axle = axles_.ratio();
  const double ratio = overall_ratio();
  const ShaftEquations& shaft = engine_.equations();
  const double drag = axles_.output_drag_nmsprad;
  // Equal powers across the ratio i with shares s: torque i T s, inertia and damping i^2 s s^T.
  equations_.inertia =
      (axles_.output_inertia_kgm2 * axle * axle + shaft.inertia_kgm2 * ratio * ratio) *
      share_matrix_;
  equations_.damping = (drag * axle * axle + shaft.damping_nmsprad * ratio * ratio) * share_matrix_;
  equations_.torque_nm = (shaft.torque_nm * ratio - drag * axle * output_radps_) * shares_;
  equations_.basis = locks_.basis();
  equations_.coordinates = locks_.coordinates();
}

bool ClutchedDriveline::accept(double h, const WheelVector& rates) {
  if (!(h > 0.0) || engine_.accept(h, transmission_.ratio * output_radps(rates))) {
    return true;
  }
  make_equations();
  return false;
}

void ClutchedDriveline::finish(double h, const WheelVector& rates) {
  if (!(h > 0.0) || !rates.allFinite()) {
    return;
  }
  const double output = output_radps(rates);
  engine_.finish(h, transmission_.ratio * output);
  // Drag at the end's speed times the step's mean speed: closes the energy balance of the step.
  drag_heat_j_ += h * axles_.output_drag_nmsprad * output * 0.5 * (output + output_radps_);
  output_radps_ = output;
}

void ClutchedDriveline::read(VehicleSample& sample) const {
  const double engine = engine_.speed_radps();
  const bool coupled = transmission_.ratio != 0.0;
  const double input = coupled ? transmission_.ratio * output_radps_ : engine;
  sample.engine = engine_.sample();
  sample.gear = transmission_.gear;
  sample.gear_requested = command_.gear;
  sample.crawler_group = transmission_.crawler_group;
  sample.gear_ratio = transmission_.ratio;
  sample.shifting = transmission_.shifting;
  sample.driveline_engaged = engine_.sticks();
  sample.input_shaft_radps = input;
  sample.output_shaft_radps = output_radps_;
  // Slip: |engine - input| over the faster of the two.
  sample.clutch_slip_share =
      std::clamp(std::abs(engine - input) / std::max({engine, std::abs(input), 1e-3}), 0.0, 1.0);
  sample.lock = locks_.engaged();
}

EngineData ClutchedDriveline::engine_data() const {
  return sim::engine_data(engine_.engine().parameters());
}

DriveState ClutchedDriveline::state() const {
  const Engine& engine = engine_.engine();
  const double axle = axles_.ratio();
  const double ratio = overall_ratio();
  const EngineTorque limits = engine.torque(engine_.speed_radps());
  DriveState state;
  state.gear = transmission_.gear;
  state.shifting = transmission_.shifting;
  state.rate_radps = output_radps_ / axle;
  state.ratio = ratio;
  state.torque_nm = engine_.clutch_torque_nm() * ratio;
  // Reflected to the wheels, i^2 J.
  state.inertia_kgm2 = axles_.output_inertia_kgm2 * axle * axle +
                       (engine_.sticks() ? engine_.inertia_kgm2() * ratio * ratio : 0.0);
  state.engine_radps = engine_.speed_radps();
  state.maximum_radps = engine.parameters().maximum_radps;
  state.least_nm = limits.least_nm;
  state.greatest_nm = limits.greatest_nm;
  state.governor_nmsprad = engine.parameters().governor_nmsprad;
  return state;
}

DrivelineEnergy ClutchedDriveline::energy() const {
  return {engine_.work_j(), engine_.clutch_heat_j(), drag_heat_j_, lock_heat_j_};
}

}  // namespace rigwire::sim
