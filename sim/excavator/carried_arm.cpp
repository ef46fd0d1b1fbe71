#include "sim/excavator/carried_arm.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

constexpr double kFree = 1e300;
constexpr int kPassesMax = 24;
constexpr int kSwitchesMax = 4;         // Of one force: to a limit, back, to a limit, back.
constexpr double kStopReach_m = 0.005;  // Nearer than this to its stop a cylinder feels it.

}  // namespace

CarriedArm::CarriedArm(const ExcavatorParameters& parameters, const Ground& ground,
                       const Eigen::Isometry3d& X_WC)
    : parameters_(parameters),
      undercarriage_(ArmDynamics::moments_of(parameters.undercarriage)),
      ground_(&ground),
      X_WC_(X_WC) {
  double mass = undercarriage_.mass_kg;
  for (const RigidBodyParameters* link :
       {&parameters.upper, &parameters.boom, &parameters.stick, &parameters.bucket}) {
    mass += link->mass_kg;
  }
  const CarrierParameters& wheels = parameters.wheels;
  tyres_.assign(kCarrierWheels, Tyre(wheels.tyre, mass / kCarrierWheels));
  // So high that with a quarter of the weight on each the origin lies on the ground.
  const double deflection = mass * parameters.gravity_mps2 / kCarrierWheels /
                            tyres_[0].stiffness_npm(wheels.tyre_pressure_pa);
  const double height = wheels.tyre.unloaded_radius_m - deflection;
  for (std::size_t i = 0; i < kCarrierWheels; ++i) {
    wheel_C_[i] = {(i < 2 ? 0.5 : -0.5) * wheels.wheelbase_m,
                   (i % 2 == 0 ? 0.5 : -0.5) * wheels.track_m, height};
  }
}

void CarriedArm::place(const Eigen::Isometry3d& X_WC) {
  X_WC_ = X_WC;
  velocity_.setZero();
  acceleration_.setZero();
}

void CarriedArm::set_velocity(const Eigen::Vector3d& w_C, const Eigen::Vector3d& v_C) {
  velocity_.head<3>() = w_C;
  velocity_.segment<3>(3) = v_C;
}

void CarriedArm::add_wheels(double h, Terms& terms, std::array<Footing, kCarrierWheels>& footings) {
  const Eigen::Matrix3d R_CW = X_WC_.linear().transpose();
  const Eigen::Vector3d axle_W = X_WC_.linear().col(1);
  const CarrierParameters& wheels = parameters_.wheels;
  for (std::size_t i = 0; i < kCarrierWheels; ++i) {
    const Eigen::Vector3d center_W = X_WC_ * wheel_C_[i];
    const auto contact = ground_->wheel_contact(center_W, axle_W, wheels.tyre.unloaded_radius_m);
    Footing& foot = footings[i];
    foot.laws = tyres_[i].laws(h, contact, ground_->soil(contact ? contact->ground.soil : 0),
                               wheels.tyre_pressure_pa, 0.0);
    foot.touching = contact.has_value() && foot.laws.touching;
    if (!foot.touching) {
      continue;
    }
    const Eigen::Vector3d& normal_W = contact->normal_W;
    const Eigen::Vector3d forward_W = axle_W.cross(normal_W).normalized();
    const Eigen::Vector3d left_W = normal_W.cross(forward_W);
    const Eigen::Vector3d point_C = R_CW * (contact->point_W - X_WC_.translation());
    const auto add = [&](const Eigen::Vector3d& direction_W, const ImplicitForce& law,
                         double least) {
      const Eigen::Vector3d direction_C = R_CW * direction_W;
      Velocities row = Velocities::Zero();
      // Force at the wheel as a wrench on the undercarriage: moment p x n, then n.
      row.head<3>() = point_C.cross(direction_C);
      row.segment<3>(3) = direction_C;
      return terms.add(row, law, least, kFree);
    };
    foot.normal = add(normal_W, foot.laws.normal, 0.0);
    foot.along = add(forward_W, foot.laws.longitudinal, -kFree);
    foot.across = add(left_W, foot.laws.lateral, -kFree);
  }
}

bool CarriedArm::clamp(Terms& terms, std::array<Footing, kCarrierWheels>& footings,
                       const Velocities& found) {
  bool changed = false;
  for (std::size_t i = 0; i < terms.count; ++i) {
    Term& term = terms.all[i];
    const double free = term.law.at(term.row.dot(found));
    if (term.held) {
      // Held before another force was, it may not need to be any more. Friction stays: its limit
      // is not its own.
      const bool own = term.least > -kFree || term.greatest < kFree;
      const bool within = term.force >= term.greatest ? free < term.greatest : free > term.least;
      if (own && within && term.switches < kSwitchesMax) {
        term.held = false;
        ++term.switches;
        changed = true;
      }
      continue;
    }
    term.force = std::clamp(free, term.least, term.greatest);
    if (free != term.force && term.switches < kSwitchesMax) {
      term.held = true;
      ++term.switches;
      changed = true;
    }
  }
  for (Footing& foot : footings) {
    if (!foot.touching) {
      continue;
    }
    Term& along = terms.all[foot.along];
    Term& across = terms.all[foot.across];
    const double limit = foot.laws.limit_n(terms.all[foot.normal].force);
    // Friction circle under the normal force of this pass.
    const double force = std::hypot(along.force, across.force);
    // Held forces follow the load that the solve finds; a few passes settle it.
    const bool loose = force > limit * (1.0 + 1e-9);
    if (loose || (foot.sliding && force < limit * (1.0 - 1e-6))) {
      const double share = force > 0.0 ? limit / force : 0.0;
      along.force *= share;
      across.force *= share;
      along.held = across.held = true;
      foot.sliding = true;
      changed = true;
    }
  }
  return changed;
}

