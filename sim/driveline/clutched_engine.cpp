#include "sim/driveline/clutched_engine.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {

ClutchedEngine::ClutchedEngine(const EngineParameters& engine, const ClutchParameters& clutch)
    : engine_(engine),
      clutch_(clutch),
      speed_radps_(engine.idle_radps),
      condition_(engine.condition) {}

/// Clutch capacity's share 0 .. 1, linear between open and full engagement speed.
double ClutchedEngine::law(double speed_radps) const {
  return std::clamp((speed_radps - clutch_.open_radps) / (clutch_.full_radps - clutch_.open_radps),
                    0.0, 1.0);
}

double ClutchedEngine::capacity_at(double engine_radps, double input_radps) const {
  const double speed = clutch_.centrifugal ? engine_radps : std::max(engine_radps, input_radps);
  return capacity_share_ * clutch_.capacity_nm * law(speed);
}

void ClutchedEngine::begin(double h, const EngineDemand& demand, double capacity_share,
                           bool coupled, double input_radps) {
  engine_.advance(h, speed_radps_, demand);
  torque_ = engine_.torque(speed_radps_);
  capacity_share_ = capacity_share;
  if (coupled != coupled_) {
    mode_ = Mode::slip;
  }
  coupled_ = coupled;
  input_radps_ = input_radps;
  limited_ = false;
  calls_ = 0;
  if (coupled_ && mode_ == Mode::stick && capacity_share_ > 0.0) {
    set_stick(h);
  } else {
    set_slip(h, speed_radps_ >= input_radps_ ? 1.0 : -1.0);
  }
}

void ClutchedEngine::set_stick(double h) {
  mode_ = Mode::stick;
  const double inertia = inertia_kgm2();
  // Engine and input shaft as one: T - d (w' - w) - J (w' - w) / h about the input's speed.
  const double lead = input_radps_ - speed_radps_;
  equations_ = {torque_.torque_nm - (torque_.damping_nmsprad + inertia / h) * lead,
                torque_.damping_nmsprad, inertia};
}

void ClutchedEngine::set_slip(double h, double direction) {
  mode_ = Mode::slip;
  direction_ = direction;
  const double inertia_h = inertia_kgm2() / h;
  double clutch_nm = 0.0;
  // Twice at most: once more when the engine's own torque runs into a limit.
  for (int pass = 0; pass < 2; ++pass) {
    const double left = inertia_h + torque_.damping_nmsprad;
    if (coupled_ && direction > 0.0) {
      const double full_nm = capacity_share_ * clutch_.capacity_nm;
      const double slope = full_nm / (clutch_.full_radps - clutch_.open_radps);
      // The law at the end of the step, on its ramp: slope (w' - open) with
      // left (w' - w) = torque - slope (w' - open).
      const double ramp =
          (torque_.torque_nm + left * (speed_radps_ - clutch_.open_radps)) / (left + slope) * slope;
      // Beyond the ramp full capacity, but never so much as to pull the engine below open_radps.
      const double stall = torque_.torque_nm + left * (speed_radps_ - clutch_.open_radps);
      clutch_nm = std::clamp(ramp, 0.0, std::max(0.0, std::min(full_nm, stall)));
    } else if (coupled_) {
      clutch_nm = -capacity_at(speed_radps_, input_radps_);
    }
    // Backward Euler of the slipping engine: (J / h + d) (w' - w) = T - T_clutch.
    next_radps_ = speed_radps_ + (torque_.torque_nm - clutch_nm) / left;
    if (!hold_engine_limits(next_radps_)) {
      break;
    }
  }
  next_radps_ = std::max(0.0, next_radps_);
  equations_ = {clutch_nm, 0.0, 0.0};
}

