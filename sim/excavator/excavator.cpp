#include "sim/excavator/excavator.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "sim/inner_steps.h"

namespace rigwire::sim {

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
// Level quasi_static: gains of the drives relative to those that stop their mass within a step.
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
/// Number of fields without the engine's: pumps are constant.
constexpr std::size_t kWithoutEngine = 4;

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

/// An upright pose on a moving carrier leans as the ground does under its wheels or its tracks'
/// ends; a pose that leans already is taken as it is. Height counts from the terrain at the origin.
Eigen::Isometry3d laid_on_ground(const ExcavatorParameters& parameters,
                                 const Eigen::Isometry3d& X_WC, const Ground* ground) {
  if (ground == nullptr || parameters.carrier != ExcavatorCarrier::moving ||
      !rigid(X_WC).linear().col(2).isApprox(Eigen::Vector3d::UnitZ(), 1e-9)) {
    return rigid(X_WC);
  }
  const bool tracks = parameters.running_gear == RunningGear::tracks;
  const double length_m = tracks ? parameters.tracks.length_m : parameters.wheels.wheelbase_m;
  const double width_m = tracks ? parameters.tracks.gauge_m : parameters.wheels.track_m;
  const double step_m =
      tracks ? parameters.tracks.end_radius_m : parameters.wheels.tyre.unloaded_radius_m;
  std::array<Eigen::Vector3d, 4> foot;  // Front left, front right, rear left, rear right.
  for (std::size_t i = 0; i < foot.size(); ++i) {
    foot[i] = X_WC * Eigen::Vector3d((i < 2 ? 0.5 : -0.5) * length_m,
                                     (i % 2 == 0 ? 0.5 : -0.5) * width_m, 0.0);
    const double ceiling_m = ground->height_m(foot[i].x(), foot[i].y()) + step_m;
    foot[i].z() = ground->at(foot[i].x(), foot[i].y(), ceiling_m).height_m;
  }
  Eigen::Isometry3d laid = X_WC;
  const Eigen::Vector3d along = foot[0] + foot[1] - foot[2] - foot[3];
  const Eigen::Vector3d across = foot[0] + foot[2] - foot[1] - foot[3];
  if (along.z() != 0.0 || across.z() != 0.0) {
    laid.linear().col(0) = along.normalized();
    laid.linear().col(2) = along.cross(across).normalized();
    laid.linear().col(1) = laid.linear().col(2).cross(laid.linear().col(0));
  }
  const Eigen::Vector3d& place = X_WC.translation();
  const double mean_m = 0.25 * (foot[0].z() + foot[1].z() + foot[2].z() + foot[3].z());
  laid.translation().z() += mean_m - ground->height_m(place.x(), place.y());
  return laid;
}

Eigen::Vector3d gravity_in(const Eigen::Isometry3d& X_WC, double gravity_mps2) {
  return X_WC.linear().transpose() * Eigen::Vector3d(0.0, 0.0, -gravity_mps2);
}

Eigen::Index row(std::size_t section) {
  return static_cast<Eigen::Index>(section);
}

// Level chambers: what gears, ring and seals of the swing take of the motor's torque at relief, an
// estimate (planetary gears of two stages lose 2 % each, a piston motor 3 % to 5 %).
constexpr double kSwingDrag = 0.08;
constexpr double kTipMass_kg = 1500.0;  // What the teeth move as, by which contacts are damped.
constexpr double kCushionFloor = 0.1;   // Share of the flow left at the very end of the stroke.
// Level quasi_static: within this time a cylinder is back where the oil it got says it is.
constexpr double kReturn_s = 0.1;
constexpr std::array<const char*, kArmJoints> kJointNames{"swing", "boom", "stick", "bucket"};

}  // namespace