ArmStep CarriedArm::step(double h, const DrivenArm& arm, const ArmPose& at, const DriveLaws& laws,
                         const BucketLoad& load, ArmState& state) {
  velocity_.tail<4>() = state.v_radps;
  Placement placed;
  Matrix mass_matrix;
  Velocities bias;
  equations(arm, placed, state.q_rad, mass_matrix, bias);

  Terms terms;
  for (int i = 0; i < kArmJoints; ++i) {
    Velocities row = Velocities::Zero();
    // Virtual work: a drive's force acts on its joint by the lever dx/dq.
    row[i + 6] = at.lever[i];
    terms.add(row, laws.force[static_cast<std::size_t>(i)], laws.least[i], laws.greatest[i]);
  }
  for (int i = 1; i < kArmJoints; ++i) {
    // End stops join where the stroke would end within this step.
    const double ahead = at.x[i] + h * at.lever[i] * state.v_radps[i];
    const bool low = ahead < arm.length_least_m()[i] + kStopReach_m;
    if (low || ahead > arm.length_greatest_m()[i] - kStopReach_m) {
      Velocities row = Velocities::Zero();
      row[i + 6] = at.lever[i];
      const ImplicitForce law = arm.stop_law(i, low, h, at.x[i]);
      terms.add(row, law, low ? 0.0 : -kFree, low ? kFree : 0.0);
    }
  }
  const Eigen::Matrix3d R_CW = X_WC_.linear().transpose();
  const auto on_bucket = [&](const Eigen::Vector3d& point_B, const Eigen::Vector3d& direction_W) {
    return point_row(placed, placed.origin_C[4] + placed.R_CB[4] * point_B, R_CW * direction_W, 4);
  };
  const std::size_t first_resistance = terms.count;
  for (std::size_t i = 0; i < load.resistance_count; ++i) {
    const TipResistance& each = load.resistances[i];
    terms.add(on_bucket(each.point_B, each.direction_W), {each.offset_n, each.gain_nspm},
              -each.limit_n, each.limit_n);
  }
  std::array<Footing, kCarrierWheels> footings;
  add_wheels(h, terms, footings);
  Velocities rest = -bias;
  if (!load.force_W.isZero(0.0)) {
    rest += on_bucket(load.point_B, load.force_W);
  }

  Velocities found = velocity_;
  // (M + h sum g J^T J) a = -bias + sum J^T F(start), clamp last (carried_arm.h).
  for (int pass = 0; pass < kPassesMax; ++pass) {
    Matrix left = mass_matrix;
    Velocities right = rest;
    for (std::size_t i = 0; i < terms.count; ++i) {
      const Term& term = terms.all[i];
      if (term.held) {
        right += term.force * term.row;
      } else {
        left.noalias() += h * term.law.gain * term.row * term.row.transpose();
        right += term.law.at(term.row.dot(velocity_)) * term.row;
      }
    }
    acceleration_ = left.llt().solve(right);
    found = velocity_ + h * acceleration_;
    if (!clamp(terms, footings, found)) {
      break;
    }
  }

  for (std::size_t i = 0; i < kCarrierWheels; ++i) {
    const Footing& foot = footings[i];
    loads_n_[i] = foot.touching ? terms.all[foot.normal].force : 0.0;
    TyreResult result;
    if (foot.touching) {
      const Term& along = terms.all[foot.along];
      const Term& across = terms.all[foot.across];
      result = {.longitudinal_n = along.force,
                .lateral_n = across.force,
                .rolling_nm = 0.0,
                .longitudinal_slide_mps = along.row.dot(found),
                .lateral_slide_mps = across.row.dot(found),
                .wheel_rate_radps = 0.0,
                .slipping = foot.sliding,
                .rolling_limited = false};
    }
    tyres_[i].settle(h, foot.laws, result);
  }

  velocity_ = found;
  // Attitude by the exponential map of h w, position and joints with the new velocities.
  const Eigen::Vector3d turn = h * velocity_.head<3>();
  const double angle = turn.norm();
  const Eigen::Vector3d shift = X_WC_.linear() * (h * velocity_.segment<3>(3));
  X_WC_.translation() += shift;
  if (angle > 0.0) {
    const Eigen::Quaterniond R(X_WC_.linear() * Eigen::AngleAxisd(angle, turn / angle));
    X_WC_.linear() = R.normalized().toRotationMatrix();
  }
  state.v_radps = velocity_.tail<4>();
  state.q_rad += h * state.v_radps;

  ArmStep result;
  result.acceleration_radps2 = acceleration_.tail<4>();
  for (int i = 0; i < kArmJoints; ++i) {
    const auto n = static_cast<std::size_t>(i);
    result.force[i] = terms.all[n].force;
    result.relieved[n] = terms.all[n].held;
  }
  for (std::size_t i = 0; i < load.resistance_count; ++i) {
    result.resistance_n[i] = terms.all[first_resistance + i].force;
  }
  return result;
}

}  // namespace rigwire::sim