/// Whether the linearised torque at `next_radps` lies outside the engine's limits; it is the limit
/// then, without slope. Once per step.
bool ClutchedEngine::hold_engine_limits(double next_radps) {
  if (limited_ || torque_.damping_nmsprad <= 0.0) {
    return false;
  }
  const double wanted = torque_.torque_nm - torque_.damping_nmsprad * (next_radps - speed_radps_);
  const double tolerance = 1e-9 * (1.0 + engine_.reference_torque_nm());
  const double greatest =
      std::max(torque_.greatest_nm, engine_.torque(std::max(0.0, next_radps)).greatest_nm);
  const double least = std::min(torque_.least_nm, -engine_.friction_nm(next_radps));
  if (wanted <= greatest + tolerance && wanted >= least - tolerance) {
    return false;
  }
  limited_ = true;
  torque_.torque_nm = std::clamp(wanted, least, greatest);
  torque_.damping_nmsprad = 0.0;
  return true;
}

bool ClutchedEngine::accept(double h, double input_radps) {
  ++calls_;
  if (!coupled_ || calls_ >= 4 || !std::isfinite(input_radps)) {
    return true;
  }
  if (mode_ == Mode::slip) {
    const double slip = direction_ * (next_radps_ - input_radps);
    if (slip >= -1e-9 * (1.0 + std::abs(input_radps)) || capacity_share_ <= 0.0) {
      return true;
    }
    // The direction has turned over within the step. Where the other direction has no capacity
    // either (an open clutch), nothing holds.
    if (capacity_at(next_radps_, input_radps) <= 0.0) {
      return true;
    }
    set_stick(h);
    return false;
  }
  // Sticking holds while the torque through the clutch is within its capacity (clamp last).
  const double change = input_radps - input_radps_;
  const double clutch_nm =
      equations_.torque_nm - (equations_.damping_nmsprad + equations_.inertia_kgm2 / h) * change;
  if (std::abs(clutch_nm) > capacity_at(input_radps, input_radps)) {
    set_slip(h, clutch_nm > 0.0 ? 1.0 : -1.0);
    return false;
  }
  if (hold_engine_limits(input_radps)) {
    set_stick(h);
    return false;
  }
  return true;
}

void ClutchedEngine::finish(double h, double input_radps) {
  if (!std::isfinite(input_radps)) {
    return;
  }
  const double next = std::max(0.0, mode_ == Mode::stick && coupled_ ? input_radps : next_radps_);
  clutch_torque_nm_ =
      equations_.torque_nm -
      (equations_.damping_nmsprad + equations_.inertia_kgm2 / h) * (input_radps - input_radps_);
  if (!coupled_) {
    clutch_torque_nm_ = 0.0;
  }
  torque_nm_ = torque_.torque_nm - torque_.damping_nmsprad * (next - speed_radps_);
  // Work and heat at the step's mean speeds: with them the energy balance closes to rounding.
  const double mean = 0.5 * (speed_radps_ + next);
  work_j_ += h * torque_nm_ * mean;
  clutch_heat_j_ += h * clutch_torque_nm_ * (mean - 0.5 * (input_radps_ + input_radps));
  capacity_nm_ = coupled_ ? capacity_at(next, input_radps) : 0.0;
  speed_radps_ = next;
  const double indicated_nm = torque_nm_ + engine_.friction_nm(next);
  const double most_nm = engine_.full_load_nm(next) + engine_.friction_nm(next);
  condition_.step(h, next, indicated_nm, indicated_nm / most_nm);
}

EngineSample ClutchedEngine::sample() const {
  EngineSample sample;
  sample.speed_radps = speed_radps_;
  sample.torque_nm = torque_nm_;
  sample.friction_nm = speed_radps_ > 0.0 ? engine_.friction_nm(speed_radps_) : 0.0;
  sample.full_load_nm = engine_.full_load_nm(speed_radps_);
  const EngineDemand& demand = engine_.demand();
  sample.desired_radps = !demand.fuel                             ? 0.0
                         : demand.control == EngineControl::speed ? demand.speed_radps
                                                                  : engine_.parameters().idle_radps;
  condition_.read(sample);
  return sample;
}

void ClutchedEngine::follow(double input_radps) {
  if (sticks() && input_radps >= 0.0) {
    speed_radps_ = input_radps;
  }
}

}  // namespace rigwire::sim
