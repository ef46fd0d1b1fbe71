#include "sim/vehicle/wheel_terms.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {

using Eigen::Vector3d;

namespace {

constexpr double kBrakeDampingRatio = 0.7;
// How far a force held at its limit may be from the limit that the solve then finds.
constexpr double kSlidingTolerance = 2e-3;
constexpr double kRollingTolerance = 5e-2;
constexpr double kTrails_mps = 0.3;      // at which half of the trail is there
constexpr double kTurnsBack_mps = 1e-3;  // slower than this a wheel keeps its way

/// std::hypot guards against overflow that cannot come here, at ten times the cost.
double length(double x, double y) {
  return std::sqrt(x * x + y * y);
}

void set(VelocityRow& row, const Vector3d& linear, const Vector3d& angular, double first,
         double second, double wheel) {
  row.value = {linear.x(),  linear.y(), linear.z(), angular.x(), angular.y(),
               angular.z(), first,      second,     wheel};
}

/// Limits a scalar force; returns whether it changed between free and held.
bool hold(double trial, double limit, double tolerance, bool& held, double& force) {
  if (std::abs(trial) <= limit) {
    const bool changed = held;
    held = false;
    return changed;
  }
  const double clamped = std::copysign(limit, trial);
  if (held && std::abs(clamped - force) <= tolerance * limit) {
    return false;
  }
  held = true;
  force = clamped;
  return true;
}

}  // namespace

WheelTerms::WheelTerms(const VehicleAxleParameters& axle, double carried_mass_kg, std::size_t wheel,
                       double brake_stiffness_nmprad)
    : tyre_(axle.tyre, carried_mass_kg),
      brake_bristle_{brake_stiffness_nmprad,
                     2.0 * kBrakeDampingRatio *
                         std::sqrt(brake_stiffness_nmprad * axle.wheel_spin_inertia_kgm2),
                     1.0},
      spin_inertia_kgm2_(axle.wheel_spin_inertia_kgm2),
      wheel_(wheel) {
  for (VelocityRow* row : {&normal_, &along_, &across_, &centre_, &spin_}) {
    row->wheel = wheel;
    row->axle = wheel / 2;
  }
}

