// Mass matrix, bias and motion of the arm with its undercarriage (carried_arm.h).
#include "sim/excavator/carried_arm.h"

namespace rigwire::sim {
namespace {

using SpatialVector = CarriedArm::SpatialVector;

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

/// v x m of spatial motion vectors (Featherstone 2008, chapter 2).
SpatialVector cross_motion(const SpatialVector& v, const SpatialVector& m) {
  const Eigen::Vector3d w = v.head<3>();
  SpatialVector result;
  result << w.cross(m.head<3>()), w.cross(m.tail<3>()) + v.tail<3>().cross(m.head<3>());
  return result;
}

/// v x* f, the dual on force vectors (Featherstone 2008, chapter 2).
SpatialVector cross_force(const SpatialVector& v, const SpatialVector& f) {
  const Eigen::Vector3d w = v.head<3>();
  SpatialVector result;
  result << w.cross(f.head<3>()) + v.tail<3>().cross(f.tail<3>()), w.cross(f.tail<3>());
  return result;
}

/// Motion subspace of a revolute joint: axis, and the velocity it gives to C's origin.
SpatialVector turning(const Eigen::Vector3d& axis, const Eigen::Vector3d& through) {
  SpatialVector result;
  result << axis, through.cross(axis);
  return result;
}

}  // namespace

CarriedArm::Placement CarriedArm::place_links(const JointVector& q_rad) const {
  const ArmAngles at(q_rad);
  Placement result;
  const Eigen::Matrix3d R_CU = Eigen::AngleAxisd(q_rad[0], Eigen::Vector3d::UnitZ()).matrix();
  result.R_CB[0].setIdentity();
  result.origin_C[0].setZero();
  result.R_CB[1] = R_CU;
  result.origin_C[1] = {0.0, 0.0, parameters_.swing_axis_height_m};
  const std::array<Eigen::Vector3d, 3> way{parameters_.boom_foot_m,
                                           Eigen::Vector3d(parameters_.boom_length_m, 0.0, 0.0),
                                           Eigen::Vector3d(parameters_.stick_length_m, 0.0, 0.0)};
  for (std::size_t i = 0; i < 3; ++i) {
    const Turn& turn = at.link[i];
    Eigen::Matrix3d raised;
    raised << turn.cosine, 0.0, -turn.sine, 0.0, 1.0, 0.0, turn.sine, 0.0, turn.cosine;
    result.origin_C[i + 2] = result.origin_C[i + 1] + result.R_CB[i + 1] * way[i];
    result.R_CB[i + 2].noalias() = R_CU * raised;
  }
  const Eigen::Vector3d raise = -R_CU.col(1);
  for (std::size_t i = 0; i < 4; ++i) {
    result.axis[i] = turning(i == 0 ? Eigen::Vector3d::UnitZ() : raise, result.origin_C[i + 1]);
  }
  return result;
}

CarriedArm::SpatialMatrix CarriedArm::inertia_of(const ArmDynamics::Moments& moments,
                                                 const Eigen::Matrix3d& R,
                                                 const Eigen::Vector3d& origin) const {
  const Eigen::Vector3d turned = R * moments.first_kgm;
  // First and second moments shifted to C's origin; rotational inertia = tr(S) 1 - S.
  const Eigen::Vector3d first = turned + moments.mass_kg * origin;
  const Eigen::Matrix3d second = R * moments.second_kgm2 * R.transpose() +
                                 origin * turned.transpose() + turned * origin.transpose() +
                                 moments.mass_kg * origin * origin.transpose();
  SpatialMatrix inertia;
  inertia.topLeftCorner<3, 3>() = second.trace() * Eigen::Matrix3d::Identity() - second;
  inertia.topRightCorner<3, 3>() = cross_matrix(first);
  inertia.bottomLeftCorner<3, 3>() = -cross_matrix(first);
  inertia.bottomRightCorner<3, 3>() = moments.mass_kg * Eigen::Matrix3d::Identity();
  return inertia;
}

void CarriedArm::equations(const DrivenArm& arm, Placement& at, const JointVector& q_rad,
                           Matrix& mass_matrix, Velocities& bias) const {
  at = place_links(q_rad);
  at.inertia[0] = inertia_of(undercarriage_, at.R_CB[0], at.origin_C[0]);
  for (std::size_t i = 0; i < 4; ++i) {
    at.inertia[i + 1] = inertia_of(arm.dynamics().moments()[i], at.R_CB[i + 1], at.origin_C[i + 1]);
  }
  // Outward, with gravity as an upward acceleration of the undercarriage.
  std::array<SpatialVector, 5> force;
  SpatialVector v = velocity_.head<6>();
  SpatialVector a = SpatialVector::Zero();
  a.tail<3>() = X_WC_.linear().row(2).transpose() * parameters_.gravity_mps2;
  for (std::size_t i = 0; i < 5; ++i) {
    if (i > 0) {
      const SpatialVector rate = at.axis[i - 1] * velocity_[static_cast<Eigen::Index>(i + 5)];
      v += rate;
      a += cross_motion(v, rate);
    }
    // Recursive Newton-Euler: f = I a + v x* (I v), a without joint accelerations.
    const SpatialVector momentum = at.inertia[i] * v;
    force[i] = at.inertia[i] * a + cross_force(v, momentum);
  }
  // Inward.
  SpatialVector f = SpatialVector::Zero();
  SpatialMatrix composite = SpatialMatrix::Zero();
  for (std::size_t i = 5; i-- > 0;) {
    // Composite rigid bodies: forces and inertias of all links outside the joint add up.
    f += force[i];
    composite += at.inertia[i];
    if (i == 0) {
      bias.head<6>() = f;
      mass_matrix.topLeftCorner<6, 6>() = composite;
      break;
    }
    const auto row = static_cast<Eigen::Index>(i + 5);
    bias[row] = at.axis[i - 1].dot(f);
    // Column of M: S_j^T (I_composite S_i); with the undercarriage I_composite S_i itself.
    const SpatialVector column = composite * at.axis[i - 1];
    mass_matrix.block<6, 1>(0, row) = column;
    mass_matrix.block<1, 6>(row, 0) = column.transpose();
    for (std::size_t j = 1; j <= i; ++j) {
      const auto other = static_cast<Eigen::Index>(j + 5);
      mass_matrix(row, other) = mass_matrix(other, row) = at.axis[j - 1].dot(column);
    }
  }
}

CarriedArm::Velocities CarriedArm::point_row(const Placement& at, const Eigen::Vector3d& point_C,
                                             const Eigen::Vector3d& direction_C,
                                             std::size_t link) const {
  SpatialVector along;
  // Row of a unit force at a point: its wrench against undercarriage and joint axes.
  along << point_C.cross(direction_C), direction_C;
  Velocities row = Velocities::Zero();
  row.head<6>() = along;
  for (std::size_t i = 0; i < link; ++i) {
    row[static_cast<Eigen::Index>(i + 6)] = at.axis[i].dot(along);
  }
  return row;
}

std::array<LinkMotion, 5> CarriedArm::motion(const ArmState& state) const {
  const Placement at = place_links(state.q_rad);
  const Eigen::Matrix3d R_WC = X_WC_.linear();
  std::array<LinkMotion, 5> links;
  SpatialVector v = velocity_.head<6>();
  SpatialVector a = acceleration_.head<6>();
  for (std::size_t i = 0; i < 5; ++i) {
    if (i > 0) {
      const auto joint = static_cast<Eigen::Index>(i + 5);
      const SpatialVector rate = at.axis[i - 1] * velocity_[joint];
      v += rate;
      a += at.axis[i - 1] * acceleration_[joint] + cross_motion(v, rate);
    }
    const Eigen::Vector3d w = v.head<3>();
    const Eigen::Vector3d alpha = a.head<3>();
    const Eigen::Vector3d& p = at.origin_C[i];
    // Spatial to ordinary acceleration of the link's origin: a_O + alpha x p + w x v.
    const Eigen::Vector3d speed = v.tail<3>() + w.cross(p);
    LinkMotion& link = links[i];
    link.X_WL.linear() = R_WC * at.R_CB[i];
    link.X_WL.translation() = X_WC_ * p;
    link.v_WL_W = R_WC * speed;
    link.w_WL_W = R_WC * w;
    link.a_WL_W = R_WC * (a.tail<3>() + alpha.cross(p) + w.cross(speed));
    link.alpha_WL_W = R_WC * alpha;
  }
  return links;
}

CarriedArm::Momentum CarriedArm::momentum(const DrivenArm& arm, const ArmState& state) const {
  Placement at = place_links(state.q_rad);
  SpatialVector v = velocity_.head<6>();
  SpatialVector sum = SpatialVector::Zero();
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  double mass = 0.0;
  for (std::size_t i = 0; i < 5; ++i) {
    const ArmDynamics::Moments& moments = i == 0 ? undercarriage_ : arm.dynamics().moments()[i - 1];
    if (i > 0) {
      v += at.axis[i - 1] * state.v_radps[static_cast<Eigen::Index>(i) - 1];
    }
    sum += inertia_of(moments, at.R_CB[i], at.origin_C[i]) * v;
    first += at.R_CB[i] * moments.first_kgm + moments.mass_kg * at.origin_C[i];
    mass += moments.mass_kg;
  }
  // Angular momentum from C's origin to the common centre of mass: L - c x p.
  const Eigen::Vector3d linear = sum.tail<3>();
  const Eigen::Vector3d angular = sum.head<3>() - (first / mass).cross(linear);
  return {X_WC_.linear() * linear, X_WC_.linear() * angular};
}

}  // namespace rigwire::sim
