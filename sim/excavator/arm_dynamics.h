// Rigid-body dynamics of the four joints swing, boom, stick, bucket in reduced coordinates:
//
//     M(q) a + bias(q, v) = tau
//
// M by composite rigid bodies, bias (Coriolis, centrifugal, gravity) by recursive Newton-Euler,
// both in the upper structure's frame; Featherstone, Rigid Body Dynamics Algorithms, 2008, chapters
// 5 and 6. Cylinders are massless force elements (linkage.h); the undercarriage stands still.
//
// Fixed sizes, no allocation. Joint order: 0 swing, 1 boom, 2 stick, 3 bucket; angles as in
// parameters.h. Vectors named _U are expressed in the upper structure's frame.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>

#include "sim/excavator/parameters.h"

namespace rigwire::sim {

inline constexpr int kArmJoints = 4;

/// One number per joint.
using JointVector = Eigen::Vector4d;
using JointMatrix = Eigen::Matrix4d;

class ArmDynamics {
 public:
  /// A link's motion relative to the undercarriage, expressed in the undercarriage's frame C.
  struct BodyMotion {
    Eigen::Matrix3d R_CB = Eigen::Matrix3d::Identity();
    Eigen::Vector3d p_CB_C = Eigen::Vector3d::Zero();
    Eigen::Vector3d v_CB_C = Eigen::Vector3d::Zero();
    Eigen::Vector3d w_CB_C = Eigen::Vector3d::Zero();
    Eigen::Vector3d a_CB_C = Eigen::Vector3d::Zero();
    Eigen::Vector3d alpha_CB_C = Eigen::Vector3d::Zero();
  };

  /// `gravity_C_mps2`: the acceleration of free fall in the undercarriage's frame.
  ArmDynamics(const ExcavatorParameters& parameters, const Eigen::Vector3d& gravity_C_mps2);

  /// Rides in the bucket from now on, as a point mass at payload_center_of_mass_m. It is taken up
  /// at the bucket's velocity, so that velocities do not jump. Range 0 .. payload_max_kg, clamped.
  void set_payload_kg(double mass_kg);
  [[nodiscard]] double payload_kg() const { return payload_kg_; }

  /// M(q) and bias(q, v).
  void evaluate(const JointVector& q_rad, const JointVector& v_radps, JointMatrix& mass_matrix,
                JointVector& bias) const;

  /// Torques that hold the arm still at q: the bias without velocity.
  [[nodiscard]] JointVector gravity_load(const JointVector& q_rad) const;

  /// Joules; the potential is zero at the undercarriage's origin.
  [[nodiscard]] double kinetic_energy_j(const JointVector& q_rad, const JointVector& v_radps) const;
  [[nodiscard]] double potential_energy_j(const JointVector& q_rad) const;

  /// Upper, boom, stick, bucket with accelerations a.
  [[nodiscard]] std::array<BodyMotion, kArmJoints> motion(const JointVector& q_rad,
                                                          const JointVector& v_radps,
                                                          const JointVector& a_radps2) const;

  /// Columns dp/dq_j of a point of the bucket, given in the bucket's frame, expressed in the
  /// undercarriage's frame: velocity J v, and torques J^T f of a force f there.
  [[nodiscard]] Eigen::Matrix<double, 3, kArmJoints> bucket_jacobian_C(
      const JointVector& q_rad, const Eigen::Vector3d& point_B_m) const;

  /// The teeth's tip in the undercarriage's frame.
  [[nodiscard]] Eigen::Vector3d tip_C(const JointVector& q_rad) const;

 private:
  struct Body {
    double mass_kg = 0.0;
    Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
    Eigen::Matrix3d inertia_kgm2 = Eigen::Matrix3d::Zero();  ///< About the centre of mass.
  };
  /// Everything about one configuration, in the upper structure's frame.
  struct Placement {
    std::array<Eigen::Matrix3d, kArmJoints> R_UB;
    std::array<Eigen::Vector3d, kArmJoints> origin_U;
    std::array<Eigen::Vector3d, kArmJoints> center_U;  ///< Centres of mass.
    std::array<Eigen::Matrix3d, kArmJoints> inertia_U;
  };

  [[nodiscard]] Placement place(const JointVector& q_rad) const;

  std::array<Body, kArmJoints> bodies_;
  Body empty_bucket_;
  Eigen::Vector3d payload_center_m_;
  double payload_max_kg_;
  double payload_kg_ = 0.0;
  Eigen::Vector3d boom_foot_m_;
  double boom_length_m_;
  double stick_length_m_;
  double bucket_tip_m_;
  double swing_axis_height_m_;
  Eigen::Vector3d gravity_C_;
};

}  // namespace rigwire::sim
