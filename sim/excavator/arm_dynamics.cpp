#include "sim/excavator/arm_dynamics.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

const Eigen::Vector3d kUp = Eigen::Vector3d::UnitZ();
const Eigen::Vector3d kRaise = -Eigen::Vector3d::UnitY();  // Turning about -y lifts x towards z.

Eigen::Matrix3d raised(const Turn& turn) {
  Eigen::Matrix3d R;
  R << turn.cosine, 0.0, -turn.sine, 0.0, 1.0, 0.0, turn.sine, 0.0, turn.cosine;
  return R;
}

}  // namespace

ArmDynamics::Moments ArmDynamics::moments_of(const RigidBodyParameters& body) {
  const Eigen::Vector3d& c = body.center_of_mass_m;
  const Eigen::Vector3d& inertia = body.principal_inertia_kgm2;
  // Integral of r r^T: diag(tr(I) / 2 - I_i) about the centre of mass, plus m c c^T (Steiner).
  const Eigen::Vector3d about_center = Eigen::Vector3d::Constant(0.5 * inertia.sum()) - inertia;
  return {body.mass_kg, body.mass_kg * c,
          Eigen::Matrix3d(about_center.asDiagonal()) + body.mass_kg * c * c.transpose()};
}

ArmDynamics::ArmDynamics(const ExcavatorParameters& parameters,
                         const Eigen::Vector3d& gravity_C_mps2)
    : links_{moments_of(parameters.upper), moments_of(parameters.boom),
             moments_of(parameters.stick), moments_of(parameters.bucket)},
      empty_bucket_(links_[3]),
      payload_center_m_(parameters.payload_center_of_mass_m),
      payload_max_kg_(parameters.payload_max_kg),
      boom_foot_m_(parameters.boom_foot_m),
      boom_length_m_(parameters.boom_length_m),
      stick_length_m_(parameters.stick_length_m),
      bucket_tip_m_(parameters.bucket_tip_m),
      swing_axis_height_m_(parameters.swing_axis_height_m),
      gravity_C_(gravity_C_mps2),
      level_(gravity_C_mps2.x() == 0.0 && gravity_C_mps2.y() == 0.0) {
  hang();
}

void ArmDynamics::set_payload_kg(double mass_kg) {
  payload_kg_ = mass_kg > 0.0 ? std::min(mass_kg, payload_max_kg_) : 0.0;
  const Eigen::Vector3d& p = payload_center_m_;
  // A point mass at p adds m, m p and m p p^T.
  links_[3] = {empty_bucket_.mass_kg + payload_kg_, empty_bucket_.first_kgm + payload_kg_ * p,
               empty_bucket_.second_kgm2 + payload_kg_ * p * p.transpose()};
  hang();
}

void ArmDynamics::hang() {
  const std::array<double, 3> lengths{boom_length_m_, stick_length_m_, 0.0};
  double outer_mass = 0.0;
  double outer_y = 0.0;
  Chain& chain = chain_;
  const Moments& upper = links_[0];
  chain.swing_inertia = upper.second_kgm2(0, 0) + upper.second_kgm2(1, 1);
  // From the bucket inwards: each link with the mass of the outer ones at its end pin.
  for (std::size_t i = 3; i-- > 0;) {
    const Moments& link = links_[i + 1];
    const Eigen::Matrix3d& second = link.second_kgm2;
    const double length = lengths[i];
    chain.mass_kg[i] = link.mass_kg;
    chain.first_x[i] = link.first_kgm.x();
    chain.first_z[i] = link.first_kgm.z();
    chain.hung_x[i] = link.first_kgm.x() + outer_mass * length;
    chain.hung_z[i] = link.first_kgm.z();
    chain.inertia[i] = second(0, 0) + second(2, 2) + outer_mass * length * length;
    chain.xx[i] = second(0, 0);
    chain.xz[i] = second(0, 2);
    chain.zz[i] = second(2, 2);
    chain.xy[i] = second(0, 1) + outer_y * length;
    chain.yz[i] = second(1, 2);
    chain.swing_inertia += second(1, 1);
    outer_mass += link.mass_kg;
    outer_y += link.first_kgm.y();
  }
  // The arm's y is measured from the boom foot's, which may be offset from the swing axis.
  const double foot_y = boom_foot_m_.y();
  chain.swing_inertia += foot_y * (2.0 * outer_y + outer_mass * foot_y);
  chain.xy[0] += foot_y * chain.hung_x[0];
  chain.xy[1] += foot_y * chain.hung_x[1];
  chain.xy[2] += foot_y * chain.hung_x[2];
  chain.yz[0] += foot_y * chain.hung_z[0];
  chain.yz[1] += foot_y * chain.hung_z[1];
  chain.yz[2] += foot_y * chain.hung_z[2];
  chain.upright_x = upper.first_kgm.x();
  chain.upright_y = upper.first_kgm.y() + outer_y + outer_mass * foot_y;
}