void WheelTerms::begin(double h, const WheelFrame& frame, const Eigen::Matrix3d& R_WB,
                       const std::optional<WheelContact>& contact, const Ground& ground,
                       double pressure_pa, double brake_limit_nm, const Velocities& start) {
  const Vector3d& axis = frame.axis;
  // Row of the absolute spin: axis . (body's and carrier's rates) + rate against the axle.
  set(spin_, Vector3d::Zero(), axis, axis.dot(frame.rate_by_s[0]), axis.dot(frame.rate_by_s[1]),
      1.0);
  brake_limit_nm_ = brake_limit_nm;
  if (brake_limit_nm > 0.0) {
    brake_law_ = brake_.force(brake_bristle_, h, 0.0);
    brake_nm_ = std::copysign(brake_limit_nm, brake_nm_);
  } else {
    brake_.reset();
    brake_law_ = {};
    brake_held_ = false;
  }

  // Contact axes: forward = axis x normal, its length the sine between them; left = n x forward.
  Vector3d normal = Vector3d::UnitZ();
  Vector3d forward = Vector3d::UnitX();
  double crossing = 0.0;
  if (contact) {
    normal = R_WB.transpose() * contact->normal_W;
    forward = axis.cross(normal);
    crossing = forward.norm();
  }
  if (crossing < 1e-3) {  // Nothing below, or it lies flat on its side.
    laws_ = tyre_.laws(h, std::nullopt, {}, pressure_pa, 0.0);
    lifted_ = sliding_ = rolling_held_ = ploughing_held_ = false;
    return;
  }
  forward /= crossing;
  // The wheel's centre along the ground; which way it goes decides where new soil is pressed.
  set(centre_, forward, frame.hub_m.cross(forward), forward.dot(frame.velocity_by_s[0]),
      forward.dot(frame.velocity_by_s[1]), 0.0);
  const double centre_mps = centre_.of(start);
  if (std::abs(centre_mps) > kTurnsBack_mps) {
    way_ = centre_mps < 0.0 ? -1.0 : 1.0;
  }
  contact_ = *contact;
  forward_W_ = R_WB * forward;
  // Exact on hard ground; on soft soil it uses the last sinkage.
  const double deflection = contact->depth_m - laws_.sinkage_m;
  const double radius = effective_radius_m(tyre_.parameters(), deflection);
  const double reach = 0.5 * tyre_.contact_length_m(deflection, 2.0 * laws_.sinkage_m);
  laws_ = tyre_.laws(h, contact, ground.footing(contact_, way_ * forward_W_, reach), pressure_pa,
                     spin_.of(start) * radius);
  if (!laws_.touching) {
    lifted_ = sliding_ = rolling_held_ = ploughing_held_ = false;
    return;
  }
  lifted_ = false;
  const Vector3d left = normal.cross(forward);
  // Rows of the contact point: v + w x r by body and carrier, J of velocity_system.h.
  const Vector3d arm = -laws_.loaded_radius_m * forward.cross(axis);
  const Vector3d point = frame.hub_m + arm;
  const Vector3d first = frame.velocity_by_s[0] + frame.rate_by_s[0].cross(arm);
  const Vector3d second = frame.velocity_by_s[1] + frame.rate_by_s[1].cross(arm);
  set(normal_, normal, point.cross(normal), normal.dot(first), normal.dot(second), 0.0);
  // The lateral force acts behind the centre, more and more as the wheel begins to roll.
  const double rolling = std::abs(centre_mps) / (std::abs(centre_mps) + kTrails_mps);
  shift_m_ = -way_ * rolling * laws_.trail_m;
  const Vector3d back = shift_m_ * forward;
  set(across_, left, (point + back).cross(left), left.dot(first + frame.rate_by_s[0].cross(back)),
      left.dot(second + frame.rate_by_s[1].cross(back)), 0.0);
  // Sliding counts the wheel's absolute rate instead of its carrier's.
  const double r = laws_.rolling_radius_m;
  set(along_, forward, frame.hub_m.cross(forward) - r * axis, centre_.value[6] - r * spin_.value[6],
      centre_.value[7] - r * spin_.value[7], -r);

  const double load = std::max(0.0, laws_.normal.at(normal_.of(start)));
  if (laws_.turning_yields && laws_.normal.offset > 0.0) {
    // Already the secant at the limit; the tyre took its spring's force for the load.
    rolling_held_ = false;
    laws_.rolling.offset *= load / laws_.normal.offset;
    laws_.rolling.gain *= load / laws_.normal.offset;
  }
  // First guess of a sliding tyre: last step's direction at this load's limit.
  if (sliding_) {
    const double held = length(along_n_, across_n_);
    const double scale = held > 0.0 ? laws_.limit_n(load) / held : 0.0;
    along_n_ *= scale;
    across_n_ *= scale;
  }
  // First guess of the held rolling moment, f r N.
  rolling_nm_ = std::copysign(laws_.rolling_arm_m * load, rolling_nm_);
  ploughing_n_ = std::copysign(laws_.ploughing_n, ploughing_n_);
  ploughing_held_ = ploughing_held_ && laws_.ploughing_n > 0.0 && !laws_.pushing_yields;
}

void WheelTerms::add(double h, const Velocities& start, VelocitySystem& system) const {
  double weight = spin_inertia_kgm2_;
  double impulse = 0.0;
  // h gain J^T J to the matrix, h F(start) J^T to the right; held forces to the right only.
  if (laws_.touching && !lifted_) {
    system.add_without_wheel(normal_, h * laws_.normal.gain,
                             h * laws_.normal.at(normal_.of(start)));
    if (sliding_) {
      system.add(along_, 0.0, h * along_n_);
      system.add_without_wheel(across_, 0.0, h * across_n_);
    } else {
      system.add(along_, h * laws_.longitudinal.gain, h * laws_.longitudinal.at(along_.of(start)));
      system.add_without_wheel(across_, h * laws_.lateral.gain,
                               h * laws_.lateral.at(across_.of(start)));
    }
    if (rolling_held_) {
      impulse += h * rolling_nm_;
    } else {
      weight += h * laws_.rolling.gain;
      impulse += h * laws_.rolling.at(spin_.of(start));
    }
    if (laws_.ploughing_n > 0.0) {
      system.add_without_wheel(
          centre_, ploughing_held_ ? 0.0 : h * laws_.ploughing.gain,
          h * (ploughing_held_ ? ploughing_n_ : laws_.ploughing.at(centre_.of(start))));
    }
  }
  system.add(spin_, weight, impulse);
  if (brake_limit_nm_ > 0.0) {
    const std::size_t i = kWheelVelocity + wheel_;
    if (brake_held_) {
      system.right[i] += h * brake_nm_;
    } else {
      system.matrix[i][i] += h * brake_law_.gain;
      system.right[i] += h * brake_law_.at(start[i]);
    }
  }
}

