#include "sim/excavator/excavator.h"
#include "sim/inner_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace rigwire::sim {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
// Of level quasi_static: its drives' gains over those that stop their mass within a step.
constexpr double kRigid = 1e6;
constexpr std::array<StatusQuantity, 6> kStatusQuantities{{{"swing", "deg"},
                                                           {"boom", "deg"},
                                                           {"stick", "deg"},
                                                           {"bucket", "deg"},
                                                           {"tip height", "m"},
                                                           {"supply", "bar"}}};
constexpr std::array<TruthField, 7> kTruthFields{{{"joint_rad", 4},
                                                  {"joint_rate_radps", 4},
                                                  {"spool", 4},
                                                  {"bucket_tip_m", 3},
                                                  {"engine_radps", 1},
                                                  {"engine_torque_nm", 1},
                                                  {"pump_flow_m3ps", 1}}};
constexpr std::size_t kWithoutEngine = 4;  ///< Of these, on pumps constant.

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

Excavator::Excavator(const ExcavatorParameters& parameters, const Eigen::Isometry3d& X_WC,
                     const Ground* ground)
    : parameters_(validated(parameters)),
      X_WC_(rigid(X_WC)),
      arm_(parameters, gravity_in(X_WC, parameters.gravity_mps2)),
      spools_{Spool(parameters.swing_spool), Spool(parameters.boom_spool),
              Spool(parameters.stick_spool), Spool(parameters.bucket_spool)},
      inner_span_(std::max(Duration{1}, from_seconds(parameters.step_s))) {
  if (parameters.pumps == ExcavatorPumps::engine) {
    power_unit_.emplace(parameters.power_unit, parameters.supply);
  }
  // Force per pressure: a cylinder's areas; for the swing motor, torque by displacement per radian.
  areas_[0] = {parameters.swing_displacement_m3prad, parameters.swing_displacement_m3prad};
  const CylinderParameters* cylinders[] = {&parameters.boom_cylinder, &parameters.stick_cylinder,
                                           &parameters.bucket_cylinder};
  for (std::size_t i = 1; i < kArmJoints; ++i) {
    areas_[i] = {cylinders[i - 1]->bottom_area_m2(), cylinders[i - 1]->rod_side_area_m2()};
  }
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
    const auto at = 2 * (static_cast<std::size_t>(joint) + 1);
    hard_limits_rad_[at] = angle(range.q_min_rad(), low_lever, -1.0);
    hard_limits_rad_[at + 1] = angle(range.q_max_rad(), high_lever, 1.0);
  }

  const ExcavatorPose& pose = parameters.initial;
  state_.q_rad << pose.swing_rad, pose.boom_rad, pose.stick_rad, pose.bucket_rad;
  pose_ = arm_.pose(state_.q_rad);
  // Statics at the start: drive forces that hold the weight, and targets that make them.
  const JointVector load = arm_.dynamics().gravity_load(state_.q_rad).cwiseQuotient(pose_.lever);
  force_ = load.cwiseMax(arm_.gains.force_least).cwiseMin(arm_.gains.force_greatest);
  target_ = pose_.x;
  const JointVector friction =
      arm_.damping_for(state_.q_rad, arm_.gains.stiffness, parameters.chambers.damping_ratio);
  // A gain of m / h stops a drive's mass within one step; a million times that counts as rigid.
  rigid_gain_ = kRigid / parameters.step_s * arm_.free_mass(state_.q_rad);
  if (parameters.level == ExcavatorLevel::kinematic) {
    force_.setZero();
  } else if (parameters.level == ExcavatorLevel::dynamic) {
    target_ += force_.cwiseQuotient(arm_.gains.stiffness);
  }
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    const WorkingRange range = i == 0 ? WorkingRange{} : linkages().range(static_cast<int>(i) - 1);
    chambers_[i] = ActuatorChambers(
        parameters.chambers,
        {areas_[i].bottom, areas_[i].rod_side, range.length_min_m, range.length_max_m},
        friction[row(i)]);
    chambers_[i].set_pressures(port_pressures(force_[row(i)], areas_[i].bottom, areas_[i].rod_side,
                                              parameters.supply.tank_pressure_pa));
  }
  update_pressures(std::numeric_limits<double>::infinity());
  if (parameters.carrier == ExcavatorCarrier::moving) {
    if (ground == nullptr) {
      throw std::invalid_argument("excavator: carrier moving needs a ground to stand on");
    }
    carried_.emplace(parameters, *ground, X_WC);
    settle_on_tyres();
  }
  update_links();
}

