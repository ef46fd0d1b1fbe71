// The arm's equations by the textbook, for any links: composite rigid bodies and recursive
// Newton-Euler in the upper structure's frame (Featherstone, Rigid Body Dynamics Algorithms, 2008,
// chapters 5 and 6). Slow and general; what sim/excavator/arm_dynamics.h is held against.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "sim/excavator/arm_angles.h"
#include "sim/excavator/parameters.h"

namespace rigwire::sim {

class GeneralArmDynamics {
 public:
  GeneralArmDynamics(const ExcavatorParameters& p, const Eigen::Vector3d& gravity_C_mps2)
      : p_(p), gravity_C_(gravity_C_mps2) {
    const RigidBodyParameters* links[] = {&p.upper, &p.boom, &p.stick, &p.bucket};
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      bodies_[i] = {links[i]->mass_kg, links[i]->center_of_mass_m,
                    links[i]->principal_inertia_kgm2.asDiagonal()};
    }
  }

  void add_payload_kg(double mass_kg) {
    Body& bucket = bodies_[3];
    const Body empty = bucket;
    const Eigen::Vector3d& at = p_.payload_center_of_mass_m;
    bucket.mass_kg += mass_kg;
    bucket.center_m = (empty.mass_kg * empty.center_m + mass_kg * at) / bucket.mass_kg;
    bucket.inertia_kgm2 = empty.inertia_kgm2 +
                          point_inertia(empty.mass_kg, empty.center_m - bucket.center_m) +
                          point_inertia(mass_kg, at - bucket.center_m);
  }

  void evaluate(const JointVector& q_rad, const JointVector& v_radps, JointMatrix& mass_matrix,
                JointVector& bias) const {
    const Placement at = place(q_rad);

    // Bias: outward accelerations with zero joint acceleration, gravity as an upward acceleration
    // of the base, then inward forces.
    const double cosine = std::cos(q_rad[0]);
    const double sine = std::sin(q_rad[0]);
    const Eigen::Vector3d base_acceleration(-(cosine * gravity_C_.x() + sine * gravity_C_.y()),
                                            -(cosine * gravity_C_.y() - sine * gravity_C_.x()),
                                            -gravity_C_.z());
    std::array<Eigen::Vector3d, kArmJoints> force;
    std::array<Eigen::Vector3d, kArmJoints> moment;  // About each body's centre of mass.
    Eigen::Vector3d w = v_radps[0] * kUp();
    Eigen::Vector3d alpha = Eigen::Vector3d::Zero();
    Eigen::Vector3d a_origin = base_acceleration;
    for (std::size_t i = 0; i < kArmJoints; ++i) {
      if (i > 0) {
        const Eigen::Vector3d step = at.origin_U[i] - at.origin_U[i - 1];
        a_origin += alpha.cross(step) + w.cross(w.cross(step));
        const Eigen::Vector3d rate = v_radps[static_cast<Eigen::Index>(i)] * kRaise();
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
      const Eigen::Vector3d axis = i == 0 ? kUp() : kRaise();
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
        const Eigen::Vector3d other = j == 0 ? kUp() : kRaise();
        const double entry =
            other.dot(composite_moment + (center - at.origin_U[j]).cross(composite_force));
        mass_matrix(row, column) = entry;
        mass_matrix(column, row) = entry;
      }
    }
  }

 private:
  struct Body {
    double mass_kg = 0.0;
    Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
    Eigen::Matrix3d inertia_kgm2 = Eigen::Matrix3d::Zero();  ///< About the centre of mass.
  };
  struct Placement {
    std::array<Eigen::Matrix3d, kArmJoints> R_UB;
    std::array<Eigen::Vector3d, kArmJoints> origin_U;
    std::array<Eigen::Vector3d, kArmJoints> center_U;
    std::array<Eigen::Matrix3d, kArmJoints> inertia_U;
  };
  static Eigen::Vector3d kUp() { return Eigen::Vector3d::UnitZ(); }
  static Eigen::Vector3d kRaise() { return -Eigen::Vector3d::UnitY(); }
  static Eigen::Matrix3d raised(double cosine, double sine) {
    Eigen::Matrix3d R;
    R << cosine, 0.0, -sine, 0.0, 1.0, 0.0, sine, 0.0, cosine;
    return R;
  }
  static Eigen::Matrix3d point_inertia(double mass_kg, const Eigen::Vector3d& r) {
    return mass_kg * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
  }

  [[nodiscard]] Placement place(const JointVector& q_rad) const {
    Placement placement;
    placement.R_UB[0].setIdentity();
    placement.origin_U[0].setZero();
    placement.center_U[0] = bodies_[0].center_m;
    placement.inertia_U[0] = bodies_[0].inertia_kgm2;
    const std::array<double, 2> lengths{p_.boom_length_m, p_.stick_length_m};
    double angle = 0.0;
    for (std::size_t i = 1; i < kArmJoints; ++i) {
      angle += q_rad[static_cast<Eigen::Index>(i)];
      Eigen::Matrix3d& R = placement.R_UB[i];
      R = raised(std::cos(angle), std::sin(angle));
      placement.origin_U[i] = i == 1
                                  ? p_.boom_foot_m
                                  : Eigen::Vector3d(placement.origin_U[i - 1] +
                                                    lengths[i - 2] * placement.R_UB[i - 1].col(0));
      placement.center_U[i] = placement.origin_U[i] + R * bodies_[i].center_m;
      placement.inertia_U[i].noalias() = R * bodies_[i].inertia_kgm2 * R.transpose();
    }
    return placement;
  }

  ExcavatorParameters p_;
  Eigen::Vector3d gravity_C_;
  std::array<Body, kArmJoints> bodies_;
};

}  // namespace rigwire::sim
