#include "sim/roller/tandem_roller.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "sim/inner_steps.h"

namespace rigwire::sim {

namespace {

const RollerParameters& validated(const RollerParameters& parameters) {
  validate(parameters);
  return parameters;
}

// Rotation by the vector r, accurate near zero.
Eigen::Quaterniond exponential(const Eigen::Vector3d& r) {
  const double angle2 = r.squaredNorm();
  const double half = 0.5 * std::sqrt(angle2);
  const double factor = angle2 < 1e-8 ? 0.5 - angle2 / 48.0 : 0.5 * std::sin(half) / half;
  return {std::cos(half), factor * r.x(), factor * r.y(), factor * r.z()};
}

Eigen::Quaterniond turned(const Eigen::Quaterniond& q, const Eigen::Vector3d& r) {
  if (r.isZero(0.0)) {
    return q;
  }
  Eigen::Quaterniond result = q * exponential(r);
  result.coeffs() *= 1.5 - 0.5 * result.squaredNorm();  // First-order return to unit length.
  return result;
}

// sin(a)/a and (1 - cos(a))/a.
std::array<double, 2> arc(double a) {
  if (std::abs(a) < 1e-4) {
    return {1.0 - a * a / 6.0, 0.5 * a * (1.0 - a * a / 12.0)};
  }
  return {std::sin(a) / a, (1.0 - std::cos(a)) / a};
}

void take(double& kept, double wanted, double low, double high) {
  if (std::isfinite(wanted)) {
    kept = std::clamp(wanted, low, high);
  }
}

constexpr double kRutReach_m = 0.3;  // beyond what a drum presses under itself
constexpr double kSteep = 0.87;      // Cosine, 30 degrees about the frame's z.
constexpr double kDegrees = 180.0 / std::numbers::pi;

constexpr std::array<StatusQuantity, 8> kStatus{{{"speed", "km/h"},
                                                 {"front steer", "deg"},
                                                 {"rear steer", "deg"},
                                                 {"pressure", "bar"},
                                                 {"engine", "rpm"},
                                                 {"sliding strips", ""},
                                                 {"water", "kg"},
                                                 {"chips", "kg"}}};

constexpr std::array<TruthField, 10> kTruth{{{"drum_rate_radps", 2},
                                             {"steer_rad", 2},
                                             {"drum_load_n", 2},
                                             {"pivot_moment_nm", 2},
                                             {"slip_loss_w", 2},
                                             {"pressure_pa", 1},
                                             {"engine_speed_radps", 1},
                                             {"water_kg", 1},
                                             {"chips_kg", 1},
                                             {"tipped", 1}}};

// Motion of a frame at r in `base`, moving along r with rate and acceleration, axes as base's.
LinkMotion carried(const LinkMotion& base, const Eigen::Vector3d& r, const Eigen::Vector3d& rate,
                   const Eigen::Vector3d& acceleration) {
  const Eigen::Matrix3d R = base.X_WL.linear();
  const Eigen::Vector3d r_W = R * r;
  const Eigen::Vector3d rate_W = R * rate;
  LinkMotion moved = base;
  moved.X_WL.translation() += r_W;
  // Relative motion: w x r + r', and alpha x r + w x (w x r) + 2 w x r' + r''.
  moved.v_WL_W += base.w_WL_W.cross(r_W) + rate_W;
  moved.a_WL_W += base.alpha_WL_W.cross(r_W) + base.w_WL_W.cross(base.w_WL_W.cross(r_W)) +
                  2.0 * base.w_WL_W.cross(rate_W) + R * acceleration;
  return moved;
}

// Returns the motion of a link with the same origin, turned by `angle` about an own axis (unit, in
// `base`).
LinkMotion rotated(const LinkMotion& base, const Eigen::Vector3d& axis, double angle, double rate,
                   double acceleration) {
  const Eigen::Vector3d axis_W = base.X_WL.linear() * axis;
  LinkMotion moved = base;
  moved.X_WL.linear() = base.X_WL.linear() * Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  // w + rate axis, alpha + rate' axis + rate (w x axis).
  moved.w_WL_W += rate * axis_W;
  moved.alpha_WL_W += acceleration * axis_W + rate * base.w_WL_W.cross(axis_W);
  return moved;
}

/// The boxes, and the drums as cylinders that roll.
std::vector<ContactBody> solid_bodies(const RollerParameters& p) {
  std::vector<ContactBody> bodies = contact_bodies(p.solid, kRollerLinks, p.mass_kg);
  for (std::size_t i = 3; i < kRollerLinks.size(); ++i) {
    ContactBody& drum = bodies.emplace_back(ContactBody{
        std::string(kRollerLinks[i]), i, Eigen::Isometry3d::Identity(),
        ConvexShape::cylinder(p.drum.radius_m, 0.5 * p.drum.width_m), p.solid.stiffness_npm,
        2.0 * p.solid.damping_ratio * std::sqrt(p.solid.stiffness_npm * p.mass_kg), p.solid.crush_n,
        p.solid.crush_npm, true});
    // The cylinder's z along the axle.
    drum.X_LS.linear() =
        Eigen::AngleAxisd(-0.5 * std::numbers::pi, Eigen::Vector3d::UnitX()).toRotationMatrix();
  }
  for (ContactBody& body : bodies) {
    body.meets_terrain = true;  // When it has tipped.
  }
  return bodies;
}

Eigen::Vector3d upward(double value) {
  return {0.0, 0.0, value};
}

}  // namespace

TandemRoller::TandemRoller(const RollerParameters& parameters, const Ground& ground,
                           const Eigen::Vector2d& position_m, double yaw_rad)
    : parameters_(validated(parameters)),
      ground_(&ground),
      inner_span_(std::max(Duration{1}, from_seconds(parameters.step_s))),
      engine_(parameters.engine),
      steering_{PivotSteering(parameters.steering), PivotSteering(parameters.steering)},
      vibration_{DrumVibration(parameters.front_vibration),
                 DrumVibration(parameters.rear_vibration)},
      sprinkler_(parameters.sprinkler),
      spreader_(parameters.spreader),
      cutter_(parameters.edge_cutter),
      drive_(parameters.drive, parameters.drum.radius_m),
      dynamics_(parameters),
      rest_(parameters, ground),
      mass_(
          loaded_mass(parameters, parameters.sprinkler.initial_kg, parameters.spreader.initial_kg)),
      contact_(solid_bodies(parameters), kRollerLinks.size(), ground),
      free_(parameters),
      pressure_pa_(parameters.drive.charge_pressure_pa) {
  contact_.carry(Carried::by_model);
  contacts_.reserve(kMostContactPoints);
  free_contacts_.reserve(kMostContactPoints);
  if (!position_m.allFinite() || !std::isfinite(yaw_rad)) {
    throw std::invalid_argument("roller: its place (x, y, yaw) must be finite numbers");
  }
  start_W_ << position_m, ground.height_m(position_m.x(), position_m.y());
  state_.q_WB = Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
  settle_on_ground();
  update_links();
}

// Newton's way down to the resting pose, then the bristles take up the slope.
void TandemRoller::settle_on_ground() {
  const auto position = [this] { return Eigen::Vector3d(start_W_ + state_.displacement_W); };
  for (int round = 0; round < 60; ++round) {
    const Eigen::Matrix3d R_WB = state_.q_WB.toRotationMatrix();
    rest_.look(position(), R_WB, {0.0, 0.0}, true);
    const RestMotion away = rest_.deviation();
    start_W_.z() += away.heave / R_WB(2, 2);
    state_.q_WB = turned(state_.q_WB, {away.roll, away.pitch, 0.0}).normalized();
    if (std::abs(away.heave) + std::abs(away.roll) + std::abs(away.pitch) < 1e-15) {
      break;
    }
  }
  rest_.look(position(), state_.q_WB.toRotationMatrix(), {0.0, 0.0}, true);
  hold_slope();
}

void TandemRoller::hold_slope() {
  const Eigen::Matrix3d R_WB = state_.q_WB.toRotationMatrix();
  for (int round = 0; round < 40; ++round) {  // Loads depend on the forces they carry.
    load_strips(R_WB, 0.0);
    dynamics_.preload(loads_, load_n_);
  }
}

void TandemRoller::command(const VehicleCommand& command) {
  const RollerParameters& p = parameters_;
  command_.time = command.time;
  command_.engine_control = command.engine_control;
  take(command_.engine_torque_share, command.engine_torque_share, 0.0, 1.0);
  take(command_.engine_speed_radps, command.engine_speed_radps, 0.0, p.drive.engine_rated_radps);
  command_.ignition = command.ignition;
  if (!command.travel_speed_mps) {
    command_.travel_speed_mps.reset();
  } else if (std::isfinite(*command.travel_speed_mps)) {
    command_.travel_speed_mps =
        std::clamp(*command.travel_speed_mps, -p.drive.speed_max_mps, p.drive.speed_max_mps);
  }
  if (command.engine_speed_limit_radps >= 0.0) {
    command_.engine_speed_limit_radps = command.engine_speed_limit_radps;
  }
  take(command_.brake_share, command.brake_share, 0.0, 1.0);
  command_.parking_brake = command.parking_brake;
  take(command_.front_steer_rad, command.front_steer_rad, -p.steering.angle_max_rad,
       p.steering.angle_max_rad);
  take(command_.rear_steer_rad, command.rear_steer_rad, -p.steering.angle_max_rad,
       p.steering.angle_max_rad);
  command_.lock = command.lock;
  command_.vibration = command.vibration;
  steering_[0].command(command_.front_steer_rad);
  steering_[1].command(command_.rear_steer_rad);
  vibration_[0].command(command_.vibration[0]);
  vibration_[1].command(command_.vibration[1]);
  cutter_.command(command.edge_cutter_share);
  spreader_.command(command.spreader_rate_kgpm2);
  command_drive();
}

void TandemRoller::command_drive() {
  const RollerParameters& p = parameters_;
  HydrostaticDemand demand;
  const double wanted = command_.parking_brake ? 0.0 : command_.travel_speed_mps.value_or(0.0);
  demand.travel_speed_mps = wanted + trim_mps_;
  demand.ignition = command_.ignition;
  const double idle = p.drive.engine_idle_radps;
  const double rated = p.drive.engine_rated_radps;
  if (command_.travel_speed_mps) {
    // The engine is the drive's: rated while it travels.
    demand.engine_speed_radps =
        std::min(command_.parking_brake ? idle : rated, command_.engine_speed_limit_radps);
  } else if (command_.engine_control == EngineControl::speed && command_.engine_speed_radps > 0.0) {
    demand.engine_speed_radps = command_.engine_speed_radps;
  } else if (command_.engine_control == EngineControl::torque &&
             command_.engine_torque_share > 0.0) {
    // The torque share represents the throttle: linear from idle to rated speed.
    demand.engine_speed_radps = idle + command_.engine_torque_share * (rated - idle);
  } else {
    demand.engine_speed_radps = command_.parking_brake ? idle : rated;
  }
  demand.flow_divider = command_.lock[static_cast<std::size_t>(Differential::centre)];
  drive_.command(demand);
}

void TandemRoller::set_motion(double forward_mps, double left_mps, double yaw_rate_radps) {
  state_.w_WB_B.z() = yaw_rate_radps;
  state_.v_WB_W = state_.q_WB * Eigen::Vector3d(forward_mps, left_mps, 0.0);
  for (std::size_t i = 0; i < 2; ++i) {
    const double x = i == 0 ? parameters_.pivot_x_m : -parameters_.pivot_x_m;
    const double d = steering_[i].angle_rad();
    // Rolling without slip: the pivot's velocity along the drum's heading over its radius.
    spin_radps_[i] = (forward_mps * std::cos(d) + (left_mps + yaw_rate_radps * x) * std::sin(d)) /
                     parameters_.drum.radius_m;
  }
  update_links();
}

void TandemRoller::step(Duration span) {
  if (span <= Duration{0} || non_finite_) {
    return;
  }
  run_inner_steps(span, inner_span_, time_, non_finite_, [this](double h) { inner_step(h); });
  update_links();
  update_dust();
}

void TandemRoller::hold_travel_speed(double h) {
  constexpr double kRest_mps = 0.02;
  constexpr double kTrimPerS = 0.5;
  constexpr double kMostTrim_mps = 0.3;
  constexpr double kBrakePerS = 4.0;
  constexpr double kMissing_mps = 0.1;
  constexpr double kMissing_s = 1.0;
  const double before_mps = trim_mps_;
  bool holds = false;
  const bool controls = parameters_.travel_control && command_.travel_speed_mps.has_value();
  if (!controls || command_.parking_brake) {
    trim_mps_ = 0.0;
    missing_s_ = 0.0;
  } else {
    const double wanted_mps = *command_.travel_speed_mps;
    const double speed_mps = odometry().speed_mps;
    const double ramped_mps = drive_.set_point_mps() - trim_mps_;
    holds = wanted_mps == 0.0 && std::abs(ramped_mps) < kRest_mps &&
            (holding_ || std::abs(speed_mps) < kRest_mps);
    const double missing_mps = ramped_mps - speed_mps;
    // Integral of what is missing, as a trim of the set point; none at rest.
    trim_mps_ = wanted_mps == 0.0 ? 0.0
                                  : std::clamp(trim_mps_ + h * kTrimPerS * missing_mps,
                                               -kMostTrim_mps, kMostTrim_mps);
    missing_s_ = std::abs(missing_mps) > kMissing_mps ? missing_s_ + h : 0.0;
    travel_limit_ = missing_s_ < kMissing_s          ? TravelLimit::none
                    : missing_mps * wanted_mps > 0.0 ? TravelLimit::power
                                                     : TravelLimit::braking;
  }
  if (missing_s_ == 0.0) {
    travel_limit_ = TravelLimit::none;
  }
  holding_ = holds;
  const double held = std::max(command_.brake_share, holding_ ? 1.0 : 0.0);
  // The service brake's way; opening and closing take time.
  brake_share_ = controls && std::abs(held - brake_share_) > kBrakePerS * h
                     ? brake_share_ + std::copysign(kBrakePerS * h, held - brake_share_)
                     : held;
  if (trim_mps_ != before_mps) {
    command_drive();
  }
}

void TandemRoller::inner_step(double h) {
  // A blow is short, whatever the machine's step.
  constexpr double kLongestFree_s = 1e-3;
  const int parts =
      tipped_ ? std::max(1, static_cast<int>(std::ceil(h / kLongestFree_s - 1e-9))) : 1;
  for (int i = 0; i < parts && !non_finite_; ++i) {
    part_step(h / parts);
  }
}

/// Follows the chain at the top of tandem_roller.h.
void TandemRoller::part_step(double h) {
  hold_travel_speed(h);
  const Eigen::Matrix3d R_WB = state_.q_WB.toRotationMatrix();
  const Eigen::Vector3d v_B = R_WB.transpose() * state_.v_WB_W;
  for (std::size_t i = 0; i < 2; ++i) {
    steering_[i].step(h);
    vibration_[i].step(h);
  }
  supplements(h, v_B.x());
  limit_climbs(v_B.x());
  rest_.look(start_W_ + state_.displacement_W, R_WB,
             {steering_[0].angle_rad(), steering_[1].angle_rad()});

  const RestMotion rest{v_B.z(), state_.w_WB_B.x(), state_.w_WB_B.y()};
  const std::array<double, 2> spin_before = spin_radps_;
  State next;
  if (parameters_.level == RollerLevel::kinematic) {
    meet_obstacles(h, R_WB);
    move_kinematic(h, R_WB, rest, next);
  } else {
    if (tipped_ ? stands_again(h, R_WB) : loses_its_footing(h, R_WB)) {
      tipped_ ? stand() : tip();
    }
    if (tipped_) {
      move_tipped(h, R_WB, next);
    } else {
      meet_obstacles(h, R_WB);
      load_strips(R_WB, v_B.x());
      move_dynamic(h, R_WB, rest, next);
    }
  }
  if (record_non_finite(next)) {
    spin_radps_ = spin_before;
    return;
  }
  state_ = next;
  const EngineSample engine = drive_.engine_sample();
  const double indicated_nm = engine.torque_nm + engine.friction_nm;
  engine_.step(h, engine.speed_radps, indicated_nm,
               indicated_nm / (engine.full_load_nm + engine.friction_nm));
  for (std::size_t i = 0; i < 2; ++i) {
    spin_acceleration_radps2_[i] = (spin_radps_[i] - spin_before[i]) / h;
    spin_angle_rad_[i] += h * spin_radps_[i];
    if (std::abs(spin_angle_rad_[i]) > std::numbers::pi) {
      spin_angle_rad_[i] = std::remainder(spin_angle_rad_[i], 2.0 * std::numbers::pi);
    }
  }
}

/// Sets what each drum climbs: the other one pushes with its friction on the ground below it.
void TandemRoller::limit_climbs(double speed_mps) {
  for (std::size_t i = 0; i < 2; ++i) {
    RollingClimb climb;
    climb.radius_m = parameters_.drum.radius_m;
    climb.grip = parameters_.drum.friction_factor;
    climb.helped_rad = std::atan(climb.grip * rest_.friction(1 - i));
    climb.run_m = speed_mps * speed_mps / std::max(1.0, parameters_.gravity_mps2);
    rest_.limit(i, climb);
    contact_.climb(contact_.bodies().size() - 2 + i, climb);  // The last two (solid_bodies()).
  }
}

bool TandemRoller::place_bodies(double h, const Eigen::Matrix3d& R_WB) {
  const double reach =
      2.0 * parameters_.pivot_x_m + 2.0 * parameters_.drum.radius_m + parameters_.drum.width_m;
  near_ = contact_.near(h, state_.v_WB_W.norm() + reach * state_.w_WB_B.norm() + 0.1);
  if (!near_) {
    return false;
  }
  const Eigen::Vector3d p_W = start_W_ + state_.displacement_W;
  const Eigen::Vector3d w_W = R_WB * state_.w_WB_B;
  const auto put = [&](ContactLink& link, const Eigen::Vector3d& p_B, double turn_rad) {
    link.X_WL.linear() =
        R_WB * Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    link.X_WL.translation() = p_W + R_WB * p_B;
    link.v_WL_W = state_.v_WB_W + w_W.cross(R_WB * p_B);
    link.w_WL_W = w_W;
  };
  put(contact_links_[0], Eigen::Vector3d::Zero(), 0.0);
  for (std::size_t i = 0; i < 2; ++i) {
    const Eigen::Vector3d axle(i == 0 ? parameters_.pivot_x_m : -parameters_.pivot_x_m, 0.0,
                               parameters_.drum.radius_m);
    put(contact_links_[1 + i], axle, steering_[i].angle_rad());
    contact_links_[3 + i] = contact_links_[1 + i];
  }
  contact_.begin(h, contact_links_);
  return true;
}

void TandemRoller::meet_obstacles(double h, const Eigen::Matrix3d& R_WB) {
  loads_.contacts = {};
  if (!place_bodies(h, R_WB)) {
    return;
  }
  const Eigen::Vector3d p_W = start_W_ + state_.displacement_W;
  contacts_.clear();
  const Eigen::Vector3d c(mass_.x_m, 0.0, 0.0);
  const Eigen::Vector3d v_C_B = R_WB.transpose() * state_.v_WB_W + state_.w_WB_B.cross(c);
  RollerVelocity start;
  start << v_C_B.x(), v_C_B.y(), state_.w_WB_B.z(), spin_radps_[0], spin_radps_[1];
  for (ContactPoint& point : contact_.points()) {
    RollerContact& contact = contacts_.emplace_back();
    contact.point = &point;
    const Eigen::Vector3d p_C = R_WB.transpose() * (point.p_W - p_W) - c;
    // It moves in the frame's plane: what pushes it up or down more than along does not hold it.
    const bool steep = std::abs(R_WB.col(2).dot(point.direction_W[0])) > kSteep;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d d = R_WB.transpose() * point.direction_W[k];
      RollerVelocity& row = contact.rows[k];
      row.setZero();
      if (steep) {
        continue;
      }
      row[0] = d.x();
      row[1] = d.y();
      row[2] = p_C.x() * d.y() - p_C.y() * d.x();
      if (point.link >= 3) {
        const Eigen::Vector3d arm = point.p_W - contact_links_[point.link].X_WL.translation();
        row[static_cast<Eigen::Index>(point.link)] =
            point.direction_W[k].dot(contact_links_[point.link].X_WL.linear().col(1).cross(arm));
      }
    }
    point.begin(h, contact.along(start));
    if (steep) {
      point.law.greatest_n = 0.0;
      point.blocks = point.gap_m < 0.0;
    }
  }
  loads_.contacts = contacts_;
}

