#include "sim/excavator/driven_arm.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

constexpr double kStopDampingRatio = 0.5;
constexpr int kSwitchesMax = 4;  // Of one resistance: to a limit, back, to a limit, back.
// Four relief valves and four stops (on and off) switch at most once each.
constexpr int kPassesMax = 12 + kSwitchesMax * static_cast<int>(kTipResistances);

// L D L^T of a symmetric positive definite matrix, unrolled: about a third of what a general
// factorisation of this size costs.
JointVector solve(const JointMatrix& m, const JointVector& right) {
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

enum class StopState { off, low, high, released };

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

void DrivenArm::coordinates(const JointVector& q_rad, JointVector& x, JointVector& lever) const {
  const ArmPose at = pose(q_rad);
  x = at.x;
  lever = at.lever;
}

DrivenArm::Inertia DrivenArm::inertia_at(const JointVector& q_rad) const {
  JointMatrix mass_matrix;
  JointVector bias;
  dynamics_.evaluate(q_rad, JointVector::Zero(), mass_matrix, bias);
  Inertia inertia;
  JointVector x;
  coordinates(q_rad, x, inertia.lever);
  inertia.inverse = mass_matrix.inverse();
  return inertia;
}

JointVector DrivenArm::free_mass(const JointVector& q_rad) const {
  const Inertia inertia = inertia_at(q_rad);
  return (inertia.inverse.diagonal().array() * inertia.lever.array().square()).inverse();
}

JointVector DrivenArm::damping_for(const JointVector& q_rad, const JointVector& stiffness,
                                   double ratio) const {
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

JointVector DrivenArm::forces(const ArmState& state, const JointVector& target,
                              const JointVector& rate) const {
  JointVector x;
  JointVector lever;
  coordinates(state.q_rad, x, lever);
  const JointVector free = gains.stiffness.cwiseProduct(target - x) +
                           gains.damping.cwiseProduct(rate - lever.cwiseProduct(state.v_radps));
  return free.cwiseMax(gains.force_least).cwiseMin(gains.force_greatest);
}

JointVector DrivenArm::stop_forces(const ArmState& state) const {
  JointVector result = JointVector::Zero();
  if (!gains.end_stops) {
    return result;
  }
  JointVector x;
  JointVector lever;
  coordinates(state.q_rad, x, lever);
  for (int i = 1; i < kArmJoints; ++i) {
    const double damping = stop_damping_[i] * lever[i] * state.v_radps[i];
    if (x[i] < length_least_[i]) {
      result[i] = std::max(0.0, stop_stiffness_ * (length_least_[i] - x[i]) - damping);
    } else if (x[i] > length_greatest_[i]) {
      result[i] = std::min(0.0, stop_stiffness_ * (length_greatest_[i] - x[i]) - damping);
    }
  }
  return result;
}

void DrivenArm::right_hand_side(const ArmState& state, const JointVector& target,
                                const JointVector& rate, JointMatrix& mass_matrix,
                                JointVector& force, JointVector& stiffness_q,
                                JointVector& damping_q) const {
  const ArmPose at = pose(state.q_rad);
  const JointVector& x = at.x;
  const JointVector& lever = at.lever;
  JointVector bias;
  dynamics_.evaluate(at.angles, state.v_radps, mass_matrix, bias);
  for (int i = 0; i < kArmJoints; ++i) {
    const double x_rate = lever[i] * state.v_radps[i];
    double k = gains.stiffness[i];
    double d = gains.damping[i];
    double f = k * (target[i] - x[i]) + d * (rate[i] - x_rate);
    if (f > gains.force_greatest[i] || f < gains.force_least[i]) {
      f = std::clamp(f, gains.force_least[i], gains.force_greatest[i]);
      k = 0.0;
      d = 0.0;
    }
    if (gains.end_stops && (x[i] < length_least_[i] || x[i] > length_greatest_[i])) {
      const double end = x[i] < length_least_[i] ? length_least_[i] : length_greatest_[i];
      const double stop = stop_stiffness_ * (end - x[i]) - stop_damping_[i] * x_rate;
      if (stop * (end - x[i]) > 0.0) {
        f += stop;
        k += stop_stiffness_;
        d += stop_damping_[i];
      }
    }
    force[i] = lever[i] * f - bias[i];
    stiffness_q[i] = k * lever[i] * lever[i];
    damping_q[i] = d * lever[i] * lever[i];
  }
  force += load.torque;
  for (std::size_t i = 0; i < load.resistance_count; ++i) {
    const ArmLoad::Resistance& each = load.resistances[i];
    const double free = each.offset - each.gain * each.jacobian.dot(state.v_radps);
    force += std::clamp(free, -each.limit, each.limit) * each.jacobian;
  }
}

JointVector DrivenArm::acceleration(const ArmState& state, const JointVector& target,
                                    const JointVector& rate) const {
  JointMatrix mass_matrix;
  JointVector force;
  JointVector stiffness_q;
  JointVector damping_q;
  right_hand_side(state, target, rate, mass_matrix, force, stiffness_q, damping_q);
  return solve(mass_matrix, force);
}

ArmStep DrivenArm::at_end(const ArmState& state, const JointVector& target,
                          const JointVector& rate) const {
  ArmStep result{.acceleration_radps2 = acceleration(state, target, rate),
                 .force = forces(state, target, rate)};
  for (int i = 0; i < kArmJoints; ++i) {
    result.relieved[static_cast<std::size_t>(i)] =
        result.force[i] >= gains.force_greatest[i] || result.force[i] <= gains.force_least[i];
  }
  return result;
}

ArmStep DrivenArm::step(IntegrationScheme scheme, double time_s, double h,
                        const TargetMotion& targets, ArmState& state) const {
  if (!(h > 0.0)) {
    JointVector target;
    JointVector rate;
    targets.at(time_s, target, rate);
    return at_end(state, target, rate);
  }
  switch (scheme) {
    case IntegrationScheme::rosenbrock2:
      return step_rosenbrock2(time_s, h, targets, state);
    case IntegrationScheme::runge_kutta4:
      return step_runge_kutta4(time_s, h, targets, state);
    case IntegrationScheme::linearly_implicit_euler:
      break;
  }
  JointVector target;
  JointVector rate;
  targets.at(time_s + h, target, rate);
  const ArmPose at = pose(state.q_rad);
  return advance(h, at, laws(at, h, target, rate), state);
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

  std::array<int, kArmJoints> clamped{};  // -1 at the least force, 1 at the greatest, 0 free.
  std::array<StopState, kArmJoints> stops{};
  std::array<int, kTipResistances> yielded{};
  std::array<int, kTipResistances> switches{};
  ArmStep result;
  JointVector& a = result.acceleration_radps2;
  for (int pass = 0; pass < kPassesMax; ++pass) {
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
    a = solve(left, right);

    bool changed = false;
    for (int i = 0; i < kArmJoints; ++i) {
      const auto n = static_cast<std::size_t>(i);
      if (clamped[n] == 0) {
        double& force = result.force[i];
        force = laws.force[n].at(x_rate[i]) - h * laws.force[n].gain * lever[i] * a[i];
        if (force > laws.greatest[i] || force < laws.least[i]) {
          clamped[n] = force > laws.greatest[i] ? 1 : -1;
          force = clamped[n] > 0 ? laws.greatest[i] : laws.least[i];
          result.relieved[n] = true;
          changed = true;
        }
      }
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
      // One that yielded before a relief valve opened may hold again after it: without the way
      // back it would push at its limit along the motion. The way from one limit to the other
      // leads through holding.
      if (beyond != yielded[i] && switches[i] < kSwitchesMax) {
        ++switches[i];
        yielded[i] = yielded[i] == 0 ? beyond : 0;
        changed = true;
      } else if (yielded[i] == 0) {
        force = std::clamp(free, -each.limit, each.limit);
      }
    }
    if (!changed) {
      break;
    }
  }
  state.v_radps += h * a;
  state.q_rad += h * state.v_radps;
  return result;
}

ImplicitForce DrivenArm::stop_law(int joint, bool low, double h, double x) const {
  const double end = low ? length_least_[joint] : length_greatest_[joint];
  return {stop_stiffness_ * (end - x), stop_damping_[joint] + h * stop_stiffness_};
}

ArmStep DrivenArm::step_rosenbrock2(double time_s, double h, const TargetMotion& targets,
                                    ArmState& state) const {
  const double gamma = 1.0 - std::sqrt(0.5);
  const double gh = gamma * h;
  JointVector target;
  JointVector rate;
  JointMatrix mass_matrix;
  JointVector force;
  JointVector stiffness_q;
  JointVector damping_q;
  targets.at(time_s, target, rate);
  right_hand_side(state, target, rate, mass_matrix, force, stiffness_q, damping_q);
  // How the force changes with time alone, the moving targets: k v_t + d dv_t/dt.
  const JointVector lever = pose(state.q_rad).lever;
  const JointVector start_rate = rate;
  targets.at(time_s + h, target, rate);
  JointVector force_rate;
  for (int i = 0; i < kArmJoints; ++i) {
    force_rate[i] =
        lever[i] == 0.0
            ? 0.0
            : (stiffness_q[i] * start_rate[i] + damping_q[i] * (rate[i] - start_rate[i]) / h) /
                  lever[i];
  }
  JointMatrix left = mass_matrix;
  left.diagonal() += gh * damping_q + gh * gh * stiffness_q;
  const Eigen::LLT<JointMatrix> factor(left);

  const JointVector k1_v =
      factor.solve(force + gh * force_rate - gh * stiffness_q.cwiseProduct(state.v_radps));
  const JointVector k1_q = state.v_radps + gh * k1_v;

  const ArmState second{state.q_rad + h * k1_q, state.v_radps + h * k1_v};
  JointMatrix mass_matrix2;
  JointVector force2;
  JointVector unused_k;
  JointVector unused_d;
  right_hand_side(second, target, rate, mass_matrix2, force2, unused_k, unused_d);
  const JointVector rest_q = second.v_radps - 2.0 * k1_q;
  const JointVector rest_v = solve(mass_matrix2, force2) - 2.0 * k1_v;
  const JointVector k2_v =
      factor.solve(mass_matrix * rest_v - gh * force_rate - gh * stiffness_q.cwiseProduct(rest_q));
  const JointVector k2_q = rest_q + gh * k2_v;

  state.q_rad += h * (1.5 * k1_q + 0.5 * k2_q);
  state.v_radps += h * (1.5 * k1_v + 0.5 * k2_v);
  return at_end(state, target, rate);
}

ArmStep DrivenArm::step_runge_kutta4(double time_s, double h, const TargetMotion& targets,
                                     ArmState& state) const {
  JointVector target;
  JointVector rate;
  targets.at(time_s, target, rate);
  const JointVector a1 = acceleration(state, target, rate);
  const JointVector v1 = state.v_radps;
  targets.at(time_s + 0.5 * h, target, rate);
  const JointVector v2 = v1 + 0.5 * h * a1;
  const JointVector a2 = acceleration({state.q_rad + 0.5 * h * v1, v2}, target, rate);
  const JointVector v3 = v1 + 0.5 * h * a2;
  const JointVector a3 = acceleration({state.q_rad + 0.5 * h * v2, v3}, target, rate);
  targets.at(time_s + h, target, rate);
  const JointVector v4 = v1 + h * a3;
  const JointVector a4 = acceleration({state.q_rad + h * v3, v4}, target, rate);
  state.q_rad += h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
  state.v_radps += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  return at_end(state, target, rate);
}

}  // namespace rigwire::sim
