#include "sim/excavator/arm_dynamics.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

const Eigen::Vector3d kUp = Eigen::Vector3d::UnitZ();
const Eigen::Vector3d kRaise = -Eigen::Vector3d::UnitY();  // Turning about -y lifts x towards z.

Eigen::Matrix3d raised(double cosine, double sine) {
  Eigen::Matrix3d R;
  R << cosine, 0.0, -sine, 0.0, 1.0, 0.0, sine, 0.0, cosine;
  return R;
}

Eigen::Matrix3d point_inertia(double mass_kg, const Eigen::Vector3d& r) {
  return mass_kg * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
}

}  // namespace

ArmDynamics::ArmDynamics(const ExcavatorParameters& parameters,
                         const Eigen::Vector3d& gravity_C_mps2)
    : payload_center_m_(parameters.payload_center_of_mass_m),
      payload_max_kg_(parameters.payload_max_kg),
      boom_foot_m_(parameters.boom_foot_m),
      boom_length_m_(parameters.boom_length_m),
      stick_length_m_(parameters.stick_length_m),
      bucket_tip_m_(parameters.bucket_tip_m),
      swing_axis_height_m_(parameters.swing_axis_height_m),
      gravity_C_(gravity_C_mps2) {
  const std::array<const RigidBodyParameters*, kArmJoints> links{
      &parameters.upper, &parameters.boom, &parameters.stick, &parameters.bucket};
  for (std::size_t i = 0; i < links.size(); ++i) {
    bodies_[i] = {links[i]->mass_kg, links[i]->center_of_mass_m,
                  links[i]->principal_inertia_kgm2.asDiagonal()};
  }
  empty_bucket_ = bodies_[3];
}

void ArmDynamics::set_payload_kg(double mass_kg) {
  payload_kg_ = mass_kg > 0.0 ? std::min(mass_kg, payload_max_kg_) : 0.0;
  Body& bucket = bodies_[3];
  bucket.mass_kg = empty_bucket_.mass_kg + payload_kg_;
  bucket.center_m =
      (empty_bucket_.mass_kg * empty_bucket_.center_m + payload_kg_ * payload_center_m_) /
      bucket.mass_kg;
  bucket.inertia_kgm2 =
      empty_bucket_.inertia_kgm2 +
      point_inertia(empty_bucket_.mass_kg, empty_bucket_.center_m - bucket.center_m) +
      point_inertia(payload_kg_, payload_center_m_ - bucket.center_m);
}

ArmDynamics::Placement ArmDynamics::place(const JointVector& q_rad) const {
  Placement placement;
  placement.R_UB[0].setIdentity();
  placement.origin_U[0].setZero();
  placement.center_U[0] = bodies_[0].center_m;
  placement.inertia_U[0] = bodies_[0].inertia_kgm2;
  const std::array<double, 2> lengths{boom_length_m_, stick_length_m_};
  double angle = 0.0;
  for (std::size_t i = 1; i < kArmJoints; ++i) {
    angle += q_rad[static_cast<Eigen::Index>(i)];
    Eigen::Matrix3d& R = placement.R_UB[i];
    R = raised(std::cos(angle), std::sin(angle));
    placement.origin_U[i] = i == 1 ? boom_foot_m_
                                   : Eigen::Vector3d(placement.origin_U[i - 1] +
                                                     lengths[i - 2] * placement.R_UB[i - 1].col(0));
    placement.center_U[i] = placement.origin_U[i] + R * bodies_[i].center_m;
    placement.inertia_U[i].noalias() = R * bodies_[i].inertia_kgm2 * R.transpose();
  }
  return placement;
}

