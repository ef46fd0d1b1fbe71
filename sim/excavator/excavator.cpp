#include "sim/excavator/excavator.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace rigwire::sim {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr std::array<std::string_view, kLinks> kLinkNames{"undercarriage", "upper", "boom", "stick",
                                                          "bucket"};
constexpr std::array<const char*, kArmJoints> kJointNames{"swing", "boom", "stick", "bucket"};
constexpr std::array<StatusQuantity, 6> kStatusQuantities{{{"swing", "deg"},
                                                           {"boom", "deg"},
                                                           {"stick", "deg"},
                                                           {"bucket", "deg"},
                                                           {"tip height", "m"},
                                                           {"supply", "bar"}}};
constexpr std::array<TruthField, 4> kTruthFields{
    {{"joint_rad", 4}, {"joint_rate_radps", 4}, {"spool", 4}, {"bucket_tip_m", 3}}};

constexpr double kCushionFloor = 0.1;  // Share of the flow left at the very end of the stroke.

const ExcavatorParameters& validated(const ExcavatorParameters& parameters) {
  validate(parameters);
  return parameters;
}

const Eigen::Isometry3d& rigid(const Eigen::Isometry3d& X_WC) {
  const Eigen::Matrix3d R = X_WC.linear();
  if (!X_WC.matrix().allFinite() || !(R * R.transpose()).isIdentity(1e-9) ||
      R.determinant() < 0.0) {
    throw std::invalid_argument(
        "excavator: the undercarriage's pose X_WC must be finite, its rotation orthonormal and "
        "right-handed");
  }
  return X_WC;
}

Eigen::Vector3d gravity_in(const Eigen::Isometry3d& X_WC, double gravity_mps2) {
  return X_WC.linear().transpose() * Eigen::Vector3d(0.0, 0.0, -gravity_mps2);
}

Eigen::Index row(std::size_t section) {
  return static_cast<Eigen::Index>(section);
}

}  // namespace

Excavator::Excavator(const ExcavatorParameters& parameters, const Eigen::Isometry3d& X_WC)
    : parameters_(validated(parameters)),
      X_WC_(rigid(X_WC)),
      arm_(parameters, gravity_in(X_WC, parameters.gravity_mps2)),
      spools_{Spool(parameters.swing_spool), Spool(parameters.boom_spool),
              Spool(parameters.stick_spool), Spool(parameters.bucket_spool)},
      inner_span_(std::max(Duration{1}, from_seconds(parameters.step_s))) {
  areas_[0] = {parameters.swing_displacement_m3prad, parameters.swing_displacement_m3prad};
  areas_[1] = {parameters.boom_cylinder.bottom_area_m2(),
               parameters.boom_cylinder.rod_side_area_m2()};
  areas_[2] = {parameters.stick_cylinder.bottom_area_m2(),
               parameters.stick_cylinder.rod_side_area_m2()};
  areas_[3] = {parameters.bucket_cylinder.bottom_area_m2(),
               parameters.bucket_cylinder.rod_side_area_m2()};
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    const double relief =
        i == 0 ? parameters.supply.swing_relief_pressure_pa : parameters.supply.relief_pressure_pa;
    const ForceLimits limits = force_limits(areas_[i].bottom, areas_[i].rod_side, relief,
                                            parameters.supply.tank_pressure_pa);
    arm_.gains.force_least[row(i)] = limits.least;
    arm_.gains.force_greatest[row(i)] = limits.greatest;
  }
  arm_.gains.end_stops = true;
  closed_gains_ = arm_.gains;

  // No state may pass a stroke's end by more than half the way to the dead centre, whatever the
  // load: beyond it the same cylinder length belongs to the mirrored pose.
  for (int joint = 0; joint < 3; ++joint) {
    const WorkingRange& range = linkages().range(joint);
    const double past = std::min(0.005, 0.5 * linkages().dead_centre_margin_m(joint));
    const auto angle = [&](double end_q, double lever, double direction) {
      return end_q + direction * past / lever;
    };
    const double low_lever = std::abs(linkages().at(joint, range.q_min_rad()).lever_m);
    const double high_lever = std::abs(linkages().at(joint, range.q_max_rad()).lever_m);
    const auto at = static_cast<std::size_t>(2 * (joint + 1));
    hard_limits_rad_[at] = angle(range.q_min_rad(), low_lever, -1.0);
    hard_limits_rad_[at + 1] = angle(range.q_max_rad(), high_lever, 1.0);
  }

  const ExcavatorPose& pose = parameters.initial;
  state_.q_rad << pose.swing_rad, pose.boom_rad, pose.stick_rad, pose.bucket_rad;
  JointVector lever;
  arm_.coordinates(state_.q_rad, position_, lever);
  const JointVector load = arm_.dynamics().gravity_load(state_.q_rad).cwiseQuotient(lever);
  force_ = load.cwiseMax(arm_.gains.force_least).cwiseMin(arm_.gains.force_greatest);
  target_ = position_ + force_.cwiseQuotient(arm_.gains.stiffness);
  update_pressures();
  update_links();
}