void TandemRoller::settle_contacts(double h, const RollerVelocity& found) {
  if (near_) {
    contact_.settle(h, [&](const ContactPoint& point) {
      return contacts_[static_cast<std::size_t>(&point - contact_.points().data())].along(found);
    });
  }
}

void TandemRoller::supplements(double h, double speed_mps) {
  sprinkler_.step(h, speed_mps);
  spreader_.step(h, speed_mps);
  cutter_.step(h);
  mass_ = loaded_mass(parameters_, sprinkler_.mass_kg(), spreader_.mass_kg());
}

std::array<double, 2> TandemRoller::brake_limits_nm() const {
  std::array<double, 2> limit{};
  limit.fill(std::max(command_.parking_brake ? parameters_.parking_brake_torque_nm : 0.0,
                      brake_share_ * parameters_.brake_torque_nm));
  return limit;
}

void TandemRoller::load_strips(const Eigen::Matrix3d& R_WB, double speed_mps) {
  const RollerParameters& p = parameters_;
  loads_.torque.brake_nm = brake_limits_nm();
  loads_.mass = mass_;
  const double g = p.gravity_mps2;
  // Gravity along the frame; cutter's side force with its yaw moment about the centre of mass.
  loads_.gravity_mps2 = -g * R_WB.row(2).head<2>().transpose();
  const double cutter_n = cutter_.lateral_n(speed_mps);
  loads_.supplement = {0.0, cutter_n, cutter_n * (p.edge_cutter.x_m - mass_.x_m)};

  // Statics about the centre of mass: what pushes at the ground tilts the load.
  const double normal = mass_.mass_kg * g * R_WB(2, 2);
  const Eigen::Vector2d push = dynamics_.ground_force_n() + Eigen::Vector2d(0.0, cutter_n);
  const double base = 2.0 * p.pivot_x_m;
  const double front = (normal * (p.pivot_x_m + mass_.x_m) - mass_.height_m * push.x()) / base;
  load_n_[0] = std::clamp(front, 0.0, normal);
  load_n_[1] = normal - load_n_[0];
  const double tilt = -mass_.height_m * push.y();  // Sum of strip load times strip y.

  const auto strips = static_cast<std::size_t>(p.drum.strips);
  const double strip_width = p.drum.width_m / static_cast<double>(strips);
  for (std::size_t i = 0; i < 2; ++i) {
    DrumSituation& drum = loads_.drum[i];
    drum.x_m = (i == 0 ? p.pivot_x_m : -p.pivot_x_m) - mass_.x_m;
    drum.steer_rad = steering_[i].angle_rad();
    drum.steer_rate_radps = steering_[i].mean_rate_radps();
    drum.spin_radps = spin_radps_[i];
    const DrumContact& contact = dynamics_.drum(i);
    // Load linear in y over the strips that bear, with the drum's share of the tilting moment; none
    // negative.
    const auto bears = [&](std::size_t k) { return rest_.strip(i * strips + k).bears(); };
    std::size_t bearing = 0;
    double middle = 0.0;
    for (std::size_t k = 0; k < strips; ++k) {
      bearing += bears(k) ? 1 : 0;
      middle += bears(k) ? contact.strip_y_m(static_cast<int>(k)) : 0.0;
    }
    const auto count_bearing = static_cast<double>(bearing);
    middle = bearing == strips ? 0.0 : middle / count_bearing;
    double square = 0.0;
    for (std::size_t k = 0; k < strips; ++k) {
      const double y = contact.strip_y_m(static_cast<int>(k)) - middle;
      square += bears(k) ? y * y : 0.0;
    }
    const double mean = load_n_[i] / count_bearing;
    const double share = normal > 0.0 ? load_n_[i] / normal : 0.0;
    const double slope =
        square > 0.0 && normal > 0.0 ? (tilt * share - middle * load_n_[i]) / square : 0.0;
    double sum = 0.0;
    for (std::size_t k = 0; k < strips; ++k) {
      const double y = contact.strip_y_m(static_cast<int>(k)) - middle;
      drum.load_n[k] = bears(k) ? std::max(0.0, mean + slope * y) : 0.0;
      sum += drum.load_n[k];
    }
    const double scale = sum > 0.0 ? load_n_[i] / sum : 0.0;
    double rolling_n = 0.0;
    double ploughing_n = 0.0;
    // Where the drum rolls to; it presses every strip's ground as deep as the strip sinks.
    const double heading = drum.steer_rad;
    const Eigen::Vector3d way_W = R_WB * Eigen::Vector3d(std::cos(heading), std::sin(heading), 0.0);
    const double way = speed_mps < 0.0 ? -kRutReach_m : kRutReach_m;
    for (std::size_t k = 0; k < strips; ++k) {
      drum.load_n[k] *= scale;
      const GroundPoint& point = rest_.strip(i * strips + k).point;
      const SoilParameters& soil = ground_->soil(point.soil);
      // Friction mu N, on soft soil at most the shear strength; rolling loss by load and rut.
      drum.limit_n[k] = p.drum.friction_factor * point.friction * drum.load_n[k];
      rolling_n += p.drum.rolling_resistance * drum.load_n[k];
      if (soil.soft && !point.obstacle && bears(k)) {
        drum.limit_n[k] =
            std::min(drum.limit_n[k],
                     shear_limit_n(soil, drum.load_n[k], strip_width * p.drum.contact_length_m));
        // The rut is that of the whole drum, did it press everywhere as this strip does; what was
        // pressed before costs nothing (soil.h).
        const auto count = static_cast<double>(strips);
        const double sinkage =
            wheel_sinkage_m(soil, count * drum.load_n[k], p.drum.width_m, 2.0 * p.drum.radius_m);
        const Eigen::Vector2d& p_B = rest_.strip(i * strips + k).p_B_m;
        WheelContact foot;
        foot.point_W =
            start_W_ + state_.displacement_W + R_WB * Eigen::Vector3d(p_B.x(), p_B.y(), 0.0);
        const double ahead = ground_->ruts().depth_m((foot.point_W + way * way_W).head<2>());
        ploughing_n += compaction_resistance_n(soil, sinkage, ahead, p.drum.width_m) / count;
        if (ground_->ruts().depth_m(foot.point_W.head<2>()) < sinkage - 1e-4) {
          ground_->press(foot, way_W, strip_width, sinkage);
        }
      }
    }
    loads_.torque.rolling_nm[i] = rolling_n * p.drum.radius_m;
    loads_.ploughing_limit_n[i] = ploughing_n;
  }
}