void ArmDynamics::evaluate(const JointVector& q_rad, const JointVector& v_radps,
                           JointMatrix& mass_matrix, JointVector& bias) const {
  const Placement at = place(q_rad);

  // Bias: outward accelerations with zero joint acceleration, gravity as an upward acceleration of
  // the base, then inward forces.
  const double cosine = std::cos(q_rad[0]);
  const double sine = std::sin(q_rad[0]);
  const Eigen::Vector3d base_acceleration(-(cosine * gravity_C_.x() + sine * gravity_C_.y()),
                                          -(cosine * gravity_C_.y() - sine * gravity_C_.x()),
                                          -gravity_C_.z());
  std::array<Eigen::Vector3d, kArmJoints> force;
  std::array<Eigen::Vector3d, kArmJoints> moment;  // About each body's centre of mass.
  Eigen::Vector3d w = v_radps[0] * kUp;
  Eigen::Vector3d alpha = Eigen::Vector3d::Zero();
  Eigen::Vector3d a_origin = base_acceleration;
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    if (i > 0) {
      const Eigen::Vector3d step = at.origin_U[i] - at.origin_U[i - 1];
      a_origin += alpha.cross(step) + w.cross(w.cross(step));
      const Eigen::Vector3d rate = v_radps[static_cast<Eigen::Index>(i)] * kRaise;
      alpha += w.cross(rate);
      w += rate;
    }
    const Eigen::Vector3d r = at.center_U[i] - at.origin_U[i];
    force[i] = bodies_[i].mass_kg * (a_origin + alpha.cross(r) + w.cross(w.cross(r)));
    moment[i] = at.inertia_U[i] * alpha + w.cross(at.inertia_U[i] * w);
  }

  Eigen::Vector3d f = Eigen::Vector3d::Zero();
  Eigen::Vector3d n = Eigen::Vector3d::Zero();  // About the joint's origin.
  double mass = 0.0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for (std::size_t i = kArmJoints; i-- > 0;) {
    const auto row = static_cast<Eigen::Index>(i);
    if (i + 1 < kArmJoints) {
      n += (at.origin_U[i + 1] - at.origin_U[i]).cross(f);
    }
    n += moment[i] + (at.center_U[i] - at.origin_U[i]).cross(force[i]);
    f += force[i];
    const Eigen::Vector3d& axis = i == 0 ? kUp : kRaise;
    bias[row] = axis.dot(n);

    // Composite body of this link and all outer ones, about its own centre of mass.
    const double total = mass + bodies_[i].mass_kg;
    const Eigen::Vector3d joined = (mass * center + bodies_[i].mass_kg * at.center_U[i]) / total;
    inertia += at.inertia_U[i] + point_inertia(mass, center - joined) +
               point_inertia(bodies_[i].mass_kg, at.center_U[i] - joined);
    mass = total;
    center = joined;
    const Eigen::Vector3d composite_force = mass * axis.cross(center - at.origin_U[i]);
    const Eigen::Vector3d composite_moment = inertia * axis;
    for (std::size_t j = 0; j <= i; ++j) {
      const auto column = static_cast<Eigen::Index>(j);
      const Eigen::Vector3d& other = j == 0 ? kUp : kRaise;
      const double entry =
          other.dot(composite_moment + (center - at.origin_U[j]).cross(composite_force));
      mass_matrix(row, column) = entry;
      mass_matrix(column, row) = entry;
    }
  }
}

JointVector ArmDynamics::gravity_load(const JointVector& q_rad) const {
  JointMatrix mass_matrix;
  JointVector bias;
  evaluate(q_rad, JointVector::Zero(), mass_matrix, bias);
  return bias;
}

double ArmDynamics::kinetic_energy_j(const JointVector& q_rad, const JointVector& v_radps) const {
  JointMatrix mass_matrix;
  JointVector bias;
  evaluate(q_rad, v_radps, mass_matrix, bias);
  return 0.5 * v_radps.dot(mass_matrix * v_radps);
}

double ArmDynamics::potential_energy_j(const JointVector& q_rad) const {
  const Placement at = place(q_rad);
  const Eigen::Matrix3d R_CU = Eigen::AngleAxisd(q_rad[0], kUp).toRotationMatrix();
  double energy = 0.0;
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    const Eigen::Vector3d p = R_CU * at.center_U[i] + swing_axis_height_m_ * kUp;
    energy -= bodies_[i].mass_kg * gravity_C_.dot(p);
  }
  return energy;
}

std::array<ArmDynamics::BodyMotion, kArmJoints> ArmDynamics::motion(
    const JointVector& q_rad, const JointVector& v_radps, const JointVector& a_radps2) const {
  const Placement at = place(q_rad);
  const Eigen::Matrix3d R_CU = Eigen::AngleAxisd(q_rad[0], kUp).toRotationMatrix();
  std::array<BodyMotion, kArmJoints> result;
  Eigen::Vector3d w = v_radps[0] * kUp;
  Eigen::Vector3d alpha = a_radps2[0] * kUp;
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    if (i > 0) {
      const auto joint = static_cast<Eigen::Index>(i);
      const Eigen::Vector3d step = at.origin_U[i] - at.origin_U[i - 1];
      v += w.cross(step);
      a += alpha.cross(step) + w.cross(w.cross(step));
      const Eigen::Vector3d rate = v_radps[joint] * kRaise;
      alpha += a_radps2[joint] * kRaise + w.cross(rate);
      w += rate;
    }
    result[i].R_CB = R_CU * at.R_UB[i];
    result[i].p_CB_C = R_CU * at.origin_U[i] + swing_axis_height_m_ * kUp;
    result[i].v_CB_C = R_CU * v;
    result[i].w_CB_C = R_CU * w;
    result[i].a_CB_C = R_CU * a;
    result[i].alpha_CB_C = R_CU * alpha;
  }
  return result;
}

Eigen::Matrix<double, 3, kArmJoints> ArmDynamics::bucket_jacobian_C(
    const JointVector& q_rad, const Eigen::Vector3d& point_B_m) const {
  const Placement at = place(q_rad);
  const Eigen::Matrix3d R_CU = Eigen::AngleAxisd(q_rad[0], kUp).toRotationMatrix();
  const Eigen::Vector3d p = at.origin_U[3] + at.R_UB[3] * point_B_m;
  Eigen::Matrix<double, 3, kArmJoints> J;
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    J.col(static_cast<Eigen::Index>(i)) = R_CU * (i == 0 ? kUp : kRaise).cross(p - at.origin_U[i]);
  }
  return J;
}

Eigen::Vector3d ArmDynamics::tip_C(const JointVector& q_rad) const {
  const Placement at = place(q_rad);
  const Eigen::Vector3d tip_U = at.origin_U[3] + bucket_tip_m_ * at.R_UB[3].col(0);
  return Eigen::AngleAxisd(q_rad[0], kUp) * tip_U + swing_axis_height_m_ * kUp;
}

}  // namespace rigwire::sim