void Excavator::command(const ValveCommand& command) {
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    floating_[i] = command.floating[i];
    if (!spools_[i].command(floating_[i] ? 0.0 : command.opening[i])) {
      ++refused_commands_;
    }
    // Floating joins both ports to tank: no spring, the pipes' resistance remains as the damper.
    arm_.gains.stiffness[row(i)] = floating_[i] ? 0.0 : closed_gains_.stiffness[row(i)];
  }
}

void Excavator::step(Duration span) {
  if (span <= Duration{0} || non_finite_) {
    return;
  }
  while (span > Duration{0} && !non_finite_) {
    const Duration inner = std::min(span, inner_span_);
    inner_step(to_seconds(inner));
    span -= inner;
    if (!non_finite_) {
      time_ += inner;
    }
  }
  update_links();
}

void Excavator::inner_step(double h) {
  for (Spool& spool : spools_) {
    spool.step(h);
  }
  share_flow();

  LinearTargets targets;
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    const double area = flow_[i] > 0.0 ? areas_[i].bottom : areas_[i].rod_side;
    double rate = floating_[i] ? 0.0 : flow_[i] / area;
    if (i > 0 && rate != 0.0) {
      const WorkingRange& range = linkages().range(static_cast<int>(i) - 1);
      rate = rate > 0.0 ? std::clamp((range.length_max_m - target_[row(i)]) / h, 0.0, rate)
                        : std::clamp((range.length_min_m - target_[row(i)]) / h, rate, 0.0);
    }
    targets.rates[row(i)] = rate;
  }
  targets.start = target_;

  if (!bucket_load_.empty()) {
    place_bucket_load();
  }
  ArmState next = state_;
  const ArmStep step = arm_.step(parameters_.scheme, 0.0, h, targets, next);
  if (record_non_finite(next, step.acceleration_radps2)) {
    return;
  }
  state_ = next;
  acceleration_ = step.acceleration_radps2;
  force_ = step.force;
  resistance_n_ = step.resistance_n;
  hold_strokes();
  move_targets(h * targets.rates, targets.rates, step.relieved);
  update_pressures();
}

void Excavator::share_flow() {
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    flow_[i] = floating_[i] ? 0.0 : limited_flow(i, spools_[i].flow_request_m3ps());
  }
  const double share = flow_share(parameters_.supply, flow_, supply_pressure_pa_);
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
  if (left <= 0.0) {
    return 0.0;
  }
  const double cushion_m = parameters_.drives.cushion * stroke;
  return left >= cushion_m ? flow_m3ps : flow_m3ps * std::max(kCushionFloor, left / cushion_m);
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

