#include "sim/vehicle/travel_control.h"

#include <algorithm>
#include <cmath>

#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;
using fields::plain;

namespace {

constexpr double kRest_mps = 0.05;      // slower than this the machine is at rest
constexpr double kHolds_mps = 0.15;     // slower than this, with set point 0, the brake is applied
constexpr double kReverses_mps = 0.10;  // faster than this the gear keeps its direction
constexpr double kLead_mps = 1.0;       // most that the ramp runs ahead of the machine
constexpr double kReserve = 1.2;        // of the brake that holds at a start on a slope
constexpr double kLeastGrip = 0.3;      // of the weight, against rolling back
constexpr double kMissing_mps = 0.1;    // this far from the ramp for kLimited_s: limited
constexpr double kLimited_s = 1.0;
constexpr double kClimbs_mps = 0.3;   // missing this much, a lower gear is tried
constexpr double kGains_mps2 = 0.05;  // getting faster by less than this is not getting faster
constexpr double kHeldBack = 0.5;     // of the ramp is missing: held back, after ...
constexpr double kHeldBack_s = 1.0;
constexpr double kPush_ps = 0.15;  // of the weight that the push grows by in a second, ...
constexpr double kMostPush = 1.0;  // ... and may be
constexpr double kLetsGo_s = 0.2;  // time constant at which the push is released
constexpr double kFast = 0.98;     // share of the engine's maximum speed
constexpr double kAcceleration_s = 0.5;
constexpr double kShift_s = 0.8;  // a shift's pause ...
constexpr double kLoss = 0.3;     // ... may take this share of the speed
constexpr double kHeld = 0.5;     // brake's share at which it holds without the engine
constexpr int kMostLowerGears = 3;

double sign(double value) {
  return value < 0.0 ? -1.0 : 1.0;
}

/// Towards `target` by at most `most`.
double approach(double value, double target, double most) {
  return std::abs(target - value) <= most ? target : value + std::copysign(most, target - value);
}

}  // namespace

void visit(fields::Visitor& v, TravelControlParameters& p) {
  v.number("acceleration", p.acceleration_mps2, in("m/s2").between(0.05, 10),
           "Ramp of the travel speed's set point, away from 0.");
  v.number("deceleration", p.deceleration_mps2, in("m/s2").between(0.05, 10),
           "Ramp of the travel speed's set point, towards 0.");
  v.number("gain", p.gain_per_s, plain().between(0.05, 10), "Acceleration per missing speed, 1/s.");
  v.number("integral", p.integral_per_s2, plain().between(0, 10),
           "Acceleration per missing way, 1/s2.");
  v.number("inclination_lag", p.inclination_lag_s, in("ms").between(0, 1e6),
           "Lag of the inclination sensor.");
  v.number("brake_rate", p.brake_rate_per_s, plain().between(0.1, 100),
           "Most that the brake's share changes, 1/s.");
}

TravelControl::TravelControl(const TravelControlParameters& parameters,
                             const TravelMachine& machine)
    : parameters_(parameters), machine_(machine) {}

void TravelControl::release() {
  active_ = false;
  limit_ = TravelLimit::none;
}

int TravelControl::choose_gear(const Driveline& driveline, const DriveState& state,
                               const VehicleCommand& command, double target_mps) {
  if (!command.automatic_gear || holding_ || target_mps == 0.0) {
    return command.automatic_gear ? state.gear : command.gear;
  }
  const int gear =
      driveline.select_gear(state.rate_radps, target_mps / machine_.radius_m, lower_gears_);
  // Uphill a shift's pause takes speed away: a higher gear would not get it back.
  const double way = sign(target_mps);
  const double lost_mps = kShift_s * machine_.gravity_mps2 * slope_ * way;
  const bool higher = state.gear * gear > 0 && std::abs(gear) > std::abs(state.gear);
  const bool loses = lost_mps > kLoss * way * state.rate_radps * machine_.radius_m;
  return higher && loses ? state.gear : gear;
}