ArmDynamics::Placement ArmDynamics::place(const JointVector& q_rad) const {
  const ArmAngles at(q_rad);
  Placement placement;
  placement.R_UB = {Eigen::Matrix3d::Identity(), raised(at.link[0]), raised(at.link[1]),
                    raised(at.link[2])};
  placement.origin_U[0].setZero();
  placement.origin_U[1] = boom_foot_m_;
  placement.origin_U[2] = placement.origin_U[1] + boom_length_m_ * placement.R_UB[1].col(0);
  placement.origin_U[3] = placement.origin_U[2] + stick_length_m_ * placement.R_UB[2].col(0);
  return placement;
}

void ArmDynamics::evaluate(const JointVector& q_rad, const JointVector& v_radps,
                           JointMatrix& mass_matrix, JointVector& bias) const {
  evaluate(ArmAngles(q_rad), v_radps, mass_matrix, bias);
}

void ArmDynamics::evaluate(const ArmAngles& at, const JointVector& v_radps,
                           JointMatrix& mass_matrix, JointVector& bias) const {
  const Chain& k = chain_;
  const auto& link = at.link;
  const double boom = boom_length_m_;
  const double stick = stick_length_m_;
  const double w = v_radps[0];
  // Absolute rates, raising positive.
  const double w1 = v_radps[1];
  const double w2 = w1 + v_radps[2];
  const double w3 = w2 + v_radps[3];

  // The planar chain in absolute angles: constant diagonal, couplings a_ij and their slopes d_ij by
  // the outer angle.
  const Turn& t12 = at.joint[1];
  const Turn& t23 = at.joint[2];
  const Turn& t13 = at.stick_bucket;
  const double a12 = boom * (k.hung_x[1] * t12.cosine - k.hung_z[1] * t12.sine);
  const double d12 = -boom * (k.hung_x[1] * t12.sine + k.hung_z[1] * t12.cosine);
  const double a13 = boom * (k.hung_x[2] * t13.cosine - k.hung_z[2] * t13.sine);
  const double d13 = -boom * (k.hung_x[2] * t13.sine + k.hung_z[2] * t13.cosine);
  const double a23 = stick * (k.hung_x[2] * t23.cosine - k.hung_z[2] * t23.sine);
  const double d23 = -stick * (k.hung_x[2] * t23.sine + k.hung_z[2] * t23.cosine);
  // Lagrange's equations: sum over j of d_ij w_j^2, antisymmetric in i and j.
  double b1 = d12 * w2 * w2 + d13 * w3 * w3;
  double b2 = d23 * w3 * w3 - d12 * w1 * w1;
  double b3 = -d13 * w1 * w1 - d23 * w2 * w2;

  // Inertia about the swing axis, and its slopes s_i by the absolute angles. o_i: distance of the
  // links' origins from the axis, x_i: first moments of the links about their origins along x.
  const double o1 = boom_foot_m_.x();
  const double o2 = o1 + boom * link[0].cosine;
  const double o3 = o2 + stick * link[1].cosine;
  std::array<double, 3> x;
  std::array<double, 3> own;
  std::array<double, 3> slope;
  for (std::size_t i = 0; i < 3; ++i) {
    const double c = link[i].cosine;
    const double s = link[i].sine;
    x[i] = k.first_x[i] * c - k.first_z[i] * s;
    own[i] = c * c * k.xx[i] - 2.0 * c * s * k.xz[i] + s * s * k.zz[i];
    slope[i] = 2.0 * (c * s * (k.zz[i] - k.xx[i]) - (c * c - s * s) * k.xz[i]);
  }
  // J(q) about the axis: second moments turned by the link's angle, and o (m o + 2 x) of Steiner.
  const double swing_inertia =
      k.swing_inertia + own[0] + own[1] + own[2] + o1 * (k.mass_kg[0] * o1 + 2.0 * x[0]) +
      o2 * (k.mass_kg[1] * o2 + 2.0 * x[1]) + o3 * (k.mass_kg[2] * o3 + 2.0 * x[2]);
  // dJ / d(absolute angle i): the link's own part, and its end pin's way for all links outside it.
  const double pull3 = 2.0 * (k.mass_kg[2] * o3 + x[2]);
  const double pull2 = pull3 + 2.0 * (k.mass_kg[1] * o2 + x[1]);
  const auto turned = [&](std::size_t i) {
    return -2.0 * (k.first_x[i] * link[i].sine + k.first_z[i] * link[i].cosine);
  };
  const double s1 = slope[0] + o1 * turned(0) - boom * link[0].sine * pull2;
  const double s2 = slope[1] + o2 * turned(1) - stick * link[1].sine * pull3;
  const double s3 = slope[2] + o3 * turned(2);
  const double centrifugal = 0.5 * w * w;
  // Lagrange: centrifugal -w^2/2 dJ/dq on the arm, Coriolis w dJ/dt on the swing.
  b1 -= centrifugal * s1;
  b2 -= centrifugal * s2;
  b3 -= centrifugal * s3;
  double b0 = w * (s1 * w1 + s2 * w2 + s3 * w3);

  // What lies beside the plane couples swing and arm.
  const auto across = [&](std::size_t i) {
    return link[i].sine * k.xy[i] + link[i].cosine * k.yz[i];
  };
  const auto along = [&](std::size_t i) {
    return link[i].cosine * k.xy[i] - link[i].sine * k.yz[i];
  };
  const double c3 = across(2);
  const double c2 = across(1) + c3;
  const double c1 = across(0) + c2;
  b0 += along(0) * w1 * w1 + along(1) * w2 * w2 + along(2) * w3 * w3;

  // Gravity.
  double gx = 0.0;
  const double gz = gravity_C_.z();
  if (!level_) {
    const Turn swing = Turn::by(at.swing_rad);
    gx = swing.cosine * gravity_C_.x() + swing.sine * gravity_C_.y();
    const double gy = swing.cosine * gravity_C_.y() - swing.sine * gravity_C_.x();
    const double center_x = k.upright_x + o1 * k.mass_kg[0] + o2 * k.mass_kg[1] +
                            o3 * k.mass_kg[2] + x[0] + x[1] + x[2];
    b0 += gx * k.upright_y - gy * center_x;
  }
  // Moment of a link, with what hangs at its end, about its own joint.
  const auto weight = [&](std::size_t i) {
    const double forward = k.hung_x[i] * link[i].cosine - k.hung_z[i] * link[i].sine;
    const double upward = k.hung_x[i] * link[i].sine + k.hung_z[i] * link[i].cosine;
    return gx * upward - gz * forward;
  };
  b3 += weight(2);
  b2 += weight(1);
  b1 += weight(0);

  // From absolute to joint angles: each joint carries all links outside it.
  bias << b0, b1 + b2 + b3, b2 + b3, b3;
  const double m33 = k.inertia[2];
  const double m23 = m33 + a23;
  const double m13 = m23 + a13;
  const double m22 = k.inertia[1] + a23 + m23;
  const double m12 = m22 + a12 + a13;
  const double m11 = k.inertia[0] + a12 + a13 + m12;
  mass_matrix << swing_inertia, c1, c2, c3,  //
      c1, m11, m12, m13,                     //
      c2, m12, m22, m23,                     //
      c3, m13, m23, m33;
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
  // v^T M v / 2
  return 0.5 * v_radps.dot(mass_matrix * v_radps);
}

double ArmDynamics::potential_energy_j(const JointVector& q_rad) const {
  const Placement at = place(q_rad);
  const Eigen::Matrix3d R_CU = Eigen::AngleAxisd(q_rad[0], kUp).toRotationMatrix();
  double energy = 0.0;
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    const double mass = links_[i].mass_kg;
    const Eigen::Vector3d first = R_CU * (mass * at.origin_U[i] + at.R_UB[i] * links_[i].first_kgm);
    energy -= gravity_C_.dot(first + mass * swing_axis_height_m_ * kUp);
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
      // Outward recursion: v + w x r, a + alpha x r + w x (w x r), then the joint's own rate.
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
    // Geometric Jacobian: axis_i x (p - origin_i).
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
