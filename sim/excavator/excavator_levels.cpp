// One inner step of the excavator, on each of its levels.
#include <algorithm>
#include <cmath>

#include "sim/excavator/excavator.h"

namespace rigwire::sim {
namespace {

constexpr double kCushionFloor = 0.1;  // Share of the flow left at the very end of the stroke.
// Level quasi_static: within this time a cylinder is back where the oil it got says it is.
constexpr double kReturn_s = 0.1;
constexpr std::array<const char*, kArmJoints> kJointNames{"swing", "boom", "stick", "bucket"};

Eigen::Index row(std::size_t section) {
  return static_cast<Eigen::Index>(section);
}

}  // namespace

void Excavator::inner_step(double h) {
  for (Spool& spool : spools_) {
    spool.step(h);
  }
  share_flow();
  if (!bucket_load_.empty() && !carried_) {
    place_bucket_load();
  }
  switch (parameters_.level) {
    case ExcavatorLevel::kinematic:
      step_kinematic(h, target_rates(h));
      break;
    case ExcavatorLevel::quasi_static:
      step_quasi_static(h, target_rates(h));
      break;
    case ExcavatorLevel::dynamic:
      step_dynamic(h, target_rates(h));
      break;
    case ExcavatorLevel::chambers:
      step_chambers(h);
      break;
  }
  update_pressures(h);
  if (power_unit_) {
    drive_pumps(h);
  }
}

void Excavator::drive_pumps(double h) {
  double taken_m3ps = 0.0;
  for (const double flow : flow_) {
    taken_m3ps += std::abs(flow);
  }
  power_unit_->step(h, taken_m3ps, supply_pressure_pa_);
}

void Excavator::share_flow() {
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    flow_[i] = floating_[i] ? 0.0 : limited_flow(i, spools_[i].flow_request_m3ps());
  }
  const SupplyParameters& supply = power_unit_ ? power_unit_->supply() : parameters_.supply;
  const double share = flow_share(supply, flow_, supply_pressure_pa_);
  for (double& flow : flow_) {
    flow *= share;
  }
}

double Excavator::limited_flow(std::size_t section, double flow_m3ps) const {
  if (section == 0 || flow_m3ps == 0.0) {
    return flow_m3ps;
  }
  const WorkingRange& range = linkages().range(static_cast<int>(section) - 1);
  const double stroke = range.length_max_m - range.length_min_m;
  const double left = flow_m3ps > 0.0 ? range.length_max_m - target_[row(section)]
                                      : target_[row(section)] - range.length_min_m;
  // A real valve stays open at the stroke's end; where there are chambers they fill.
  if (left <= 0.0 && parameters_.level != ExcavatorLevel::chambers) {
    return 0.0;
  }
  // Cushion: flow throttled in proportion to the stroke that is left, to a tenth at its end.
  const double cushion_m = parameters_.drives.cushion * stroke;
  return left >= cushion_m ? flow_m3ps : flow_m3ps * std::max(kCushionFloor, left / cushion_m);
}

JointVector Excavator::target_rates(double h) const {
  JointVector rates;
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    // Continuity: rate = Q / A of the side that fills.
    const double area = flow_[i] > 0.0 ? areas_[i].bottom : areas_[i].rod_side;
    double rate = floating_[i] ? 0.0 : flow_[i] / area;
    if (i > 0 && rate != 0.0) {
      const WorkingRange& range = linkages().range(static_cast<int>(i) - 1);
      rate = rate > 0.0 ? std::clamp((range.length_max_m - target_[row(i)]) / h, 0.0, rate)
                        : std::clamp((range.length_min_m - target_[row(i)]) / h, rate, 0.0);
    }
    rates[row(i)] = rate;
  }
  return rates;
}

void Excavator::step_kinematic(double h, const JointVector& rate) {
  // Newton's step towards the length that the oil makes: what is left of it is of second order and
  // belongs to the next step.
  ArmState next = state_;
  next.q_rad += (target_ + h * rate - pose_.x).cwiseQuotient(pose_.lever);
  const ArmPose there = arm_.pose(next.q_rad);
  next.v_radps = rate.cwiseQuotient(there.lever);
  ArmStep step;
  step.acceleration_radps2 = (next.v_radps - state_.v_radps) / h;
  if (accept(next, step)) {
    target_ += h * rate;
  }
}