void TandemRoller::move_dynamic(double h, const Eigen::Matrix3d& R_WB, const RestMotion& before,
                                State& next) {
  // To the centre of mass, whose motion the planar solve knows: v + w x c.
  const Eigen::Vector3d c(mass_.x_m, 0.0, 0.0);
  const Eigen::Vector3d v_WC_W = state_.v_WB_W + R_WB * state_.w_WB_B.cross(c);
  const Eigen::Vector3d v_WC_B = R_WB.transpose() * v_WC_W;
  RollerVelocity x;
  x << v_WC_B.x(), v_WC_B.y(), state_.w_WB_B.z(), spin_radps_[0], spin_radps_[1];
  drive_.begin(h);
  dynamics_.step(h, loads_, drive_, x);
  settle_contacts(h, x);
  const Eigen::Vector3d moved = h * x.head<3>();
  spin_radps_ = {x[3], x[4]};
  pressure_pa_ = drive_.gauge_pressure_pa();

  // Heave, roll and pitch follow the ground; the planar solve gives the rest.
  const RestMotion rest = rest_.rates(h, Eigen::Vector3d(x[0], x[1] - x[2] * c.x(), x[2]), before);
  const Eigen::Vector3d w(rest.roll, rest.pitch, x[2]);
  const Eigen::Vector3d v_next_W =
      R_WB * Eigen::Vector3d(x[0], x[1], rest.heave - rest.pitch * c.x());
  next.q_WB = turned(state_.q_WB, {h * rest.roll, h * rest.pitch, moved.z()});
  const Eigen::Matrix3d R_next = next.q_WB.toRotationMatrix();
  const double lift = h * (rest.heave - rest.pitch * c.x());
  next.displacement_W = state_.displacement_W + R_WB * Eigen::Vector3d(moved.x(), moved.y(), lift) +
                        (R_WB - R_next) * c;
  next.w_WB_B = w;
  next.v_WB_W = v_next_W - R_next * w.cross(c);
  next.alpha_WB_B = (w - state_.w_WB_B) / h;
  // a_B = a_C - alpha x c - w x (w x c).
  next.a_WB_W = (v_next_W - v_WC_W) / h - R_next * (next.alpha_WB_B.cross(c) + w.cross(w.cross(c)));
}

