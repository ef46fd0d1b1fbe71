#include "sim/vehicle/suspension.h"

#include <cmath>

namespace rigwire::sim {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

struct StopForce {
  double force = 0.0;
  double stiffness = 0.0;
};

/// One-sided spring: stiffness rises along the ramp (a parabola of force), constant beyond it.
StopForce stop_force(const StopParameters& stop, double past) {
  if (past <= 0.0) {
    return {};
  }
  if (past < stop.ramp) {
    return {0.5 * stop.stiffness * past * past / stop.ramp, stop.stiffness * past / stop.ramp};
  }
  return {stop.stiffness * (past - 0.5 * stop.ramp), stop.stiffness};
}

/// Returns the force on a coordinate with stops above `upper` and below `lower`; it pushes back.
StopForce stops(const StopParameters& stop, double s, double lower, double upper) {
  if (s > upper) {
    const StopForce high = stop_force(stop, s - upper);
    return {-high.force, high.stiffness};
  }
  return stop_force(stop, lower - s);
}

}  // namespace

Matrix3d WheelFrame::R_BH() const {
  Matrix3d R;
  R.col(0) = axis.cross(up).normalized();
  R.col(1) = axis;
  R.col(2) = R.col(0).cross(axis);
  return R;
}

AxleSuspension::AxleSuspension(const VehicleAxleParameters& axle, bool front,
                               const Vector3d& center_of_mass_m, double wheel_height_m,
                               double spring_n)
    : axle_(axle), beam_(axle.type == AxleType::beam), spring_n_(spring_n) {
  const double rise = beam_ ? axle.portal_offset_m : 0.0;
  centre_m_ = Vector3d(axle.position_x_m, 0.0, wheel_height_m + rise) - center_of_mass_m;
  heave_per_rad_ = front ? -axle.beam.tube_length_m : axle.beam.tube_length_m;
  // The push tube's ball: the axle swings about it in heave.
  pivot_m_ = centre_m_ + Vector3d(heave_per_rad_, 0.0, axle.beam.tube_rise_m);
  const std::array<Vector3d, 2> zero{Vector3d::Zero(), Vector3d::Zero()};
  for (UnsprungMass& mass : masses_) {
    mass.velocity_by_s = zero;
    mass.rate_by_s = zero;
    if (beam_) {
      mass.mass_kg = axle.beam.mass_kg;
      mass.transverse_kgm2 = axle.beam.roll_inertia_kgm2;
      mass.axial_kgm2 = axle.beam.pitch_inertia_kgm2;
    } else {
      mass.mass_kg = axle.independent.corner_mass_kg;
      mass.transverse_kgm2 = axle.independent.corner_inertia_kgm2;
    }
  }
  for (WheelFrame& wheel : wheels_) {
    wheel.velocity_by_s = zero;
    wheel.rate_by_s = zero;
  }
}

void AxleSuspension::update(const Vector2d& s, const Vector2d& s_rate, const Vector3d& w_B,
                            const std::array<double, 2>& steer_rad) {
  if (beam_) {
    update_beam(s, s_rate, w_B, steer_rad);
  } else {
    update_independent(s, s_rate, w_B, steer_rad);
  }
}

