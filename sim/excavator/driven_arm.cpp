#include "sim/excavator/driven_arm.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

constexpr double kStopDampingRatio = 0.5;
// Switches of one relief valve or resistance: to a limit, back, to a limit, back.
constexpr int kDriveSwitchesMax = 4;
// Stops go on and off at most once each.
constexpr int kDrivePassesMax =
    2 * kArmJoints + kDriveSwitchesMax * (kArmJoints + static_cast<int>(kTipResistances));

enum class StopState { off, low, high, released };

// x of m x = right, symmetric, positive definite, by L D L^T, unrolled: about a third of what a
// general factorisation of this size costs. Only the lower half of m is read.
JointVector solve_joints(const JointMatrix& m, const JointVector& right) {
  const double d0 = 1.0 / m(0, 0);
  const double l10 = m(1, 0) * d0;
  const double l20 = m(2, 0) * d0;
  const double l30 = m(3, 0) * d0;
  const double d1 = 1.0 / (m(1, 1) - l10 * m(1, 0));
  const double u21 = m(2, 1) - l20 * m(1, 0);
  const double u31 = m(3, 1) - l30 * m(1, 0);
  const double l21 = u21 * d1;
  const double l31 = u31 * d1;
  const double d2 = 1.0 / (m(2, 2) - l20 * m(2, 0) - l21 * u21);
  const double u32 = m(3, 2) - l30 * m(2, 0) - l31 * u21;
  const double l32 = u32 * d2;
  const double d3 = 1.0 / (m(3, 3) - l30 * m(3, 0) - l31 * u31 - l32 * u32);
  const double y0 = right[0];
  const double y1 = right[1] - l10 * y0;
  const double y2 = right[2] - l20 * y0 - l21 * y1;
  const double y3 = right[3] - l30 * y0 - l31 * y1 - l32 * y2;
  const double x3 = y3 * d3;
  const double x2 = y2 * d2 - l32 * x3;
  const double x1 = y1 * d1 - l21 * x2 - l31 * x3;
  return {y0 * d0 - l10 * x1 - l20 * x2 - l30 * x3, x1, x2, x3};
}

}  // namespace

DrivenArm::DrivenArm(const ExcavatorParameters& parameters, const Eigen::Vector3d& gravity_C_mps2)
    : dynamics_(parameters, gravity_C_mps2),
      linkages_(parameters),
      stop_stiffness_(parameters.drives.end_stop_stiffness_npm) {
  const DriveParameters& drives = parameters.drives;
  const ExcavatorPose& pose = parameters.initial;
  length_least_ << -1e300, linkages_.range(0).length_min_m, linkages_.range(1).length_min_m,
      linkages_.range(2).length_min_m;
  length_greatest_ << 1e300, linkages_.range(0).length_max_m, linkages_.range(1).length_max_m,
      linkages_.range(2).length_max_m;
  const JointVector q(pose.swing_rad, pose.boom_rad, pose.stick_rad, pose.bucket_rad);
  gains.stiffness << drives.swing_stiffness_nmprad, drives.boom_stiffness_npm,
      drives.stick_stiffness_npm, drives.bucket_stiffness_npm;
  gains.damping = damping_for(q, gains.stiffness, drives.damping_ratio);
  stop_damping_ = damping_for(q, JointVector::Constant(stop_stiffness_), kStopDampingRatio);
}

ArmPose DrivenArm::pose(const JointVector& q_rad) const {
  ArmPose pose;
  pose.angles = ArmAngles(q_rad);
  const CylinderGeometry boom = linkages_.boom().at(pose.angles.joint[0]);
  const CylinderGeometry stick = linkages_.stick().at(pose.angles.joint[1]);
  const CylinderGeometry bucket = linkages_.bucket().at(pose.angles.joint[2]);
  pose.x << q_rad[0], boom.length_m, stick.length_m, bucket.length_m;
  pose.lever << 1.0, boom.lever_m, stick.lever_m, bucket.lever_m;
  return pose;
}