double TandemRoller::margin_m(const Eigen::Vector2d& push_n, const Eigen::Vector2d& lever_nm,
                              double normal_n) const {
  // Where on the ground the resultant has no moment about the centre of mass, height h above it:
  // X = (M_y - h F_x) / N, Y = -(M_x + h F_y) / N.
  const Eigen::Vector2d zero(mass_.x_m + (lever_nm.y() - mass_.height_m * push_n.x()) / normal_n,
                             -(lever_nm.x() + mass_.height_m * push_n.y()) / normal_n);
  // Ends of what bears of both drums, left about the frame's z.
  const double width = parameters_.drum.width_m;
  const double strip_width = width / static_cast<double>(parameters_.drum.strips);
  std::array<Eigen::Vector2d, 4> corner;
  for (std::size_t i = 0; i < 2; ++i) {
    const std::array<std::size_t, 2> bearing = rest_.bearing(i);
    const double x = i == 0 ? parameters_.pivot_x_m : -parameters_.pivot_x_m;
    const Eigen::Vector2d along(-std::sin(steering_[i].angle_rad()),
                                std::cos(steering_[i].angle_rad()));
    const auto end = [&](std::size_t strip) {
      const double y = strip_width * static_cast<double>(strip) - 0.5 * width;
      return Eigen::Vector2d(Eigen::Vector2d(x, 0.0) + y * along);
    };
    corner[i] = end(bearing[1]);
    corner[3 - i] = end(bearing[0]);
  }
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d edge = corner[(i + 1) % 4] - corner[i];
    const Eigen::Vector2d way = zero - corner[i];
    least = std::min(least, (edge.x() * way.y() - edge.y() * way.x()) / edge.norm());
  }
  return least;
}