void TravelControl::push(double h, bool held_back, double missing_mps) {
  held_back_s_ = held_back ? held_back_s_ + h : 0.0;
  const double weight_n = machine_.mass_kg * machine_.gravity_mps2;
  if (held_back_s_ >= kHeldBack_s) {
    push_n_ = std::min(push_n_ + h * kPush_ps * weight_n, kMostPush * weight_n);
  } else if (missing_mps <= 0.0) {
    push_n_ -= push_n_ * h / (h + kLetsGo_s);
  }
}

void TravelControl::judge(double h, const DriveState& state, bool all, bool all_brake,
                          double missing_mps) {
  const bool power = all && missing_mps > kMissing_mps;
  const bool braking = all_brake && missing_mps < -kMissing_mps;
  limited_s_ = power || braking ? limited_s_ + h : 0.0;
  if (limited_s_ >= kLimited_s) {
    limit_ = power ? TravelLimit::power : TravelLimit::braking;
    // Not enough in this gear: another one, and some time to show what it can.
    const bool fast = state.engine_radps > kFast * state.maximum_radps;
    if (power && missing_mps > kClimbs_mps) {
      if (fast && lower_gears_ > 0) {
        --lower_gears_;
      } else if (!fast && acceleration_mps2_ < kGains_mps2 && lower_gears_ < kMostLowerGears) {
        ++lower_gears_;
      }
      limited_s_ = 0.0;
    }
  } else if (!power && !braking && std::abs(missing_mps) < kMissing_mps) {
    limit_ = TravelLimit::none;
  }
}