void AxleSuspension::update_beam(const Vector2d& s, const Vector2d& s_rate, const Vector3d& w_B,
                                 const std::array<double, 2>& steer_rad) {
  const bool guided = heave_per_rad_ == 0.0;
  const double per_heave = guided ? 0.0 : 1.0 / heave_per_rad_;
  const double pitch = per_heave * s[0];
  const double cp = std::cos(pitch);
  const double sp = std::sin(pitch);
  const double cr = std::cos(s[1]);
  const double sr = std::sin(s[1]);
  UnsprungMass& axle = masses_[0];
  // Pitch about y, then roll about the tube.
  axle.R_BA << cp, sp * sr, sp * cr, 0.0, cr, -sr, -sp, cp * sr, cp * cr;
  const Vector3d tube = axle.R_BA.col(0);
  const Vector3d up(sp, 0.0, cp);  // Vertical axis of the tube, not rolled.
  const double rise = axle_.beam.roll_centre_rise_m;

  // Roll centre on its arc about the pivot (straight up where guided), axle centre below it.
  const Vector3d& pivot = pivot_m_;
  const Vector3d arm = -heave_per_rad_ * tube + (rise - axle_.beam.tube_rise_m) * up;
  const Vector3d roll_centre =
      guided ? Vector3d(centre_m_ + Vector3d(0.0, 0.0, rise + s[0])) : Vector3d(pivot + arm);
  const Vector3d from_roll_centre = -rise * axle.R_BA.col(2);
  axle.position_m = roll_centre + from_roll_centre;
  axle.axis = axle.R_BA.col(1);

  // Partial velocities: heave turns all about the pivot, roll about the tube at the roll centre.
  const Vector3d pitch_by_s(0.0, per_heave, 0.0);
  axle.rate_by_s = {pitch_by_s, tube};
  const auto by_heave = [&](const Vector3d& point) -> Vector3d {
    // e_y x (point - pivot) / lever.
    return guided ? Vector3d::UnitZ()
                  : Vector3d(per_heave * (point.z() - pivot.z()), 0.0,
                             -per_heave * (point.x() - pivot.x()));
  };
  axle.velocity_by_s = {by_heave(axle.position_m), tube.cross(from_roll_centre)};

  // Rates add up body, tube, roll; biases are their derivatives with no rate changing: w x rate.
  const Vector3d tube_turn = s_rate[0] * pitch_by_s;
  const Vector3d tube_rate = w_B + tube_turn;
  const Vector3d roll = s_rate[1] * tube;
  axle.rate = tube_rate + roll;
  const Vector3d tube_bias = w_B.cross(tube_turn);
  axle.bias_radps2 = tube_bias + tube_rate.cross(roll);
  Vector3d bias;
  if (guided) {
    bias = w_B.cross(w_B.cross(roll_centre)) + 2.0 * s_rate[0] * w_B.cross(Vector3d::UnitZ());
  } else {
    bias =
        w_B.cross(w_B.cross(pivot)) + tube_bias.cross(arm) + tube_rate.cross(tube_rate.cross(arm));
  }
  // Rigid arm: a = a_0 + alpha x r + w x (w x r).
  axle.bias_mps2 = bias + axle.bias_radps2.cross(from_roll_centre) +
                   axle.rate.cross(axle.rate.cross(from_roll_centre));

  for (std::size_t side = 0; side < 2; ++side) {
    WheelFrame& wheel = wheels_[side];
    const double left = side == 0 ? 0.5 : -0.5;
    // Hub: half the track out, the portal's offset down; its axis turned by the steering angle.
    const Vector3d out =
        left * axle_.track_m * axle.axis - axle_.portal_offset_m * axle.R_BA.col(2);
    wheel.hub_m = axle.position_m + out;
    if (steer_rad[side] != steer_rad_[side]) {
      steer_rad_[side] = steer_rad[side];
      steer_cosine_[side] = std::cos(steer_rad[side]);
      steer_sine_[side] = std::sin(steer_rad[side]);
    }
    wheel.axis = steer_cosine_[side] * axle.axis - steer_sine_[side] * tube;
    wheel.rate_by_s = axle.rate_by_s;
    wheel.velocity_by_s = {by_heave(wheel.hub_m), tube.cross(from_roll_centre + out)};
    wheel.rate = axle.rate;
    wheel.bias_radps2 = axle.bias_radps2;
    wheel.bias_mps2 =
        axle.bias_mps2 + axle.bias_radps2.cross(out) + axle.rate.cross(axle.rate.cross(out));
    wheel.up = axle.R_BA.col(2);
  }
}