bool TandemRoller::loses_its_footing(double h, const Eigen::Matrix3d& R_WB) {
  constexpr double kLongest_s = 0.02;
  if (!rest_.stands()) {
    return true;
  }
  // Forces of the last step: the ground's, the cutter's at the ground, and those of obstacles.
  const double normal = mass_.mass_kg * parameters_.gravity_mps2 * R_WB(2, 2);
  const Eigen::Vector2d push =
      dynamics_.ground_force_n() + Eigen::Vector2d(0.0, loads_.supplement.y());
  Eigen::Vector2d lever = Eigen::Vector2d::Zero();
  if (near_) {
    const Eigen::Vector3d centre_W =
        start_W_ + state_.displacement_W + R_WB * Eigen::Vector3d(mass_.x_m, 0.0, mass_.height_m);
    for (const ContactPoint& point : contact_.points()) {
      Eigen::Vector3d force = R_WB.transpose() * point.sum_W();
      force.z() = 0.0;  // What the model of its plane does not feel.
      lever += (R_WB.transpose() * (point.p_W - centre_W)).cross(force).head<2>();
    }
  }
  if (!(normal > 0.0)) {
    return false;  // Weightless, it cannot tip.
  }
  support_margin_m_ = margin_m(push, lever, normal);
  unsteady_s_ = support_margin_m_ < 0.0 ? unsteady_s_ + h : 0.0;
  // A blow passes; a support that is gone does not come back.
  return unsteady_s_ > (rest_.bears_all() ? kLongest_s : 0.0);
}

