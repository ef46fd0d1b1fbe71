// One wheel's forces for schemes that step its bristles among their own unknowns.
#include <algorithm>
#include <cmath>

#include "sim/vehicle/wheel_terms.h"

namespace rigwire::sim {
namespace {

/// Adds the force of a bristle with the speed u, and returns its deflection's rate. `share`: of the
/// force that its deflection and speed ask for, below 1 where a limit holds it.
double add_bristle(const VelocityRow& row, const BristleLaw& law, double z, double u, double share,
                   std::size_t bristle, StageForces& forces) {
  const double trial = -(law.stiffness * z + law.damping * u);
  const bool limited = share < 1.0;
  forces.add({row, share * trial, share * law.stiffness, share * law.damping, law.renewal,
              limited ? DeflectionOf::limited : DeflectionOf::bristle, bristle});
  return limited ? 0.0 : u - law.renewal * z;
}

double share_within(double trial, double limit) {
  return std::abs(trial) > limit ? limit / std::abs(trial) : 1.0;
}

}  // namespace

void WheelTerms::stage(const WheelFrame& frame, const Eigen::Matrix3d& R_WB,
                       const std::optional<WheelContact>& contact, const SoilParameters& soil,
                       double pressure_pa, double brake_limit_nm, const Velocities& velocities,
                       const Deflections& at, StageForces& forces, Deflections& rates) {
  const std::size_t first = kWheelBristles * wheel_;
  sliding_ = false;  // begin() is to scale nothing.
  const Eigen::Vector3d& axis = frame.axis;
  for (std::size_t i = 0; i < 3; ++i) {
    spin_.value[i + 3] = axis[static_cast<Eigen::Index>(i)];
  }
  spin_.value[6] = axis.dot(frame.rate_by_s[0]);
  spin_.value[7] = axis.dot(frame.rate_by_s[1]);
  spin_.value[8] = 1.0;
  tyre_.set_deflections({at[first], at[first + 1], at[first + 2], spin_.of(velocities)});
  begin(0.0, frame, R_WB, contact, soil, pressure_pa, brake_limit_nm, velocities);

  if (brake_limit_nm > 0.0) {
    // Brake: a bristle in the rate against the carrier, at most the brake's torque.
    VelocityRow row;
    row.axle = spin_.axle;
    row.wheel = wheel_;
    row.value[8] = 1.0;
    const BristleLaw law = bristle_law(brake_bristle_, 0.0);
    const double rate = velocities[kWheelVelocity + wheel_];
    const double trial = -(law.stiffness * at[first + 3] + law.damping * rate);
    const double share = share_within(trial, brake_limit_nm);
    brake_held_ = share < 1.0;
    brake_nm_ = share * trial;
    rates[first + 3] = add_bristle(row, law, at[first + 3], rate, share, first + 3, forces);
  }
  if (!laws_.touching) {
    return;
  }
  // Normal force k d + c d' at this state; unilateral.
  const double load = laws_.normal.at(normal_.of(velocities));
  lifted_ = load < 0.0;
  if (lifted_) {
    return;
  }
  forces.add({normal_, load, laws_.vertical_stiffness_npm, laws_.normal.gain, 0.0,
              DeflectionOf::place, 0});
  // Friction circle: both bristles' trial force scaled by one share where it is beyond the limit.
  const BristleLaw along = bristle_law(laws_.along, laws_.rolling_speed_mps);
  const BristleLaw across = bristle_law(laws_.across, laws_.rolling_speed_mps);
  const double u_along = along_.of(velocities);
  const double u_across = across_.of(velocities);
  const double trial_along = -(along.stiffness * at[first] + along.damping * u_along);
  const double trial_across = -(across.stiffness * at[first + 1] + across.damping * u_across);
  const double trial = std::sqrt(trial_along * trial_along + trial_across * trial_across);
  const double share = share_within(trial, laws_.limit_n(load));
  sliding_ = share < 1.0;
  along_n_ = share * trial_along;
  across_n_ = share * trial_across;
  rates[first] = add_bristle(along_, along, at[first], u_along, share, first, forces);
  rates[first + 1] =
      add_bristle(across_, across, at[first + 1], u_across, share, first + 1, forces);

  const double rate = spin_.of(velocities);
  // Rolling resistance: a bristle in the absolute rate, at most f r N.
  const BristleLaw turning = bristle_law(laws_.turning, 0.0);
  const double trial_nm = -(turning.stiffness * at[first + 2] + turning.damping * rate);
  const double turning_share = share_within(trial_nm, laws_.rolling_arm_m * load);
  rolling_held_ = turning_share < 1.0;
  rolling_nm_ = turning_share * trial_nm;
  rates[first + 2] =
      add_bristle(spin_, turning, at[first + 2], rate, turning_share, first + 2, forces);
}

void WheelTerms::read_deflections(Deflections& at) const {
  const std::size_t first = kWheelBristles * wheel_;
  const TyreDeflections tyre = tyre_.deflections();
  at[first] = tyre.along_m;
  at[first + 1] = tyre.across_m;
  at[first + 2] = tyre.turning_rad;
  at[first + 3] = brake_.deflection();
}

void WheelTerms::keep_deflections(const Deflections& at, const Velocities& velocities,
                                  WheelState& state) {
  const std::size_t first = kWheelBristles * wheel_;
  tyre_.set_deflections({at[first], at[first + 1], at[first + 2], spin_.of(velocities)});
  const double rate = velocities[kWheelVelocity + wheel_];
  state = {};
  state.rate_radps = rate;
  state.radius_m = laws_.touching ? laws_.rolling_radius_m : tyre_.parameters().unloaded_radius_m;
  if (brake_limit_nm_ > 0.0) {
    state.brake_nm = brake_nm_;
    brake_.set_deflection(at[first + 3]);
    if (brake_held_) {
      brake_.yield(brake_bristle_, brake_nm_);
    }
  }
  if (!laws_.touching) {
    tyre_.set_deflections({});
    return;
  }
  TyreResult result;
  result.longitudinal_slide_mps = along_.of(velocities);
  result.lateral_slide_mps = across_.of(velocities);
  result.wheel_rate_radps = spin_.of(velocities);
  result.slipping = sliding_ || lifted_;
  result.rolling_limited = rolling_held_ || lifted_;
  if (!lifted_) {
    state.load_n = std::max(0.0, laws_.normal.at(normal_.of(velocities)));
    result.longitudinal_n = along_n_;
    result.lateral_n = across_n_;
    result.rolling_nm = rolling_nm_;
  }
  laws_.turning_yields = false;  // Said by rolling_limited.
  tyre_.settle(0.0, laws_, result);
  state.touching = !lifted_;
  state.longitudinal_n = result.longitudinal_n;
  state.lateral_n = result.lateral_n;
  state.rolling_nm = result.rolling_nm;
  state.slide_mps = std::sqrt(result.longitudinal_slide_mps * result.longitudinal_slide_mps +
                              result.lateral_slide_mps * result.lateral_slide_mps);
  state.friction = friction_;
  state.sinkage_m = laws_.sinkage_m;
  state.slipping = sliding_;
}

}  // namespace rigwire::sim
