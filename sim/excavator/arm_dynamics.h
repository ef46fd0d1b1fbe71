// Rigid-body dynamics of the four joints swing, boom, stick, bucket in reduced coordinates:
//
//     M(q) a + bias(q, v) = tau
//
// Boom, stick and bucket turn about the same direction, so that Lagrange's equations have a short
// closed form in the links' absolute angles: a planar chain whose couplings depend only on
// differences of angles, rotated by the swing; the angles change its inertia about the vertical. A
// link enters by its mass, first and second moments (products of inertia and centres of mass off
// the plane included). The results equal those of composite rigid bodies and recursive Newton-Euler
// (tests/support/sim/general_arm_dynamics.h) to rounding, at a fifth of their cost. Cylinders are
// massless force elements (linkage.h); the undercarriage is at rest.
//
// Fixed sizes, no allocation. Joint order and angles as in arm_angles.h and parameters.h. Vectors
// named _U are expressed in the upper structure's frame.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>

#include "sim/excavator/arm_angles.h"
#include "sim/excavator/parameters.h"

namespace rigwire::sim {

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

  /// A link's mass moments about its origin, in its own frame.
  struct Moments {
    double mass_kg = 0.0;
    Eigen::Vector3d first_kgm = Eigen::Vector3d::Zero();
    Eigen::Matrix3d second_kgm2 = Eigen::Matrix3d::Zero();  ///< Integral of r r^T.
  };
  [[nodiscard]] static Moments moments_of(const RigidBodyParameters& body);

  /// `gravity_C_mps2`: the acceleration of free fall in the undercarriage's frame.
  ArmDynamics(const ExcavatorParameters& parameters, const Eigen::Vector3d& gravity_C_mps2);

  /// Rides in the bucket from now on, as a point mass at payload_center_of_mass_m. It is taken up
  /// at the bucket's velocity, so that velocities do not jump. Range 0 .. payload_max_kg, clamped.
  void set_payload_kg(double mass_kg);
  [[nodiscard]] double payload_kg() const { return payload_kg_; }

  /// M(q) and bias(q, v).
  void evaluate(const ArmAngles& at, const JointVector& v_radps, JointMatrix& mass_matrix,
                JointVector& bias) const;
  void evaluate(const JointVector& q_rad, const JointVector& v_radps, JointMatrix& mass_matrix,
                JointVector& bias) const;

  /// Torques that hold the arm still at q: the bias without velocity.
  [[nodiscard]] JointVector gravity_load(const JointVector& q_rad) const;

  /// Upper, boom, stick, bucket with what it carries.
  [[nodiscard]] const std::array<Moments, kArmJoints>& moments() const { return links_; }

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
  /// Constants of boom, stick and bucket for evaluate(), each with the outer links at its end pin.
  struct Chain {
    std::array<double, 3> mass_kg{};             ///< Mass of the link alone.
    std::array<double, 3> first_x{}, first_z{};  ///< First moments of the link alone, kg m.
    /// First moments with the outer links' mass at its end, kg m.
    std::array<double, 3> hung_x{}, hung_z{};
    std::array<double, 3> inertia{};         ///< About its own joint, outer links at its end.
    std::array<double, 3> xx{}, xz{}, zz{};  ///< Second moments of the link alone, kg m2.
    std::array<double, 3> xy{}, yz{};  ///< Products across the plane, with the outer links, kg m2.
    double swing_inertia = 0.0;        ///< Part that is independent of the angles, kg m2.
    /// First moments that are independent of the angles, kg m.
    double upright_x = 0.0, upright_y = 0.0;
  };
  void hang();

  struct Placement {
    std::array<Eigen::Matrix3d, kArmJoints> R_UB;
    std::array<Eigen::Vector3d, kArmJoints> origin_U;
  };
  [[nodiscard]] Placement place(const JointVector& q_rad) const;

  std::array<Moments, kArmJoints> links_;
  Moments empty_bucket_;
  Chain chain_;
  Eigen::Vector3d payload_center_m_;
  double payload_max_kg_;
  double payload_kg_ = 0.0;
  Eigen::Vector3d boom_foot_m_;
  double boom_length_m_;
  double stick_length_m_;
  double bucket_tip_m_;
  double swing_axis_height_m_;
  Eigen::Vector3d gravity_C_;
  bool level_;  ///< Gravity has no part that the swing feels.
};

}  // namespace rigwire::sim