void Excavator::step_quasi_static(double h, const JointVector& rate) {
  DriveLaws laws{
      .force = {}, .least = arm_.gains.force_least, .greatest = arm_.gains.force_greatest};
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    const Eigen::Index at = row(i);
    // A damper so stiff that the rate is the oil's: F = gain (wanted - x'), within the relief.
    const double gain = floating_[i] ? closed_gains_.damping[at] : rigid_gain_[at];
    const double wanted =
        floating_[i] ? 0.0 : rate[at] + (target_[at] - pose_.x[at]) / std::max(kReturn_s, h);
    laws.force[i] = {gain * wanted, gain};
  }
  ArmState next = state_;
  const ArmStep step = advance(h, laws, next);
  if (!accept(next, step)) {
    return;
  }
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    const Eigen::Index at = row(i);
    target_[at] = floating_[i] || step.relieved[i] ? pose_.x[at] : target_[at] + h * rate[at];
  }
}

void Excavator::step_dynamic(double h, const JointVector& rate) {
  ArmState next = state_;
  ArmStep step;
  if (parameters_.scheme == IntegrationScheme::linearly_implicit_euler) {
    // Eq. 5 with the target moved on by the oil, x_t(t + h) = x_t + h Q / A.
    const DriveLaws laws = arm_.laws(pose_, h, target_ + h * rate, rate);
    step = advance(h, laws, next);
  } else {
    LinearTargets targets;
    targets.start = target_;
    targets.rates = rate;
    step = arm_.step(parameters_.scheme, 0.0, h, targets, next);
  }
  if (!accept(next, step)) {
    return;
  }
  const DriveGains& gains = arm_.gains;
  for (Eigen::Index i = 0; i < kArmJoints; ++i) {
    target_[i] += h * rate[i];
    if (gains.stiffness[i] == 0.0) {
      target_[i] = pose_.x[i];
    } else if (step.relieved[static_cast<std::size_t>(i)]) {
      // Behind an open relief valve the target goes where the force is held: no wind-up.
      const double damper = gains.damping[i] * (rate[i] - position_rate_[i]);
      target_[i] = pose_.x[i] + (force_[i] - damper) / gains.stiffness[i];
    }
  }
}

void Excavator::step_chambers(double h) {
  const SupplyParameters& supply = parameters_.supply;
  DriveLaws laws;
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    const double relief = i == 0 ? supply.swing_relief_pressure_pa : supply.relief_pressure_pa;
    laws.force[i] = chambers_[i].law(
        h, pose_.x[row(i)],
        {flow_[i], floating_[i], supply_pressure_pa_, supply.tank_pressure_pa, relief});
  }
  ArmState next = state_;
  const JointVector lever = pose_.lever;
  const ArmStep step = advance(h, laws, next);
  const JointVector rate = lever.cwiseProduct(next.v_radps);
  if (!accept(next, step)) {
    return;
  }
  target_ = pose_.x;
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    chambers_[i].settle(rate[row(i)]);
    flow_[i] = chambers_[i].inlet_flow_m3ps();
  }
}

ArmStep Excavator::advance(double h, const DriveLaws& laws, ArmState& next) {
  return carried_ ? carried_->step(h, arm_, pose_, laws, bucket_load_, next)
                  : arm_.advance(h, pose_, laws, next);
}

bool Excavator::accept(const ArmState& next, const ArmStep& step) {
  if (record_non_finite(next, step.acceleration_radps2)) {
    return false;
  }
  if (carried_) {
    X_WC_ = carried_->X_WC();
  }
  state_ = next;
  acceleration_ = step.acceleration_radps2;
  force_ = step.force;
  resistance_n_ = step.resistance_n;
  hold_strokes();
  pose_ = arm_.pose(state_.q_rad);
  position_rate_ = pose_.lever.cwiseProduct(state_.v_radps);
  return true;
}