DrivenArm::Inertia DrivenArm::inertia_at(const JointVector& q_rad) const {
  JointMatrix mass_matrix;
  JointVector bias;
  dynamics_.evaluate(q_rad, JointVector::Zero(), mass_matrix, bias);
  Inertia inertia;
  inertia.lever = pose(q_rad).lever;
  inertia.inverse = mass_matrix.inverse();
  return inertia;
}

JointVector DrivenArm::free_mass(const JointVector& q_rad) const {
  const Inertia inertia = inertia_at(q_rad);
  // Mass seen by one drive, the others free: 1 / (J M^-1 J^T).
  return (inertia.inverse.diagonal().array() * inertia.lever.array().square()).inverse();
}

JointVector DrivenArm::damping_for(const JointVector& q_rad, const JointVector& stiffness,
                                   double ratio) const {
  // d = 2 zeta sqrt(k m).
  return 2.0 * ratio * (stiffness.array() * free_mass(q_rad).array()).sqrt();
}

double DrivenArm::highest_frequency_radps(const JointVector& q_rad,
                                          const JointVector& stiffness) const {
  const Inertia inertia = inertia_at(q_rad);
  const JointVector joint_stiffness = stiffness.array() * inertia.lever.array().square();
  // Power iteration on M^-1 K; the estimate grows towards the largest eigenvalue from below.
  JointVector mode = JointVector::Ones();
  double eigenvalue = 0.0;
  for (int i = 0; i < 100; ++i) {
    const JointVector next = inertia.inverse * joint_stiffness.cwiseProduct(mode);
    eigenvalue = next.norm() / mode.norm();
    if (!(eigenvalue > 0.0)) {
      return 0.0;
    }
    mode = next / next.norm();
  }
  return std::sqrt(eigenvalue);
}

DriveLaws DrivenArm::laws(const ArmPose& at, double h, const JointVector& target,
                          const JointVector& rate) const {
  DriveLaws result{.force = {}, .least = gains.force_least, .greatest = gains.force_greatest};
  for (int i = 0; i < kArmJoints; ++i) {
    // k (x_t - x - h x') + d (v_t - x'), x' at the step's end.
    result.force[static_cast<std::size_t>(i)] = {
        gains.stiffness[i] * (target[i] - at.x[i]) + gains.damping[i] * rate[i],
        gains.damping[i] + h * gains.stiffness[i]};
  }
  return result;
}

