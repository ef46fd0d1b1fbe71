#include "sim/vehicle/kinematic_vehicle.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

constexpr int kKinematicPasses = 6;
constexpr double kHoldDampingRatio = 0.7;
constexpr double kSteep = 0.87;  // Cosine, 30 degrees about the body's z.

}  // namespace

KinematicVehicle::KinematicVehicle(const WheeledVehicleParameters& parameters, const Ground& ground,
                                   std::unique_ptr<Driveline> driveline, const VehiclePlace& place)
    : WheeledVehicle(parameters, ground, std::move(driveline)), follower_(parameters_) {
  contact_rows_.reserve(kMostContactPoints);
  follower_.reset(ground, place);
  for (std::size_t i = 0; i < kWheels; ++i) {
    wheels_[i].rolling_radius_m = static_.rolling_radius_m[i / 2];
    wheels_[i].load_n = static_.wheel_n[i / 2];
    wheels_[i].touching = true;
  }
  update_links();
}

void KinematicVehicle::update_geometry() {
  const double front = std::tan(steering_[0].angle_rad());
  const double rear = std::tan(steering_[1].angle_rad());
  // Two steered axles without slip: curvature (tan f - tan r) / L, sideways speed at B's origin.
  curvature_1pm_ = (front - rear) / parameters_.wheelbase_m();
  sideways_ = rear - parameters_.rear.position_x_m * curvature_1pm_;
  for (std::size_t i = 0; i < kWheels; ++i) {
    const Eigen::Vector3d centre = wheel_centre_m(parameters_, static_, i);
    const double steer = steer_rad(i / 2)[i % 2];
    // Hub's velocity v + w x r per speed ahead, along the wheel's heading, over its radius.
    const double ahead = 1.0 - curvature_1pm_ * centre.y();
    const double left = sideways_ + curvature_1pm_ * centre.x();
    rate_per_speed_[static_cast<Eigen::Index>(i)] =
        (ahead * std::cos(steer) + left * std::sin(steer)) / static_.rolling_radius_m[i / 2];
  }
}

void KinematicVehicle::meet_obstacles(double h) {
  const LinkMotion& body = follower_.body();
  near_ = contact_.near(h, body.v_WL_W.norm() + 2.0 * reach_m_ * body.w_WL_W.norm() + 0.1);
  if (!near_) {
    return;
  }
  place_rigid_links(parameters_, static_,
                    {steer_rad(0)[0], steer_rad(0)[1], steer_rad(1)[0], steer_rad(1)[1]}, body,
                    contact_links_);
  contact_.begin(h, contact_links_);
  contact_rows_.clear();
  const Eigen::Matrix3d R_WB = follower_.R_WB();
  for (ContactPoint& point : contact_.points()) {
    const Eigen::Vector3d p_B = R_WB.transpose() * (point.p_W - body.X_WL.translation());
    // Velocity of the point per speed ahead, v + w x p in the body's plane.
    const Eigen::Vector3d way(1.0 - curvature_1pm_ * p_B.y(), sideways_ + curvature_1pm_ * p_B.x(),
                              0.0);
    const bool steep = std::abs(R_WB.col(2).dot(point.direction_W[0])) > kSteep;
    std::array<double, 3>& rows = contact_rows_.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      rows[k] = steep ? 0.0 : (R_WB * way).dot(point.direction_W[k]);
    }
    point.begin(h, {rows[0] * speed_mps_, rows[1] * speed_mps_, rows[2] * speed_mps_});
    if (steep) {
      point.law.greatest_n = 0.0;
      point.blocks = point.gap_m < 0.0;
    }
  }
}