void TandemRoller::tip() {
  tipped_ = true;
  calm_s_ = 0.0;
  contact_.carry(Carried::by_contact);
  dynamics_.leave_ground();
  loads_.contacts = {};
}

bool TandemRoller::stands_again(double h, const Eigen::Matrix3d& R_WB) {
  constexpr double kUpright = 0.5;  // Cosine.
  constexpr double kNear_m = 0.02;
  constexpr double kNear_rad = 0.01;
  constexpr double kCalm_mps = 0.05;
  constexpr double kCalm_radps = 0.05;
  constexpr double kMargin_m = 0.02;
  constexpr double kCalm_s = 0.3;
  const RestMotion& away = rest_.deviation();
  const double weight = mass_.mass_kg * parameters_.gravity_mps2;
  const bool back = R_WB(2, 2) > kUpright && rest_.stands() && std::abs(away.heave) < kNear_m &&
                    std::abs(away.roll) < kNear_rad && std::abs(away.pitch) < kNear_rad &&
                    state_.w_WB_B.head<2>().norm() < kCalm_radps &&
                    std::abs(R_WB.col(2).dot(state_.v_WB_W)) < kCalm_mps &&
                    margin_m(weight * R_WB.row(2).head<2>().transpose(), Eigen::Vector2d::Zero(),
                             weight * R_WB(2, 2)) > kMargin_m;
  calm_s_ = back ? calm_s_ + h : 0.0;
  return calm_s_ > kCalm_s;
}

void TandemRoller::stand() {
  tipped_ = false;
  unsteady_s_ = 0.0;
  contact_.carry(Carried::by_model);
  contact_.clear_points();
  near_ = false;
  hold_slope();
}

void TandemRoller::move_tipped(double h, const Eigen::Matrix3d& R_WB, State& next) {
  const Eigen::Vector3d c(mass_.x_m, 0.0, mass_.height_m);
  const Eigen::Vector3d c_W = R_WB * c;
  const Eigen::Vector3d w_W = R_WB * state_.w_WB_B;
  const Eigen::Vector3d centre_W = start_W_ + state_.displacement_W + c_W;
  TippedLoads loads;
  loads.mass = mass_;
  loads.R_WB = R_WB;
  loads.torque.brake_nm = brake_limits_nm();
  TippedVelocity x;
  x.head<3>() = state_.v_WB_W + w_W.cross(c_W);
  x.segment<3>(3) = w_W;
  for (std::size_t i = 0; i < 2; ++i) {
    const double angle = steering_[i].angle_rad();
    loads.axle_W[i] = R_WB * Eigen::Vector3d(-std::sin(angle), std::cos(angle), 0.0);
    x[static_cast<Eigen::Index>(6 + i)] = spin_radps_[i] + loads.axle_W[i].dot(w_W);
    loads.torque.rolling_nm[i] =
        parameters_.drum.rolling_resistance * load_n_[i] * parameters_.drum.radius_m;
  }
  free_contacts_.clear();
  if (place_bodies(h, R_WB)) {
    for (ContactPoint& point : contact_.points()) {
      TippedContact& contact = free_contacts_.emplace_back();
      contact.point = &point;
      const Eigen::Vector3d p = point.p_W - centre_W;
      const Eigen::Vector3d arm = point.p_W - contact_links_[point.link].X_WL.translation();
      const std::size_t pivot = (point.link + 1) % 2;
      for (std::size_t k = 0; k < 3; ++k) {
        const Eigen::Vector3d& d = point.direction_W[k];
        contact.rows[k] = point.link >= 3
                              ? TippedRoller::drum_row(d, p, loads.axle_W[pivot], arm, pivot)
                              : TippedRoller::body_row(d, p);
        if (point.link > 0) {  // The pivot turns it, whatever that takes.
          point.other_mps[k] -= steering_[pivot].mean_rate_radps() * d.dot(R_WB.col(2).cross(arm));
        }
      }
      if (point.link >= 3) {
        point.law.friction *= parameters_.drum.friction_factor;
      }
      point.begin(h, contact.along(x));
    }
  }
  loads.contacts = free_contacts_;
  const TippedVelocity before = x;
  drive_.begin(h);
  free_.step(h, loads, dynamics_.train(), drive_, x);
  pressure_pa_ = drive_.gauge_pressure_pa();
  if (near_) {
    contact_.settle(h, [&](const ContactPoint& point) {
      return free_contacts_[static_cast<std::size_t>(&point - contact_.points().data())].along(x);
    });
  }
  load_n_ = {};
  for (const TippedContact& contact : free_contacts_) {
    if (contact.point->link >= 3) {
      load_n_[contact.point->link - 3] += contact.point->force_n[0];
    }
  }

  const Eigen::Vector3d v_next = x.head<3>();
  const Eigen::Vector3d w_next = x.segment<3>(3);
  for (std::size_t i = 0; i < 2; ++i) {
    spin_radps_[i] = x[static_cast<Eigen::Index>(6 + i)] - loads.axle_W[i].dot(w_next);
  }
  next.q_WB = turned(state_.q_WB, h * (R_WB.transpose() * w_next));
  const Eigen::Matrix3d R_next = next.q_WB.toRotationMatrix();
  const Eigen::Vector3d c_next = R_next * c;
  next.displacement_W = state_.displacement_W + c_W + h * v_next - c_next;
  next.w_WB_B = R_next.transpose() * w_next;
  next.v_WB_W = v_next - w_next.cross(c_next);
  const Eigen::Vector3d alpha_W = (w_next - before.segment<3>(3)) / h;
  next.alpha_WB_B = R_next.transpose() * alpha_W;
  next.a_WB_W =
      (v_next - before.head<3>()) / h - alpha_W.cross(c_next) - w_next.cross(w_next.cross(c_next));
}