ArmStep DrivenArm::advance(double h, const ArmPose& at, const DriveLaws& laws,
                           ArmState& state) const {
  JointMatrix mass_matrix;
  JointVector bias;
  dynamics_.evaluate(at.angles, state.v_radps, mass_matrix, bias);
  const JointVector& lever = at.lever;
  const JointVector x_rate = lever.cwiseProduct(state.v_radps);

  std::array<int, kArmJoints> clamped{};  // -1 at the minimum force, 1 at the maximum, 0 free.
  std::array<int, kArmJoints> drive_switches{};
  std::array<StopState, kArmJoints> stops{};
  std::array<int, kTipResistances> yielded{};
  std::array<int, kTipResistances> switches{};
  ArmStep result;
  JointVector& a = result.acceleration_radps2;
  // (M + h sum gain J^2) a = rest + sum J F(start), clamp last (driven_arm.h).
  for (int pass = 0; pass < kDrivePassesMax; ++pass) {
    JointMatrix left = mass_matrix;
    JointVector right = load.torque - bias;
    for (int i = 0; i < kArmJoints; ++i) {
      const auto n = static_cast<std::size_t>(i);
      if (clamped[n] == 0) {
        left(i, i) += h * laws.force[n].gain * lever[i] * lever[i];
        right[i] += lever[i] * laws.force[n].at(x_rate[i]);
      } else {
        right[i] += lever[i] * (clamped[n] > 0 ? laws.greatest[i] : laws.least[i]);
      }
      if (stops[n] == StopState::low || stops[n] == StopState::high) {
        const ImplicitForce stop = stop_law(i, stops[n] == StopState::low, h, at.x[i]);
        left(i, i) += h * stop.gain * lever[i] * lever[i];
        right[i] += lever[i] * stop.at(x_rate[i]);
      }
    }
    for (std::size_t i = 0; i < load.resistance_count; ++i) {
      const ArmLoad::Resistance& each = load.resistances[i];
      if (yielded[i] == 0) {
        const double held = each.offset - each.gain * each.jacobian.dot(state.v_radps);
        left.noalias() += h * each.gain * each.jacobian * each.jacobian.transpose();
        right += held * each.jacobian;
      } else {
        right += yielded[i] * each.limit * each.jacobian;
      }
    }
    for (const ArmContact& contact : load.contacts) {
      for (std::size_t i = 0; i < 3; ++i) {
        const ImplicitForce law = contact.point->acting(i);
        const JointVector& row = contact.rows[i];
        left.noalias() += h * law.gain * row * row.transpose();
        right += law.at(row.dot(state.v_radps)) * row;
      }
    }
    a = solve_joints(left, right);

    bool changed = false;
    for (int i = 0; i < kArmJoints; ++i) {
      const auto n = static_cast<std::size_t>(i);
      // One that was relieved before another valve opened may hold again after it: without the
      // way back it would push at its limit along the motion.
      const double free = laws.force[n].at(x_rate[i]) - h * laws.force[n].gain * lever[i] * a[i];
      const int beyond = free > laws.greatest[i] ? 1 : free < laws.least[i] ? -1 : 0;
      if (beyond != clamped[n] && drive_switches[n] < kDriveSwitchesMax) {
        ++drive_switches[n];
        clamped[n] = clamped[n] == 0 ? beyond : 0;
        changed = true;
      }
      result.relieved[n] = clamped[n] != 0;
      result.force[i] = clamped[n] > 0   ? laws.greatest[i]
                        : clamped[n] < 0 ? laws.least[i]
                                         : std::clamp(free, laws.least[i], laws.greatest[i]);
      if (!gains.end_stops || i == 0) {
        continue;
      }
      const double end_rate = x_rate[i] + h * lever[i] * a[i];
      const double end_x = at.x[i] + h * end_rate;
      if (stops[n] == StopState::off && (end_x < length_least_[i] || end_x > length_greatest_[i])) {
        stops[n] = end_x < length_least_[i] ? StopState::low : StopState::high;
        changed = true;
      } else if (stops[n] == StopState::low || stops[n] == StopState::high) {
        const bool low = stops[n] == StopState::low;
        const double force = stop_law(i, low, h, at.x[i]).at(end_rate);
        if (low ? force < 0.0 : force > 0.0) {  // A stop pushes, it never pulls.
          stops[n] = StopState::released;
          changed = true;
        }
      }
    }
    for (std::size_t i = 0; i < load.resistance_count; ++i) {
      const ArmLoad::Resistance& each = load.resistances[i];
      double& force = result.resistance_n[i];
      const double free = each.offset - each.gain * each.jacobian.dot(state.v_radps + h * a);
      const int beyond = free > each.limit ? 1 : free < -each.limit ? -1 : 0;
      force = yielded[i] == 0 ? free : yielded[i] * each.limit;
      // A limit is also left in steps: the way from one limit to the other leads through holding.
      if (beyond != yielded[i] && switches[i] < kDriveSwitchesMax) {
        ++switches[i];
        yielded[i] = yielded[i] == 0 ? beyond : 0;
        changed = true;
      } else if (yielded[i] == 0) {
        force = std::clamp(free, -each.limit, each.limit);
      }
    }
    for (const ArmContact& contact : load.contacts) {
      changed = contact.point->changes(contact.along(state.v_radps + h * a)) || changed;
    }
    if (!changed) {
      break;
    }
  }
  // Positions with the new velocities: linearly implicit Euler.
  state.v_radps += h * a;
  state.q_rad += h * state.v_radps;
  return result;
}

ImplicitForce DrivenArm::stop_law(int joint, bool low, double h, double x) const {
  const double end = low ? length_least_[joint] : length_greatest_[joint];
  // k (end - x - h x') - d x' as offset - gain x'.
  return {stop_stiffness_ * (end - x), stop_damping_[joint] + h * stop_stiffness_};
}

}  // namespace rigwire::sim