void Excavator::settle_on_tyres() {
  constexpr double kSettle_s = 5.0;
  constexpr double kStep_s = 2e-3;
  for (int i = 0; i < static_cast<int>(kSettle_s / kStep_s) && !non_finite_; ++i) {
    inner_step(kStep_s);
  }
  state_.v_radps.setZero();
  acceleration_.setZero();
  position_rate_.setZero();
  carried_->place(X_WC_);
}

void Excavator::command(const ValveCommand& command) {
  command_.time = command.time;
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    floating_[i] = command_.floating[i] = command.floating[i];
    if (!spools_[i].command(floating_[i] ? 0.0 : command.opening[i])) {
      ++refused_commands_;
    }
    if (!std::isnan(command.opening[i])) {
      command_.opening[i] = std::clamp(command.opening[i], -1.0, 1.0);
    }
    // Floating joins both ports to tank: no spring, the pipes' resistance remains as the damper.
    arm_.gains.stiffness[row(i)] = floating_[i] ? 0.0 : closed_gains_.stiffness[row(i)];
  }
}

void Excavator::step(Duration span) {
  if (span <= Duration{0} || non_finite_) {
    return;
  }
  run_inner_steps(span, inner_span_, time_, non_finite_, [this](double h) { inner_step(h); });
  update_links();
}

void Excavator::update_links() {
  if (carried_) {
    links_ = carried_->motion(state_);
    return;
  }
  // Carrier at rest: what the arm does in its axes, turned into the world's.
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
  sample.tank_pressure_pa = parameters_.supply.tank_pressure_pa;
  sample.swing_angle_rad = state_.q_rad[0];
  sample.swing_rate_radps = state_.v_radps[0];
  return sample;
}

PowerUnitSample Excavator::power_unit_sample(SimTime time) const {
  PowerUnitSample sample = power_unit_->sample();
  sample.time = time;
  sample.pump_pressure_pa = supply_pressure_pa_;
  return sample;
}

std::span<const std::string_view> Excavator::link_names() const {
  return kExcavatorLinks;
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
  return std::span(kTruthFields).first(power_unit_ ? kTruthFields.size() : kWithoutEngine);
}

void Excavator::read_truth(std::span<double> values) const {
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    values[i] = state_.q_rad[row(i)];
    values[4 + i] = state_.v_radps[row(i)];
    values[8 + i] = spools_[i].position();
  }
  const Eigen::Vector3d tip = tip_W();
  std::copy_n(tip.data(), 3, values.begin() + 12);
  if (power_unit_) {
    values[15] = power_unit_->speed_radps();
    values[16] = power_unit_->torque_nm();
    values[17] = power_unit_->pump_flow_m3ps();
  }
}

std::vector<BodyPoint> Excavator::body_points() const {
  constexpr double kSpacing_m = 0.1;
  std::vector<BodyPoint> points;
  const auto along_x = [&](Link which, double length_m) {
    const auto steps = static_cast<int>(std::ceil(length_m / kSpacing_m));
    for (int i = 0; i <= steps; ++i) {
      points.push_back({kExcavatorLinks[static_cast<std::size_t>(which)],
                        link(which).X_WL * Eigen::Vector3d(length_m * i / steps, 0.0, 0.0)});
    }
  };
  along_x(Link::boom, parameters_.boom_length_m);
  along_x(Link::stick, parameters_.stick_length_m);
  along_x(Link::bucket, parameters_.bucket_tip_m);
  return points;
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

Eigen::Vector3d Excavator::tip_W() const {
  return X_WC_ * arm_.dynamics().tip_C(state_.q_rad);
}

void Excavator::set_payload_kg(double mass_kg) {
  if (!std::isnan(mass_kg)) {
    arm_.dynamics().set_payload_kg(mass_kg);
  }
}

}  // namespace rigwire::sim