void Excavator::move_targets(const JointVector& way, const JointVector& rate,
                             const std::array<bool, kArmJoints>& relieved) {
  JointVector lever;
  arm_.coordinates(state_.q_rad, position_, lever);
  position_rate_ = lever.cwiseProduct(state_.v_radps);
  const DriveGains& gains = arm_.gains;
  for (Eigen::Index i = 0; i < kArmJoints; ++i) {
    target_[i] += way[i];
    if (gains.stiffness[i] == 0.0) {
      target_[i] = position_[i];
    } else if (relieved[static_cast<std::size_t>(i)]) {
      const double damper = gains.damping[i] * (rate[i] - position_rate_[i]);
      target_[i] = position_[i] + (force_[i] - damper) / gains.stiffness[i];
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

void Excavator::update_pressures() {
  const SupplyParameters& supply = parameters_.supply;
  double highest = supply.tank_pressure_pa;
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    ports_[i] = floating_[i] ? PortPressures{supply.tank_pressure_pa, supply.tank_pressure_pa}
                             : port_pressures(force_[row(i)], areas_[i].bottom, areas_[i].rod_side,
                                              supply.tank_pressure_pa);
    const double request = floating_[i] ? 0.0 : spools_[i].flow_request_m3ps();
    double& driving = request > 0.0 ? ports_[i].a_pa : ports_[i].b_pa;
    if (at_stroke_end(i, request)) {
      driving = supply.relief_pressure_pa;
    }
    if (request != 0.0) {
      highest = std::max(highest, driving);
    }
  }
  supply_pressure_pa_ =
      std::min(highest + supply.load_sensing_margin_pa, supply.relief_pressure_pa);
}

void Excavator::update_links() {
  const Eigen::Matrix3d R_WC = X_WC_.linear();
  links_[0].X_WL = X_WC_;
  const auto motion = arm_.dynamics().motion(state_.q_rad, state_.v_radps, acceleration_);
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    LinkMotion& link = links_[i + 1];
    link.X_WL.linear() = R_WC * motion[i].R_CB;
    link.X_WL.translation() = R_WC * motion[i].p_CB_C + X_WC_.translation();
    link.v_WL_W = R_WC * motion[i].v_CB_C;
    link.w_WL_W = R_WC * motion[i].w_CB_C;
    link.a_WL_W = R_WC * motion[i].a_CB_C;
    link.alpha_WL_W = R_WC * motion[i].alpha_CB_C;
  }
}

ValveSample Excavator::valve_sample(SimTime time) const {
  ValveSample sample;
  sample.time = time;
  for (std::size_t i = 0; i < kValveSections; ++i) {
    if (i < kArmJoints) {
      sample.spool_position[i] = spools_[i].position();
      sample.port_a_pressure_pa[i] = ports_[i].a_pa;
      sample.port_b_pressure_pa[i] = ports_[i].b_pa;
    } else {
      sample.port_a_pressure_pa[i] = parameters_.supply.tank_pressure_pa;
      sample.port_b_pressure_pa[i] = parameters_.supply.tank_pressure_pa;
    }
  }
  sample.supply_pressure_pa = supply_pressure_pa_;
  sample.swing_angle_rad = state_.q_rad[0];
  sample.swing_rate_radps = state_.v_radps[0];
  return sample;
}

std::span<const std::string_view> Excavator::link_names() const {
  return kLinkNames;
}

std::span<const StatusQuantity> Excavator::status_quantities() const {
  return kStatusQuantities;
}

void Excavator::read_status(std::span<double> values) const {
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    values[i] = state_.q_rad[row(i)] * kDegrees;
  }
  values[4] = tip_W().z();
  values[5] = supply_pressure_pa_ * 1e-5;
}

std::span<const TruthField> Excavator::truth_fields() const {
  return kTruthFields;
}

void Excavator::read_truth(std::span<double> values) const {
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    values[i] = state_.q_rad[row(i)];
    values[4 + i] = state_.v_radps[row(i)];
    values[8 + i] = spools_[i].position();
  }
  const Eigen::Vector3d tip = tip_W();
  std::copy_n(tip.data(), 3, values.begin() + 12);
}

void Excavator::set_bucket_force(const Eigen::Vector3d& force_W, const Eigen::Vector3d& point_W) {
  if (force_W.allFinite() && point_W.allFinite()) {
    bucket_load_.force_W = force_W;
    bucket_load_.point_B = link(Link::bucket).X_WL.inverse(Eigen::Isometry) * point_W;
    if (bucket_load_.empty()) {
      arm_.load = {};
    }
  }
}

void Excavator::set_bucket_resistances(std::span<const TipResistance> resistances) {
  bucket_load_.resistance_count = 0;
  for (const TipResistance& each : resistances) {
    const bool fine = each.direction_W.allFinite() && each.point_B.allFinite() &&
                      std::isfinite(each.offset_n) && std::isfinite(each.gain_nspm) &&
                      each.gain_nspm >= 0.0 && each.limit_n >= 0.0;
    if (fine && bucket_load_.resistance_count < kTipResistances) {
      bucket_load_.resistances[bucket_load_.resistance_count++] = each;
    }
  }
  if (bucket_load_.empty()) {
    arm_.load = {};
  }
}

void Excavator::place_bucket_load() {
  const Eigen::Matrix3d R_CW = X_WC_.linear().transpose();
  const ArmDynamics& dynamics = arm_.dynamics();
  ArmLoad& load = arm_.load;
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

Eigen::Vector3d Excavator::tip_W() const {
  return X_WC_ * arm_.dynamics().tip_C(state_.q_rad);
}

void Excavator::set_payload_kg(double mass_kg) {
  if (!std::isnan(mass_kg)) {
    arm_.dynamics().set_payload_kg(mass_kg);
  }
}

}  // namespace rigwire::sim