void Excavator::hold_strokes() {
  for (std::size_t i = 1; i < kArmJoints; ++i) {
    double& q = state_.q_rad[row(i)];
    double& v = state_.v_radps[row(i)];
    if (q < hard_limits_rad_[2 * i]) {
      q = hard_limits_rad_[2 * i];
      v = std::max(v, 0.0);
    } else if (q > hard_limits_rad_[2 * i + 1]) {
      q = hard_limits_rad_[2 * i + 1];
      v = std::min(v, 0.0);
    }
  }
}

bool Excavator::record_non_finite(const ArmState& state, const JointVector& acceleration) {
  const auto check = [this](const char* quantity, const JointVector& values) {
    for (int i = 0; i < kArmJoints; ++i) {
      if (!non_finite_ && !std::isfinite(values[i])) {
        non_finite_ = NonFinite{quantity, kJointNames[static_cast<std::size_t>(i)], time_};
      }
    }
  };
  check("drive target", target_);
  check("joint acceleration", acceleration);
  check("joint rate", state.v_radps);
  check("joint angle", state.q_rad);
  if (!non_finite_ && carried_ && !carried_->finite()) {
    non_finite_ = NonFinite{"pose or velocity", "undercarriage", time_};
  }
  return non_finite_.has_value();
}

bool Excavator::at_stroke_end(std::size_t section, double direction) const {
  if (section == 0 || direction == 0.0) {
    return false;
  }
  const WorkingRange& range = linkages().range(static_cast<int>(section) - 1);
  return direction > 0.0 ? target_[row(section)] >= range.length_max_m
                         : target_[row(section)] <= range.length_min_m;
}

void Excavator::update_pressures(double h) {
  const SupplyParameters& supply = parameters_.supply;
  double highest = supply.tank_pressure_pa;
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    const double request = floating_[i] ? 0.0 : spools_[i].flow_request_m3ps();
    switch (parameters_.level) {
      case ExcavatorLevel::kinematic:
        ports_[i] = {supply.tank_pressure_pa, supply.tank_pressure_pa};
        break;
      case ExcavatorLevel::chambers:
        ports_[i] = chambers_[i].pressures();
        break;
      case ExcavatorLevel::quasi_static:
      case ExcavatorLevel::dynamic:
        ports_[i] = floating_[i] ? PortPressures{supply.tank_pressure_pa, supply.tank_pressure_pa}
                                 : port_pressures(force_[row(i)], areas_[i].bottom,
                                                  areas_[i].rod_side, supply.tank_pressure_pa);
        if (at_stroke_end(i, request)) {
          (request > 0.0 ? ports_[i].a_pa : ports_[i].b_pa) = supply.relief_pressure_pa;
        }
        break;
    }
    if (request != 0.0) {
      highest = std::max(highest, request > 0.0 ? ports_[i].a_pa : ports_[i].b_pa);
    }
  }
  // Load sensing: highest driving port plus margin, through the regulator's lag, exact over h.
  const double aim = std::min(highest + supply.load_sensing_margin_pa, supply.relief_pressure_pa);
  // Without the regulator's lag pressure, flow share and drive force would close a loop in no time.
  supply_pressure_pa_ -=
      std::expm1(-h / supply.load_sensing_time_constant_s) * (aim - supply_pressure_pa_);
}

void Excavator::place_bucket_load() {
  const Eigen::Matrix3d R_CW = X_WC_.linear().transpose();
  const ArmDynamics& dynamics = arm_.dynamics();
  ArmLoad& load = arm_.load;
  // Virtual work: torques J^T f of forces at the bucket.
  load.torque = dynamics.bucket_jacobian_C(state_.q_rad, bucket_load_.point_B).transpose() *
                (R_CW * bucket_load_.force_W);
  load.resistance_count = bucket_load_.resistance_count;
  for (std::size_t i = 0; i < load.resistance_count; ++i) {
    const TipResistance& each = bucket_load_.resistances[i];
    load.resistances[i] = {dynamics.bucket_jacobian_C(state_.q_rad, each.point_B).transpose() *
                               (R_CW * each.direction_W),
                           each.offset_n, each.gain_nspm, each.limit_n};
  }
}

}  // namespace rigwire::sim