void TandemRoller::move_kinematic(double h, const Eigen::Matrix3d& R_WB, const RestMotion& before,
                                  State& next) {
  drive_.begin(h);
  const double base = 2.0 * parameters_.pivot_x_m;
  // Reference point at mean drum speed: v = u (tan f + tan r) / 2, r = u (tan f - tan r) / L.
  const auto bicycle = [&](double speed_mps, double front_rad, double rear_rad) {
    const double mean = 0.5 * (1.0 / std::cos(front_rad) + 1.0 / std::cos(rear_rad));
    const double u = speed_mps / mean;
    const double front = std::tan(front_rad);
    const double rear = std::tan(rear_rad);
    return Eigen::Vector3d(u, 0.5 * u * (front + rear), u * (front - rear) / base);
  };
  const std::array<double, 2> angle{steering_[0].angle_rad(), steering_[1].angle_rad()};
  Eigen::Vector3d middle =
      bicycle(drive_.mean_set_point_mps(), angle[0] - 0.5 * h * steering_[0].mean_rate_radps(),
              angle[1] - 0.5 * h * steering_[1].mean_rate_radps());
  Eigen::Vector3d end = bicycle(drive_.set_point_mps(), angle[0], angle[1]);
  // Without forces it stops short of what it would pass.
  double free = 1.0;
  RollerVelocity wanted = RollerVelocity::Zero();
  wanted.head<3>() = middle + Eigen::Vector3d(0.0, middle[2] * mass_.x_m, 0.0);
  for (const RollerContact& contact : loads_.contacts) {
    contact.point->released = true;
    const double closing_m = -h * contact.rows[0].head<3>().dot(wanted.head<3>());
    const double room_m = std::max(0.0, contact.point->gap_m);
    if (closing_m > room_m) {
      free = std::min(free, room_m / closing_m);
      contact.point->blocks = true;
    }
  }
  middle *= free;
  end *= free;
  settle_contacts(h, free * wanted);
  const Eigen::Vector3d v_before = R_WB.transpose() * state_.v_WB_W;
  for (std::size_t i = 0; i < 2; ++i) {
    spin_radps_[i] = end[0] / (parameters_.drum.radius_m * std::cos(angle[i]));
  }
  drive_.finish({0.0, 0.0});
  const double acceleration = (end[0] - v_before.x()) / h;
  pressure_pa_ = kinematic_pressure_pa(acceleration);

  const RestMotion rest = rest_.rates(h, middle, before);
  // An arc at the step's middle velocity.
  const auto [ahead, aside] = arc(h * middle[2]);
  const Eigen::Vector3d way(ahead * middle[0] - aside * middle[1],
                            aside * middle[0] + ahead * middle[1], rest.heave);
  next.q_WB = turned(state_.q_WB, h * Eigen::Vector3d(rest.roll, rest.pitch, middle[2]));
  const Eigen::Matrix3d R_next = next.q_WB.toRotationMatrix();
  next.displacement_W = state_.displacement_W + h * (R_WB * way);
  next.w_WB_B = {rest.roll, rest.pitch, end[2]};
  const Eigen::Vector3d v(end[0], end[1], rest.heave);
  next.v_WB_W = R_next * v;
  const Eigen::Vector3d change(acceleration, (end[1] - v_before.y()) / h,
                               (rest.heave - before.heave) / h);
  // Derivative in turning axes: dv/dt + w x v.
  next.a_WB_W = R_next * (change + next.w_WB_B.cross(v));
  next.alpha_WB_B = (next.w_WB_B - state_.w_WB_B) / h;
}

// What the motors would need for slope and acceleration.
double TandemRoller::kinematic_pressure_pa(double acceleration_mps2) const {
  const HydrostaticDriveParameters& p = drive_.parameters();
  if (command_.parking_brake) {
    return p.charge_pressure_pa;
  }
  const double climb = (state_.q_WB * Eigen::Vector3d::UnitX()).z();
  const double force =
      mass_.mass_kg * std::abs(acceleration_mps2 + parameters_.gravity_mps2 * climb);
  return p.charge_pressure_pa +
         std::min(p.relief_pressure_pa,
                  force * parameters_.drum.radius_m / (2.0 * p.motor_displacement_m3prad));
}

bool TandemRoller::record_non_finite(const State& next) {
  const auto check = [this](bool fine, const char* quantity, const char* part) {
    if (!fine && !non_finite_) {
      non_finite_ = NonFinite{quantity, part, time_};
    }
  };
  check(std::isfinite(spin_radps_[0]), "drum rate", "front drum");
  check(std::isfinite(spin_radps_[1]), "drum rate", "rear drum");
  check(next.w_WB_B.allFinite(), "angular rate", "frame");
  check(next.v_WB_W.allFinite(), "velocity", "frame");
  check(next.displacement_W.allFinite() && next.q_WB.coeffs().allFinite(), "pose", "frame");
  return non_finite_.has_value();
}

// What the roller shows: motion of its links, its sensors, its numbers.

void TandemRoller::update_dust() {
  const double sum_n = load_n_[0] + load_n_[1];
  const double road_kgpm = road_dust_kgpm(mass_.mass_kg);
  for (std::size_t i = 0; i < 2; ++i) {
    const LinkMotion& drum = links_[3 + i];
    // Road dust by the greater of surface and travel speed, shared by load (dust_emitter.h).
    const double speed_mps = std::max(std::abs(spin_radps_[i]) * parameters_.drum.radius_m,
                                      drum.v_WL_W.head<2>().norm());
    dust_[i] = rolling_dust(road_kgpm, drum.X_WL.translation() - upward(parameters_.drum.radius_m),
                            parameters_.drum.width_m, load_n_[i] / sum_n, speed_mps);
  }
}

