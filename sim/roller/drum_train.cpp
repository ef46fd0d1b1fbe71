#include "sim/roller/drum_train.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

constexpr double kDampingRatio = 0.7;
constexpr double kRollingShare = 0.1;  // Share of the brake's stiffness.

int side_of(double value, double limit) {
  return value > limit ? 1 : value < -limit ? -1 : 0;
}

}  // namespace

void SpinFriction::begin(double h, double limit_nm, double rate_before_radps) {
  h_ = h;
  limit_nm_ = limit_nm;
  if (limit_nm == 0.0) {
    bristle_.reset();
    law_ = {};
    side_ = 0;
    return;
  }
  law_ = bristle_.force(parameters_, h, 0.0);
  side_ = side_of(law_.at(rate_before_radps), limit_nm);
}

bool SpinFriction::test(double rate_radps) {
  int side = side_of(law_.at(rate_radps), limit_nm_);
  if (side * side_ < 0) {
    side = 0;  // Through holding, not across it.
  }
  const bool changed = side != side_;
  side_ = side;
  return changed;
}

void SpinFriction::settle(double rate_radps) {
  torque_nm_ = law().at(rate_radps);
  if (limit_nm_ == 0.0) {
    return;
  }
  if (side_ == 0) {
    bristle_.slide(parameters_, h_, 0.0, rate_radps);
  } else {
    bristle_.slide_within(parameters_, h_, 0.0, rate_radps, std::abs(torque_nm_));
  }
}

void SpinFriction::reset() {
  bristle_.reset();
  torque_nm_ = 0.0;
}

BristleParameters held_bristle(double stiffness, double damping_ratio, double inertia) {
  return {stiffness, 2.0 * damping_ratio * std::sqrt(stiffness * inertia), 0.0};
}

std::array<BristleParameters, 2> spin_bristles(const RollerParameters& p) {
  const double inertia = p.drum.spin_inertia_kgm2;
  return {held_bristle(p.brake_stiffness_nmprad, kDampingRatio, inertia),
          held_bristle(kRollingShare * p.brake_stiffness_nmprad, kDampingRatio, inertia)};
}

DrumTrain::DrumTrain(const RollerParameters& parameters)
    : brakes_{SpinFriction(spin_bristles(parameters)[0]),
              SpinFriction(spin_bristles(parameters)[0])},
      rolling_{SpinFriction(spin_bristles(parameters)[1]),
               SpinFriction(spin_bristles(parameters)[1])} {}

void DrumTrain::begin(double h, const DrumTorqueLimits& limits, const HydrostaticDrive& drive,
                      const Eigen::Vector2d& rate_radps) {
  for (std::size_t i = 0; i < 2; ++i) {
    const double rate = rate_radps[static_cast<Eigen::Index>(i)];
    brakes_[i].begin(h, limits.brake_nm[i], rate);
    rolling_[i].begin(h, limits.rolling_nm[i], rate);
  }
  friction_nmsprad_ = drive.parameters().bypass ? 0.0 : drive.parameters().motor_friction_nmsprad;
  relief_pa_ = drive.pressure_limit_pa();
  circuits_ = drive.circuits();
  for (std::size_t i = 0; i < circuits_; ++i) {
    Pressure& pressure = pressures_[i];
    pressure.circuit = drive.circuit(i);
    pressure.displacement_m3prad = {pressure.circuit.displacement_m3prad[0],
                                    pressure.circuit.displacement_m3prad[1]};
    pressure.side =
        side_of(pressure.circuit.law.at(pressure.displacement_m3prad.dot(rate_radps)), relief_pa_);
  }
}

DrumTrain::Torques DrumTrain::torques() const {
  Torques sum;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const ImplicitForce brake = brakes_[i].law();
    const ImplicitForce rolling = rolling_[i].law();
    sum.gain(k, k) += friction_nmsprad_ + brake.gain + rolling.gain;
    sum.offset[k] += brake.offset + rolling.offset;
  }
  for (std::size_t i = 0; i < circuits_; ++i) {
    const Pressure& pressure = pressures_[i];
    const Eigen::Vector2d& d = pressure.displacement_m3prad;
    if (pressure.side == 0) {
      // Oil: torque d p with p = offset - gain (d . w); at the relief valve p is the limit.
      sum.gain += pressure.circuit.law.gain * d * d.transpose();
      sum.offset += pressure.circuit.law.offset * d;
    } else {
      sum.offset += (pressure.side * relief_pa_) * d;
    }
  }
  return sum;
}

bool DrumTrain::test(const Eigen::Vector2d& rate_radps) {
  bool changed = false;
  for (std::size_t i = 0; i < 2; ++i) {
    const double rate = rate_radps[static_cast<Eigen::Index>(i)];
    const bool brake = brakes_[i].test(rate);
    const bool rolling = rolling_[i].test(rate);
    changed = changed || brake || rolling;
  }
  for (std::size_t i = 0; i < circuits_; ++i) {
    Pressure& pressure = pressures_[i];
    // From one limit to the other it leads through being free: no jump across.
    int side =
        side_of(pressure.circuit.law.at(pressure.displacement_m3prad.dot(rate_radps)), relief_pa_);
    side = side * pressure.side < 0 ? 0 : side;
    changed = changed || side != pressure.side;
    pressure.side = side;
  }
  return changed;
}

void DrumTrain::settle(const Eigen::Vector2d& rate_radps, HydrostaticDrive& drive) {
  for (std::size_t i = 0; i < 2; ++i) {
    const double rate = rate_radps[static_cast<Eigen::Index>(i)];
    brakes_[i].settle(rate);
    rolling_[i].settle(rate);
  }
  std::array<double, 2> found_pa{};
  for (std::size_t i = 0; i < circuits_; ++i) {
    const Pressure& pressure = pressures_[i];
    found_pa[i] =
        pressure.side == 0
            ? std::clamp(pressure.circuit.law.at(pressure.displacement_m3prad.dot(rate_radps)),
                         -relief_pa_, relief_pa_)
            : pressure.side * relief_pa_;
  }
  drive.finish(found_pa);
}

void DrumTrain::preload(std::size_t drum, double torque_nm, double limit_nm) {
  brakes_[drum].preload(std::clamp(torque_nm, -limit_nm, limit_nm));
}

}  // namespace rigwire::sim