bool WheelTerms::changes(const Velocities& found) {
  bool changed = false;
  if (brake_limit_nm_ > 0.0) {
    changed = hold(brake_law_.at(found[kWheelVelocity + wheel_]), brake_limit_nm_, 1e-9,
                   brake_held_, brake_nm_);
  }
  if (!laws_.touching) {
    return changed;
  }
  // Unilateral contact: one that would pull is opened.
  const double load = laws_.normal.at(normal_.of(found));
  if ((load < 0.0) != lifted_) {
    lifted_ = load < 0.0;
    changed = true;
  }
  if (lifted_) {
    return changed;
  }
  // Rolling resistance at most f r N, the soil's as its law says; as a secant each is at its limit
  // already.
  const auto resist = [&](double trial, double limit, bool yields, bool& held, double& force) {
    const bool at_limit = yields && !held && std::abs(trial) <= (1.0 + kRollingTolerance) * limit;
    if (!at_limit) {
      changed = hold(trial, limit, kRollingTolerance, held, force) || changed;
    }
  };
  resist(laws_.rolling.at(spin_.of(found)), laws_.rolling_arm_m * load, laws_.turning_yields,
         rolling_held_, rolling_nm_);
  if (laws_.ploughing_n > 0.0) {
    resist(laws_.ploughing.at(centre_.of(found)), laws_.ploughing_n, laws_.pushing_yields,
           ploughing_held_, ploughing_n_);
  }
  // Friction circle on the trial force: beyond mu N + c A it is held there, in its own direction.
  const double along = laws_.longitudinal.at(along_.of(found));
  const double across = laws_.lateral.at(across_.of(found));
  const double trial = length(along, across);
  const double limit = laws_.limit_n(load);
  if (trial <= limit) {
    changed = changed || sliding_;
    sliding_ = false;
    return changed;
  }
  const double along_n = limit * along / trial;
  const double across_n = limit * across / trial;
  const double tolerance = kSlidingTolerance * limit;
  if (!sliding_ || std::abs(along_n - along_n_) > tolerance ||
      std::abs(across_n - across_n_) > tolerance) {
    sliding_ = true;
    along_n_ = along_n;
    across_n_ = across_n;
    changed = true;
  }
  return changed;
}

void WheelTerms::settle(double h, const Velocities& found, WheelState& state) {
  const double rate = found[kWheelVelocity + wheel_];
  state = {};
  state.rate_radps = rate;
  state.rolling_radius_m =
      laws_.touching ? laws_.rolling_radius_m : tyre_.parameters().unloaded_radius_m;
  if (brake_limit_nm_ > 0.0) {
    state.brake_nm = brake_held_ ? brake_nm_ : brake_law_.at(rate);
    if (brake_held_) {
      brake_.slide_within(brake_bristle_, h, 0.0, rate, std::abs(brake_nm_));
    } else {
      brake_.slide(brake_bristle_, h, 0.0, rate);
    }
  }
  if (!laws_.touching) {
    return;
  }
  TyreResult result;
  result.longitudinal_slide_mps = along_.of(found);
  result.lateral_slide_mps = across_.of(found);
  result.wheel_rate_radps = spin_.of(found);
  result.slipping = sliding_ || lifted_;
  result.way_mps = centre_.of(found);
  result.rolling_limited = rolling_held_ || lifted_;
  result.ploughing_limited = ploughing_held_ || lifted_;
  if (!lifted_) {
    state.load_n = std::max(0.0, laws_.normal.at(normal_.of(found)));
    result.longitudinal_n =
        sliding_ ? along_n_ : laws_.longitudinal.at(result.longitudinal_slide_mps);
    result.lateral_n = sliding_ ? across_n_ : laws_.lateral.at(result.lateral_slide_mps);
    result.rolling_nm = rolling_held_ ? rolling_nm_ : laws_.rolling.at(result.wheel_rate_radps);
    if (laws_.ploughing_n > 0.0) {
      result.ploughing_n = ploughing_held_ ? ploughing_n_ : laws_.ploughing.at(result.way_mps);
    }
  }
  // Bristles end the step by z' = u - |V| z / sigma, or yield to z = -F / k (bristle.h).
  tyre_.settle(h, laws_, result);
  state.touching = !lifted_;
  state.longitudinal_n = result.longitudinal_n;
  state.lateral_n = result.lateral_n;
  state.rolling_nm = result.rolling_nm;
  state.slide_mps = length(result.longitudinal_slide_mps, result.lateral_slide_mps);
  state.ploughing_n = result.ploughing_n;
  state.aligning_nm = shift_m_ * result.lateral_n;
  state.friction = contact_.ground.friction;
  state.sinkage_m = laws_.sinkage_m;
  state.slipping = sliding_;
}

void WheelTerms::press(const Ground& ground) const {
  // What is as deep already, but for a tenth of a millimetre, needs no new pass over its cells.
  if (laws_.rut_m > 0.0 && laws_.rut_m > laws_.pressed_m + 1e-4) {
    ground.press(contact_, forward_W_, tyre_.parameters().width_m, laws_.rut_m);
  }
}

}  // namespace rigwire::sim