void TravelControl::step(double h, const Driveline& driveline, double slope,
                         VehicleCommand& command) {
  const TravelControlParameters& p = parameters_;
  const DriveState state = driveline.state();
  const double radius_m = machine_.radius_m;
  const double speed_mps = state.rate_radps * radius_m;
  const double weight_n = machine_.mass_kg * machine_.gravity_mps2;
  const double faster_mps2 = sign(speed_mps) * (speed_mps - last_mps_) / h;
  last_mps_ = speed_mps;
  if (!active_) {
    active_ = true;
    acceleration_mps2_ = 0.0;
    holding_ = false;
    slope_ = slope;
    reference_mps_ = speed_mps;
    integral_n_ = 0.0;
    push_n_ = 0.0;
    held_back_s_ = 0.0;
    brake_share_ = command.brake_share;
    limited_s_ = 0.0;
  } else {
    acceleration_mps2_ += (faster_mps2 - acceleration_mps2_) * h / (h + kAcceleration_s);
  }
  slope_ += (slope - slope_) * h / (h + p.inclination_lag_s);
  double set_point_mps = command.parking_brake ? 0.0 : *command.travel_speed_mps;
  if (set_point_mps != set_point_mps_) {
    lower_gears_ = 0;
  }
  set_point_mps_ = set_point_mps;
  // The other direction: first to rest.
  const bool turns_back = set_point_mps * speed_mps < 0.0 && std::abs(speed_mps) > kReverses_mps;
  const double target_mps = turns_back ? 0.0 : set_point_mps;

  command.gear = choose_gear(driveline, state, command, target_mps);
  const bool fits = state.gear == command.gear && !state.shifting && state.ratio != 0.0 &&
                    (target_mps == 0.0 || state.ratio * target_mps > 0.0);

  // Ramp; it waits for a machine that cannot follow, and for the gear.
  const double before_mps = reference_mps_;
  const bool slows =
      std::abs(target_mps) < std::abs(reference_mps_) || target_mps * reference_mps_ < 0.0;
  const double ramp_mps2 = slows ? p.deceleration_mps2 : p.acceleration_mps2;
  if (fits || slows || std::abs(speed_mps) > kRest_mps) {
    reference_mps_ = approach(reference_mps_, target_mps, ramp_mps2 * h);
    reference_mps_ = std::clamp(reference_mps_, speed_mps - kLead_mps, speed_mps + kLead_mps);
  }
  const double ramp = std::clamp((reference_mps_ - before_mps) / h, -ramp_mps2, ramp_mps2);
  const double error_mps = reference_mps_ - speed_mps;

  // At rest, or already rolling the other way.
  holding_ = set_point_mps == 0.0 &&
             (holding_ || std::abs(speed_mps) < kHolds_mps || speed_mps * reference_mps_ < 0.0);
  if (holding_) {
    reference_mps_ = 0.0;
  }
  const double way = state.ratio != 0.0 ? sign(state.ratio) : sign(speed_mps);
  // Positive pushes in the direction of the gear.
  const double drive_n = way * state.torque_nm / radius_m;
  const double pull_n = way * weight_n * slope_;  // the slope's, that has to be overcome
  const double mass_kg = machine_.mass_kg + state.inertia_kgm2 / (radius_m * radius_m);
  const double force_n =
      way * (mass_kg * (ramp + p.gain_per_s * error_mps) + integral_n_) + push_n_ + pull_n;

  double share = 0.0;
  if (fits && (!holding_ || brake_share_ < kHeld)) {
    // Crank's torque through the ratio, as a share between drag and full load; below the commanded
    // limits of torque and speed.
    const double ratio = std::abs(state.ratio);
    const double wanted_nm =
        std::min(force_n * radius_m / ratio,
                 state.governor_nmsprad * (command.engine_speed_limit_radps - state.engine_radps));
    const double span_nm = std::max(1e-9, state.greatest_nm - state.least_nm);
    share =
        std::clamp((wanted_nm - state.least_nm) / span_nm, 0.0, command.engine_torque_limit_share);
  }
  const double foreign_share = command.brake_share;
  if (foreign_share > 0.0) {
    share = 0.0;
  }

  // What is to be slowed beyond what the drive line does by itself.
  double brake_n = fits ? std::max(0.0, drive_n - force_n) * (force_n < 0.0 ? 1.0 : 0.0)
                        : std::max(0.0, -sign(speed_mps) * (machine_.mass_kg *
                                                            (ramp + p.gain_per_s * error_mps)) -
                                            sign(speed_mps) * weight_n * slope_);
  const bool starts = std::abs(speed_mps) < kRest_mps && set_point_mps != 0.0;
  const bool rolls_back = target_mps * speed_mps < 0.0 && std::abs(speed_mps) > 1e-3;
  if (starts || rolls_back) {
    // On a slope the brake opens as the clutch takes over, and not before a gear fits.
    const double held_n = fits ? std::max(0.0, pull_n - std::max(0.0, drive_n))
                               : std::abs(weight_n * slope_) + kLeastGrip * weight_n;
    brake_n = std::max(brake_n, kReserve * held_n + (rolls_back ? kLeastGrip * weight_n : 0.0));
  }
  const double brake =
      holding_ || machine_.brake_n <= 0.0 ? 1.0 : std::clamp(brake_n / machine_.brake_n, 0.0, 1.0);
  brake_share_ = approach(brake_share_, brake, p.brake_rate_per_s * h);

  // The integral stops at limits, under a foreign brake, and while nothing is coupled.
  const bool all = fits && share >= command.engine_torque_limit_share;
  const bool all_brake = brake_share_ >= 1.0 && !holding_;
  const double missing_mps = way * error_mps;
  if (holding_ || turns_back || foreign_share > 0.0) {
    push_n_ = 0.0;
  }
  const bool slow =
      missing_mps > kHeldBack * std::abs(reference_mps_) && acceleration_mps2_ < kGains_mps2;
  push(h, slow && fits && !all && target_mps != 0.0 && foreign_share == 0.0, missing_mps);
  if (holding_) {
    integral_n_ = 0.0;
  } else if (fits && foreign_share == 0.0 && !(all && missing_mps > 0.0) &&
             !(all_brake && missing_mps < 0.0) && !starts) {
    integral_n_ += h * p.integral_per_s2 * machine_.mass_kg * error_mps;
    integral_n_ = std::clamp(integral_n_, -0.5 * weight_n, 0.5 * weight_n);
  }
  judge(h, state, all || (fits && state.engine_radps > command.engine_speed_limit_radps), all_brake,
        missing_mps);

  command.engine_control = EngineControl::torque;
  command.engine_torque_share = share;
  command.brake_share = std::max(foreign_share, brake_share_);
}

}  // namespace rigwire::sim