double KinematicVehicle::drive(double h) {
  const double m = parameters_.mass_kg();
  const Eigen::Matrix3d R_WB = follower_.R_WB();
  const double gravity = parameters_.gravity_mps2;
  const double pressing = m * gravity * std::max(0.0, R_WB(2, 2));

  double brake = 0.0;
  double rolling = 0.0;
  double friction = 0.0;
  double inertia = m;
  for (std::size_t i = 0; i < kWheels; ++i) {
    const double per_speed = std::abs(rate_per_speed_[static_cast<Eigen::Index>(i)]);
    const TyreParameters& tyre = axle(i / 2).tyre;
    brake += brake_limit_nm(i) * per_speed;
    rolling += 0.25 * pressing * tyre.rolling_resistance;
    friction += 0.25 * tyre.friction_factor * follower_.ground()[i].friction;
    // Spin inertia reflected to the path, J (w / v)^2.
    inertia += axle(i / 2).wheel_spin_inertia_kgm2 * per_speed * per_speed;
  }
  // Brakes hold no more than the tyres' friction; rolling resistance f N adds to it.
  const double limit = std::min(brake, friction * pressing) + rolling;
  double stiffness = 0.0;
  for (std::size_t i = 0; i < kWheels; ++i) {
    stiffness += axle(i / 2).tyre.longitudinal_stiffness_npm;
  }
  // One bristle for all wheels along the path, c = 2 zeta sqrt(k m).
  const BristleParameters hold{stiffness, 2.0 * kHoldDampingRatio * std::sqrt(stiffness * m), 1.0};
  const ImplicitForce law = hold_.force(hold, h, 0.0);
  const double v = speed_mps_;
  // Slope's pull and quadratic air drag.
  const double outer = -m * gravity * R_WB(2, 0) - parameters_.air_drag_ns2pm2 * std::abs(v) * v;

  double change = 0.0;
  double held = std::copysign(limit, -v);
  for (int pass = 1;; ++pass) {
    // (m + h gain + g^T (I + h D) g) dv = h (F + g^T T), rates tied to the speed by g; clamp last.
    const SpinEquations& drive = driveline_->equations();
    const WheelVector& g = rate_per_speed_;
    double weight = inertia + g.dot((drive.inertia + h * drive.damping) * g);
    double impulse = h * (outer + g.dot(drive.torque_nm));
    if (held_at_limit_) {
      impulse += h * held;
    } else {
      weight += h * law.gain;
      impulse += h * law.at(v);
    }
    for (std::size_t i = 0; near_ && i < contact_rows_.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const ImplicitForce push = contact_.points()[i].acting(k);
        const double row = contact_rows_[i][k];
        weight += h * push.gain * row * row;
        impulse += h * push.at(row * v) * row;
      }
    }
    change = impulse / weight;
    if (pass >= kKinematicPasses) {
      break;
    }
    const double trial = law.at(v + change);
    const bool beyond = std::abs(trial) > limit;
    const double clamped = std::copysign(limit, trial);
    bool changed = beyond != held_at_limit_ || (beyond && clamped != held);
    held_at_limit_ = beyond;
    held = clamped;
    for (std::size_t i = 0; near_ && i < contact_rows_.size(); ++i) {
      const double end = v + change;
      const auto& row = contact_rows_[i];
      changed = contact_.points()[i].changes({row[0] * end, row[1] * end, row[2] * end}) || changed;
    }
    if (!changed) {
      changed = !driveline_->accept(h, g * (v + change));
    }
    if (!changed) {
      break;
    }
  }
  const double found = v + change;
  if (near_) {
    contact_.settle(h, [&](const ContactPoint& point) {
      const auto& row = contact_rows_[static_cast<std::size_t>(&point - contact_.points().data())];
      return std::array<double, 3>{row[0] * found, row[1] * found, row[2] * found};
    });
  }
  if (held_at_limit_) {
    hold_.slide_within(hold, h, 0.0, found, std::abs(held));
  } else {
    hold_.slide(hold, h, 0.0, found);
  }
  return found;
}

void KinematicVehicle::inner_step(double h) {
  update_geometry();
  meet_obstacles(h);
  WheelVector rates = rate_per_speed_ * speed_mps_;
  driveline_->begin(h, axle(0).wheel_spin_inertia_kgm2, rates);
  const double found = drive(h);
  if (!std::isfinite(found)) {
    record_non_finite("speed", "body");
    return;
  }
  speed_mps_ = found;
  const WheelVector new_rates = rate_per_speed_ * found;
  for (std::size_t i = 0; i < kWheels; ++i) {
    const double rate = new_rates[static_cast<Eigen::Index>(i)];
    rate_radps2_[i] = (rate - rate_radps_[i]) / h;
    rate_radps_[i] = rate;
    spin_rad_[i] = std::remainder(spin_rad_[i] + h * rate, 2.0 * std::numbers::pi);
    wheels_[i].rate_radps = rate;
    wheels_[i].friction = follower_.ground()[i].friction;
  }
  driveline_->finish(h, new_rates);
  follower_.step(h, *ground_, found * Eigen::Vector2d(1.0, sideways_), found * curvature_1pm_);
  if (!follower_.finite()) {
    record_non_finite("position", "body");
  }
}

void KinematicVehicle::start_rolling(double speed_mps) {
  speed_mps_ = speed_mps;
  update_geometry();
  for (std::size_t i = 0; i < kWheels; ++i) {
    rate_radps_[i] = rate_per_speed_[static_cast<Eigen::Index>(i)] * speed_mps;
    wheels_[i].rate_radps = rate_radps_[i];
  }
  follower_.set_speed(speed_mps * Eigen::Vector2d(1.0, sideways_));
  update_links();
}

void KinematicVehicle::update_links() {
  const std::array<double, 4> steer{steer_rad(0)[0], steer_rad(0)[1], steer_rad(1)[0],
                                    steer_rad(1)[1]};
  rigid_links(parameters_, static_, steer, spin_rad_, rate_radps_, rate_radps2_, follower_.body(),
              links_);
}

}  // namespace rigwire::sim