Excavator::Excavator(const ExcavatorParameters& parameters, const Eigen::Isometry3d& X_WC,
                     const Ground* ground)
    : parameters_(validated(parameters)),
      X_WC_(laid_on_ground(parameters_, X_WC, ground)),
      arm_(parameters, gravity_in(X_WC_, parameters.gravity_mps2)),
      actuators_(excavator_actuators(parameters_)),
      spools_{Spool(parameters.swing_spool), Spool(parameters.boom_spool),
              Spool(parameters.stick_spool), Spool(parameters.bucket_spool)},
      inner_span_(std::max(Duration{1}, from_seconds(parameters.step_s))) {
  if (parameters.pumps == ExcavatorPumps::engine) {
    power_unit_.emplace(parameters.power_unit, parameters.supply);
  }
  make_drives();
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
  // A viscous damper of the oil's mode would hold a joint without ends back for good.
  const double swing_drag_nm = kSwingDrag * parameters.swing_displacement_m3prad *
                               parameters.supply.swing_relief_pressure_pa;
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
        friction[row(i)], i == 0 ? swing_drag_nm : std::numeric_limits<double>::infinity());
    chambers_[i].set_pressures(port_pressures(force_[row(i)], areas_[i].bottom, areas_[i].rod_side,
                                              parameters.supply.tank_pressure_pa));
  }
  update_pressures(std::numeric_limits<double>::infinity());
  if (ground != nullptr && !parameters.solid.boxes.empty()) {
    std::vector<ContactBody> bodies =
        contact_bodies(parameters.solid, kExcavatorLinks, kTipMass_kg);
    // The bucket digs (BucketSoil); without forces nothing holds the arm up.
    constexpr std::size_t kBucket = kLinks - 1;
    for (ContactBody& body : bodies) {
      body.meets_terrain = parameters.level != ExcavatorLevel::kinematic && body.link != kBucket &&
                           (body.link != 0 || parameters.carrier == ExcavatorCarrier::moving);
    }
    contact_.emplace(std::move(bodies), kLinks, *ground);
    arm_contacts_.reserve(kMostContactPoints + OwnContact::kMostPoints);
    contact_parts_ = contact_parts(parameters.solid, lightest_solid_kg(parameters),
                                   parameters.step_s, kMostContactParts);
  }
  if (parameters.strikes_itself) {
    own_.emplace(contact_bodies(parameters.solid, kExcavatorLinks, kTipMass_kg));
    arm_contacts_.reserve(kMostContactPoints + OwnContact::kMostPoints);
    contact_parts_ = contact_parts(parameters.solid, lightest_solid_kg(parameters),
                                   parameters.step_s, kMostContactParts);
  }
  if (parameters.carrier == ExcavatorCarrier::moving) {
    if (ground == nullptr) {
      throw std::invalid_argument("excavator: carrier moving needs a ground to stand on");
    }
    carried_.emplace(parameters, *ground, X_WC_);
    settle_on_ground();
  }
  update_links();
}

void Excavator::make_drives() {
  if (parameters_.carrier == ExcavatorCarrier::moving) {
    double mass_kg = 0.0;
    for (const RigidBodyParameters* link :
         {&parameters_.undercarriage, &parameters_.upper, &parameters_.boom, &parameters_.stick,
          &parameters_.bucket}) {
      mass_kg += link->mass_kg;
    }
    for (std::size_t i = 0; i < kTracks && parameters_.running_gear == RunningGear::tracks; ++i) {
      drives_.emplace_back(parameters_, parameters_.tracks, 0.5 * mass_kg);
    }
    for (const SupportParameters& support : parameters_.supports) {
      drives_.emplace_back(parameters_, support, 0.25 * mass_kg);
    }
  }
  requests_m3ps_.resize(kArmJoints + drives_.size());
  const auto fields =
      std::span(kTruthFields).first(power_unit_ ? kTruthFields.size() : kWithoutEngine);
  truth_fields_.assign(fields.begin(), fields.end());
  const std::size_t supports = parameters_.supports.size();
  if (drives_.size() > supports) {
    for (const char* key : {"track_m", "track_mps", "track_load_n"}) {
      truth_fields_.push_back({key, kTracks});
    }
  }
  if (!drives_.empty() && supports > 0) {
    truth_fields_.push_back({"support_m", supports});
    truth_fields_.push_back({"support_load_n", supports});
  }
  if (parameters_.strikes_itself) {
    truth_fields_.push_back({"own_contact_n", 1});
  }
}