void AxleSuspension::update_independent(const Vector2d& s, const Vector2d& s_rate,
                                        const Vector3d& w_B,
                                        const std::array<double, 2>& steer_rad) {
  const IndependentAxleParameters& p = axle_.independent;
  for (std::size_t side = 0; side < 2; ++side) {
    const auto i = static_cast<Eigen::Index>(side);
    const double left = side == 0 ? 1.0 : -1.0;
    WheelFrame& wheel = wheels_[side];
    // Straight vertical travel; camber and toe go in proportion to it.
    wheel.hub_m = centre_m_ + Vector3d(0.0, 0.5 * left * axle_.track_m, s[i]);
    const double camber = left * p.camber_gain_radpm * s[i];
    const double angle = steer_rad[side] - left * p.toe_gain_radpm * s[i];
    wheel.axis = Vector3d(-std::sin(angle), std::cos(angle), -camber).normalized();
    wheel.velocity_by_s[side] = Vector3d::UnitZ();
    wheel.rate = w_B;
    // Centripetal and Coriolis acceleration: w x (w x r) + 2 s' (w x e_z).
    wheel.bias_mps2 =
        w_B.cross(w_B.cross(wheel.hub_m)) + 2.0 * s_rate[i] * w_B.cross(Vector3d::UnitZ());

    UnsprungMass& mass = masses_[side];
    mass.position_m = wheel.hub_m;
    mass.axis = wheel.axis;
    mass.velocity_by_s[side] = Vector3d::UnitZ();
    mass.rate = w_B;
    mass.bias_mps2 = wheel.bias_mps2;
  }
}

WheelFrame AxleSuspension::carrier() const {
  WheelFrame part;
  part.axis.setZero();
  if (beam_) {
    const UnsprungMass& beam = masses_[0];
    part.hub_m = beam.position_m;
    part.velocity_by_s = beam.velocity_by_s;
    part.rate_by_s = beam.rate_by_s;
    part.rate = beam.rate;
    part.bias_mps2 = beam.bias_mps2;
    part.bias_radps2 = beam.bias_radps2;
    part.up = beam.R_BA.col(2);
    return part;
  }
  const WheelFrame& left = wheels_[0];
  const WheelFrame& right = wheels_[1];
  part.hub_m = 0.5 * (left.hub_m + right.hub_m);
  part.velocity_by_s = {0.5 * left.velocity_by_s[0], 0.5 * right.velocity_by_s[1]};
  part.rate_by_s = {Vector3d::Zero(), Vector3d::Zero()};
  part.rate = left.rate;
  part.bias_mps2 = 0.5 * (left.bias_mps2 + right.bias_mps2);
  return part;
}

SuspensionForce AxleSuspension::force(const Vector2d& s, const Vector2d& s_rate) const {
  SuspensionForce result;
  if (beam_) {
    const BeamAxleParameters& p = axle_.beam;
    // Two springs at half the base: 2 k in heave, 2 k (b / 2)^2 = k b^2 / 2 in roll, plus the bar.
    const double base2 = 0.5 * p.spring_base_m * p.spring_base_m;
    const StopForce heave = stops(p.bump_stop, s[0], -p.rebound_travel_m, p.bump_travel_m);
    const StopForce roll =
        stops(p.articulation_stop, s[1], -p.articulation_rad, p.articulation_rad);
    const Vector2d spring(2.0 * p.spring_npm, p.spring_npm * base2 + p.roll_bar_nmprad);
    result.damping = Vector2d(2.0 * p.damper_nspm, p.damper_nspm * base2);
    result.stiffness = spring + Vector2d(heave.stiffness, roll.stiffness);
    result.force = Vector2d(heave.force - spring_n_, roll.force) - spring.cwiseProduct(s) -
                   result.damping.cwiseProduct(s_rate);
    return result;
  }
  const IndependentAxleParameters& p = axle_.independent;
  result.cross_stiffness = -p.roll_bar_npm;
  for (Eigen::Index i = 0; i < 2; ++i) {
    // Own spring, damper, stop and half the preload; the bar pulls by k_bar (s_own - s_other).
    const StopForce stop = stops(p.bump_stop, s[i], -p.rebound_travel_m, p.bump_travel_m);
    result.damping[i] = p.damper_nspm;
    result.stiffness[i] = p.spring_npm + p.roll_bar_npm + stop.stiffness;
    result.force[i] = stop.force - 0.5 * spring_n_ - (p.spring_npm + p.roll_bar_npm) * s[i] +
                      p.roll_bar_npm * s[1 - i] - p.damper_nspm * s_rate[i];
  }
  return result;
}

}  // namespace rigwire::sim