void TandemRoller::update_links() {
  LinkMotion base;
  const Eigen::Matrix3d R_WB = state_.q_WB.toRotationMatrix();
  base.X_WL.linear() = R_WB;
  base.X_WL.translation() = start_W_ + state_.displacement_W;
  base.v_WL_W = state_.v_WB_W;
  base.w_WL_W = R_WB * state_.w_WB_B;
  base.a_WL_W = state_.a_WB_W;
  base.alpha_WL_W = R_WB * state_.alpha_WB_B;

  const double l = parameters_.pivot_x_m;
  LinkMotion frame = base;
  if (vibration_[0].speed_share() > 0.0 || vibration_[1].speed_share() > 0.0) {
    const Oscillation front = vibration_[0].frame();
    const Oscillation rear = vibration_[1].frame();
    // Frame on both mounts: heave is the mean of their motions, pitch the difference over the base.
    frame = carried(base, upward(0.5 * (front.position_m + rear.position_m)),
                    upward(0.5 * (front.velocity_mps + rear.velocity_mps)),
                    upward(0.5 * (front.acceleration_mps2 + rear.acceleration_mps2)));
    const double lever = 1.0 / (2.0 * l);
    frame = rotated(frame, Eigen::Vector3d::UnitY(), (rear.position_m - front.position_m) * lever,
                    (rear.velocity_mps - front.velocity_mps) * lever,
                    (rear.acceleration_mps2 - front.acceleration_mps2) * lever);
  }
  links_[0] = frame;
  for (std::size_t i = 0; i < 2; ++i) {
    const PivotSteering& pivot = steering_[i];
    const Eigen::Vector3d centre(i == 0 ? l : -l, 0.0, parameters_.drum.radius_m);
    const auto steered = [&pivot](const LinkMotion& motion) {
      return rotated(motion, Eigen::Vector3d::UnitZ(), pivot.angle_rad(), pivot.rate_radps(),
                     pivot.acceleration_radps2());
    };
    links_[1 + i] = steered(carried(frame, centre, upward(0.0), upward(0.0)));
    const Oscillation shake = vibration_[i].drum();
    const LinkMotion axle =
        steered(carried(base, centre + upward(shake.position_m), upward(shake.velocity_mps),
                        upward(shake.acceleration_mps2)));
    links_[3 + i] = rotated(axle, Eigen::Vector3d::UnitY(), spin_angle_rad_[i], spin_radps_[i],
                            spin_acceleration_radps2_[i]);
  }
}

OdometryReading TandemRoller::odometry() const {
  const double front = steering_[0].angle_rad();
  const double rear = steering_[1].angle_rad();
  OdometryReading reading;
  // The kinematic bicycle read backwards from drum rates and angles (docs/machines/bomag-bw174.md).
  reading.speed_mps = 0.5 * parameters_.drum.radius_m *
                      (spin_radps_[0] * std::cos(front) + spin_radps_[1] * std::cos(rear));
  reading.slip_angle_rad = std::atan(0.5 * (std::tan(front) + std::tan(rear)));
  reading.curvature_1pm = std::cos(reading.slip_angle_rad) * (std::tan(front) - std::tan(rear)) /
                          (2.0 * parameters_.pivot_x_m);
  return reading;
}

VehicleSample TandemRoller::vehicle_sample(SimTime time) const {
  VehicleSample sample;
  sample.time = time;
  sample.engine = drive_.engine_sample();
  engine_.read(sample.engine);
  sample.driveline_engaged = !parameters_.drive.bypass;
  sample.wheel_rate_radps = {spin_radps_[0], spin_radps_[0], spin_radps_[1], spin_radps_[1]};
  sample.wheel_radius_m.fill(parameters_.drum.radius_m);
  sample.front_steer_rad = steering_[0].angle_rad();
  sample.rear_steer_rad = steering_[1].angle_rad();
  sample.brake_share = brake_share_;
  sample.parking_brake = command_.parking_brake;
  sample.lock[static_cast<std::size_t>(Differential::centre)] = drive_.divided();
  sample.hydraulic_pressure_pa = pressure_pa_;
  sample.vibration = {vibration_[0].on(), vibration_[1].on()};
  sample.edge_cutter_share = cutter_.share();
  sample.spreader_rate_kgpm2 = spreader_.rate_kgpm2();
  sample.hopper_mass_kg = spreader_.mass_kg();
  sample.odometry = odometry();
  sample.ground_speed_mps = links_[0].X_WL.linear().col(0).dot(links_[0].v_WL_W);
  sample.travel_limit = travel_limit_;
  return sample;
}

std::span<const StatusQuantity> TandemRoller::status_quantities() const {
  return kStatus;
}

void TandemRoller::read_status(std::span<double> values) const {
  const double forward = state_.v_WB_W.dot(state_.q_WB * Eigen::Vector3d::UnitX());
  const std::array<double, kStatus.size()> all{
      3.6 * forward,
      kDegrees * steering_[0].angle_rad(),
      kDegrees * steering_[1].angle_rad(),
      1e-5 * pressure_pa_,
      30.0 / std::numbers::pi * drive_.engine_speed_radps(),
      static_cast<double>(dynamics_.drum(0).sliding_strips() + dynamics_.drum(1).sliding_strips()),
      sprinkler_.mass_kg(),
      spreader_.mass_kg()};
  std::copy(all.begin(), all.end(), values.begin());
}

std::span<const TruthField> TandemRoller::truth_fields() const {
  return kTruth;
}

void TandemRoller::read_truth(std::span<double> values) const {
  const std::array<double, 15> all{spin_radps_[0],
                                   spin_radps_[1],
                                   steering_[0].angle_rad(),
                                   steering_[1].angle_rad(),
                                   load_n_[0],
                                   load_n_[1],
                                   pivot_moment_nm(0),
                                   pivot_moment_nm(1),
                                   dynamics_.drum(0).loss_w(),
                                   dynamics_.drum(1).loss_w(),
                                   pressure_pa_,
                                   drive_.engine_speed_radps(),
                                   sprinkler_.mass_kg(),
                                   spreader_.mass_kg(),
                                   tipped_ ? 1.0 : 0.0};
  std::copy(all.begin(), all.end(), values.begin());
}

}  // namespace rigwire::sim