void Excavator::settle_on_ground() {
  // First with heavy damping, so that the machine does not drop onto its springs, then free: an
  // unstable machine moves.
  constexpr double kSyrup_s = 3.0;
  constexpr double kSyrup_radps = 10.0;
  constexpr double kFree_s = 2.0;
  constexpr double kStep_s = 2e-3;
  const Eigen::Isometry3d put = X_WC_;
  const double kept = std::exp(-kSyrup_radps * kStep_s);
  for (int i = 0; i < static_cast<int>(kSyrup_s / kStep_s) && !non_finite_; ++i) {
    inner_step(kStep_s);
    state_.v_radps *= kept;
    carried_->set_velocity(kept * carried_->w_C(), kept * carried_->v_C());
  }
  for (int i = 0; i < static_cast<int>(kFree_s / kStep_s) && !non_finite_; ++i) {
    inner_step(kStep_s);
  }
  unsteady_start_ = unsteadiness(put);
  state_.v_radps.setZero();
  acceleration_.setZero();
  position_rate_.setZero();
  for (CarrierDrive& drive : drives_) {
    drive.stop();
  }
  carried_->place(X_WC_);
}

std::string Excavator::unsteadiness(const Eigen::Isometry3d& put) const {
  // What tyres and soil give is less.
  constexpr double kMostLean_deg = 5.0;
  constexpr double kMostSlide_m = 0.15;
  constexpr double kMostSliding_mps = 0.01;
  constexpr double kMostTurning_degps = 0.5;
  const auto degrees = [](double cosine) {
    return kDegrees * std::acos(std::clamp(cosine, -1.0, 1.0));
  };
  const Eigen::Vector3d up = put.linear().col(2);
  const auto along_ground = [&up](const Eigen::Vector3d& way) {
    return (way - up.dot(way) * up).norm();
  };
  const double lean_deg = degrees(up.dot(X_WC_.linear().col(2)));
  const double slid_m = along_ground(X_WC_.translation() - put.translation());
  const double sliding_mps = along_ground(X_WC_.linear() * carried_->v_C());
  const double turning_degps = kDegrees * carried_->w_C().norm();
  const auto say = [slope_deg = degrees(up.z())](const char* what, double found, double allowed,
                                                 const char* unit) {
    std::array<char, 160> text{};
    (void)std::snprintf(text.data(), text.size(),
                        "on ground that slopes %.1f deg it %s, found %.3g %s after 5 s, "
                        "allowed %.3g %s",
                        slope_deg, what, found, unit, allowed, unit);
    return std::string(text.data());
  };
  if (lean_deg > kMostLean_deg) {
    return say("tips over", lean_deg, kMostLean_deg, "deg");
  }
  if (slid_m > kMostSlide_m) {
    return say("slides", slid_m, kMostSlide_m, "m");
  }
  if (sliding_mps > kMostSliding_mps) {
    return say("slides", sliding_mps, kMostSliding_mps, "m/s");
  }
  if (turning_degps > kMostTurning_degps) {
    return say("tips over", turning_degps, kMostTurning_degps, "deg/s");
  }
  return {};
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
  for (std::size_t k = 0; k < drives_.size(); ++k) {
    const std::size_t i = kArmJoints + k;
    command_.floating[i] = command.floating[i];
    if (!drives_[k].command(command.opening[i], command.floating[i])) {
      ++refused_commands_;
    }
    if (!std::isnan(command.opening[i])) {
      command_.opening[i] = std::clamp(command.opening[i], -1.0, 1.0);
    }
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
    } else if (i < kArmJoints + drives_.size()) {
      const CarrierDrive& drive = drives_[i - kArmJoints];
      sample.spool_position[i] = drive.spool();
      sample.port_a_pressure_pa[i] = drive.ports().a_pa;
      sample.port_b_pressure_pa[i] = drive.ports().b_pa;
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
  auto own = values.subspan(power_unit_ ? 18 : 15);
  const std::size_t supports = drives_.empty() ? 0 : parameters_.supports.size();
  const std::size_t tracks = drives_.size() - supports;
  for (std::size_t k = 0; k < tracks; ++k) {
    own[k] = drives_[k].position_m();
    own[tracks + k] = drives_[k].rate_mps();
    own[2 * tracks + k] = carried_->track_load_n(k);
  }
  own = own.subspan(3 * tracks);
  for (std::size_t k = 0; k < supports; ++k) {
    own[k] = drives_[tracks + k].position_m();
    const auto pads = carried_->pad_loads_n().subspan(2 * k, 2);
    own[supports + k] = pads[0] + pads[1];
  }
  if (own_) {
    own[2 * supports] = own_->force_n();
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

// One inner step of the excavator, on each of its levels.

void Excavator::inner_step(double h) {
  meet_obstacles(h);
  int parts = 1;
  const bool touches = near_ && contact_->touching();
  const bool touches_itself = near_itself_ && own_->touching();
  if (touches || touches_itself) {
    parts = contact_parts_;
    h /= parts;
  }
  if (touches) {
    contact_->shorten(h);
  }
  if (touches_itself) {
    own_->shorten(h);
  }
  part_step(h);
  for (int i = 1; i < parts && !non_finite_; ++i) {
    meet_obstacles(h);
    part_step(h);
  }
}

void Excavator::part_step(double h) {
  for (Spool& spool : spools_) {
    spool.step(h);
  }
  for (CarrierDrive& drive : drives_) {
    drive.step_spool(h);
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
  for (const CarrierDrive& drive : drives_) {
    taken_m3ps += std::abs(drive.flow_m3ps());
  }
  power_unit_->step(h, taken_m3ps, supply_pressure_pa_);
}

void Excavator::share_flow() {
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    flow_[i] = floating_[i] ? 0.0 : limited_flow(i, spools_[i].flow_request_m3ps());
    requests_m3ps_[i] = flow_[i];
  }
  for (std::size_t k = 0; k < drives_.size(); ++k) {
    requests_m3ps_[kArmJoints + k] = drives_[k].flow_request_m3ps();
  }
  const SupplyParameters& supply = power_unit_ ? power_unit_->supply() : parameters_.supply;
  const double share = flow_share(supply, requests_m3ps_, supply_pressure_pa_);
  for (double& flow : flow_) {
    flow *= share;
  }
  for (std::size_t k = 0; k < drives_.size(); ++k) {
    drives_[k].grant(share * requests_m3ps_[kArmJoints + k]);
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

void Excavator::meet_obstacles(double h) {
  arm_.load.contacts = {};
  near_ = false;
  near_itself_ = false;
  if (!contact_ && !own_) {
    return;
  }
  // No point of the machine is faster than its arm stretched out at the sum of all rates.
  const double reach_m =
      3.0 + parameters_.boom_length_m + parameters_.stick_length_m + 2.0 * parameters_.bucket_tip_m;
  double fastest_mps = reach_m * state_.v_radps.cwiseAbs().sum();
  // Half as much again, and some, for what changes within the step.
  near_itself_ = own_ && own_->near(h, 1.5 * fastest_mps + 0.1);
  if (carried_) {
    // Half as much again for what changes within the step.
    fastest_mps += 1.5 * (carried_->v_C().norm() + reach_m * carried_->w_C().norm()) + 0.1;
  }
  near_ = contact_ && contact_->near(h, fastest_mps);
  if (!near_ && !near_itself_) {
    return;
  }
  const auto begin = [&] {
    if (near_) {
      contact_->begin(h, contact_links_);
    }
    if (near_itself_) {
      own_->begin(h, contact_links_);
    }
  };
  if (carried_) {
    carried_->place_contact_links(state_, contact_links_);
    begin();
    return;
  }
  const auto motion = arm_.dynamics().motion(state_.q_rad, state_.v_radps, JointVector::Zero());
  const Eigen::Matrix3d R_WC = X_WC_.linear();
  contact_links_[0].X_WL = X_WC_;
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    ContactLink& link = contact_links_[i + 1];
    link.X_WL.linear() = R_WC * motion[i].R_CB;
    link.X_WL.translation() = X_WC_ * motion[i].p_CB_C;
    link.v_WL_W = R_WC * motion[i].v_CB_C;
    link.w_WL_W = R_WC * motion[i].w_CB_C;
  }
  begin();
  arm_contacts_.clear();
  if (near_) {
    for (ContactPoint& point : contact_->points()) {
      add_arm_contact(point, 0);
    }
  }
  if (near_itself_) {
    const std::span<ContactPoint> points = own_->points();
    for (std::size_t i = 0; i < points.size(); ++i) {
      add_arm_contact(points[i], own_->inner_link(i));
    }
  }
  arm_.load.contacts = arm_contacts_;
}

void Excavator::add_arm_contact(ContactPoint& point, std::size_t inner_link) {
  ArmContact& contact = arm_contacts_.emplace_back();
  contact.point = &point;
  const Eigen::Vector3d raise_W = -contact_links_[1].X_WL.linear().col(1);
  const Eigen::Vector3d up_W = X_WC_.linear().col(2);
  for (std::size_t k = 0; k < 3; ++k) {
    contact.rows[k].setZero();
    // A joint turns what hangs on it about its axis: row_j = direction . (axis_j x (p - origin_j));
    // of two of its links only what hangs between them counts.
    for (std::size_t j = inner_link; j < point.link; ++j) {
      const Eigen::Vector3d axis_W = j == 0 ? up_W : raise_W;
      const Eigen::Vector3d arm_W = point.p_W - contact_links_[j + 1].X_WL.translation();
      contact.rows[k][row(j)] = point.direction_W[k].dot(axis_W.cross(arm_W));
    }
  }
}

void Excavator::settle_contacts(double h, const ArmState& next) {
  if (carried_) {
    return;
  }
  const std::size_t with_obstacles = near_ ? contact_->points().size() : 0;
  if (near_) {
    contact_->settle(h, [&](const ContactPoint& point) {
      return arm_contacts_[static_cast<std::size_t>(&point - contact_->points().data())].along(
          next.v_radps);
    });
  }
  if (near_itself_) {
    own_->settle(
        h, [&](std::size_t i) { return arm_contacts_[with_obstacles + i].along(next.v_radps); });
  }
}

double Excavator::free_share(double h, const JointVector& rate) {
  const JointVector v = rate.cwiseQuotient(pose_.lever);
  double share = 1.0;
  for (const ArmContact& contact : arm_.load.contacts) {
    ContactPoint& point = *contact.point;
    point.released = true;
    const double closing_m = -h * contact.rows[0].dot(v);
    const double room_m = std::max(0.0, point.gap_m);
    if (closing_m > room_m) {
      share = std::min(share, room_m / closing_m);
      point.blocks = true;
    }
  }
  return share;
}

void Excavator::step_kinematic(double h, const JointVector& wanted) {
  const JointVector rate = free_share(h, wanted) * wanted;
  // Newton's step towards the length that the oil makes: what is left of it is of second order and
  // belongs to the next step.
  ArmState next = state_;
  next.q_rad += (target_ + h * rate - pose_.x).cwiseQuotient(pose_.lever);
  const ArmPose there = arm_.pose(next.q_rad);
  next.v_radps = rate.cwiseQuotient(there.lever);
  ArmStep step;
  step.acceleration_radps2 = (next.v_radps - state_.v_radps) / h;
  settle_contacts(h, next);
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
  // Eq. 5 with the target moved on by the oil, x_t(t + h) = x_t + h Q / A.
  const ArmStep step = advance(h, arm_.laws(pose_, h, target_ + h * rate, rate), next);
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
    const ValveDemand demand{flow_[i], floating_[i], supply_pressure_pa_, supply.tank_pressure_pa,
                             relief};
    laws.force[i] = chambers_[i].law(h, pose_.x[row(i)], demand);
    const auto [least, greatest] = chambers_[i].limits(demand, position_rate_[row(i)]);
    laws.least[row(i)] = least;
    laws.greatest[row(i)] = greatest;
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
  if (carried_) {
    const std::size_t tracks = drives_.size() - parameters_.supports.size();
    for (std::size_t k = 0; k < drives_.size(); ++k) {
      drives_[k].begin(h, supply_pressure_pa_, k < tracks ? carried_->track_load_n(k) : 0.0);
    }
    return carried_->step(h, arm_, pose_, laws, bucket_load_, next, near_ ? &*contact_ : nullptr,
                          drives_, near_itself_ ? &*own_ : nullptr);
  }
  ArmStep step = arm_.advance(h, pose_, laws, next);
  settle_contacts(h, next);
  return step;
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
  for (std::size_t k = 0; k < drives_.size() && !non_finite_; ++k) {
    if (!drives_[k].finite()) {
      non_finite_ = NonFinite{"drive", actuators_[kArmJoints + k].data(), time_};
    }
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
  for (CarrierDrive& drive : drives_) {
    drive.update_ports();
    const double asked = drive.asked_m3ps();
    if (asked != 0.0) {
      highest = std::max(highest, asked > 0.0 ? drive.ports().a_pa : drive.ports().b_pa);
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
