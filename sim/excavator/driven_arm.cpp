#include "sim/excavator/driven_arm.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

constexpr double kStopDampingRatio = 0.5;
// Four relief valves, four stops (on and off) and the load's resistances switch at most once each.
constexpr int kPassesMax = 12 + static_cast<int>(kTipResistances);

JointVector solve(const JointMatrix& matrix, const JointVector& right) {
  return matrix.llt().solve(right);
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

void DrivenArm::coordinates(const JointVector& q_rad, JointVector& x, JointVector& lever) const {
  x[0] = q_rad[0];
  lever[0] = 1.0;
  for (int joint = 0; joint < 3; ++joint) {
    const CylinderGeometry geometry = linkages_.at(joint, q_rad[joint + 1]);
    x[joint + 1] = geometry.length_m;
    lever[joint + 1] = geometry.lever_m;
  }
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
  JointVector bias;
  dynamics_.evaluate(state.q_rad, state.v_radps, mass_matrix, bias);
  JointVector x;
  JointVector lever;
  coordinates(state.q_rad, x, lever);
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
  return step_linearly_implicit(time_s, h, targets, state);
}

ArmStep DrivenArm::step_linearly_implicit(double time_s, double h, const TargetMotion& targets,
                                          ArmState& state) const {
  JointVector target;
  JointVector rate;
  targets.at(time_s + h, target, rate);
  JointMatrix mass_matrix;
  JointVector bias;
  dynamics_.evaluate(state.q_rad, state.v_radps, mass_matrix, bias);
  JointVector x;
  JointVector lever;
  coordinates(state.q_rad, x, lever);
  const JointVector x_rate = lever.cwiseProduct(state.v_radps);
  const JointVector drift = x + h * x_rate;  // Where x goes without acceleration.
  const JointVector free =
      gains.stiffness.cwiseProduct(target - drift) + gains.damping.cwiseProduct(rate - x_rate);
  const JointVector gain = h * gains.damping + h * h * gains.stiffness;

  std::array<int, kArmJoints> clamped{};  // -1 at the least force, 1 at the greatest, 0 free.
  std::array<StopState, kArmJoints> stops{};
  std::array<int, kTipResistances> yielded{};
  ArmStep result;
  JointVector a;
  for (int pass = 0; pass < kPassesMax; ++pass) {
    JointMatrix left = mass_matrix;
    JointVector right = load.torque - bias;
    for (int i = 0; i < kArmJoints; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (clamped[at] == 0) {
        left(i, i) += gain[i] * lever[i] * lever[i];
        right[i] += lever[i] * free[i];
      } else {
        right[i] += lever[i] * (clamped[at] > 0 ? gains.force_greatest[i] : gains.force_least[i]);
      }
      if (stops[at] == StopState::low || stops[at] == StopState::high) {
        const double end = stops[at] == StopState::low ? length_least_[i] : length_greatest_[i];
        const double stop_gain = h * stop_damping_[i] + h * h * stop_stiffness_;
        left(i, i) += stop_gain * lever[i] * lever[i];
        right[i] += lever[i] * (stop_stiffness_ * (end - drift[i]) - stop_damping_[i] * x_rate[i]);
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
    for (std::size_t i = 0; i < load.resistance_count; ++i) {
      const ArmLoad::Resistance& each = load.resistances[i];
      if (yielded[i] == 0) {
        double& force = result.resistance_n[i];
        force = each.offset - each.gain * each.jacobian.dot(state.v_radps + h * a);
        yielded[i] = force > each.limit ? 1 : force < -each.limit ? -1 : 0;
        if (yielded[i] != 0) {
          force = yielded[i] * each.limit;
          changed = true;
        }
      }
    }
    for (int i = 0; i < kArmJoints; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (clamped[at] == 0) {
        const double force = free[i] - gain[i] * lever[i] * a[i];
        clamped[at] = force > gains.force_greatest[i] ? 1 : force < gains.force_least[i] ? -1 : 0;
        changed = changed || clamped[at] != 0;
      }
      if (!gains.end_stops || i == 0) {
        continue;
      }
      const double end_x = drift[i] + h * h * lever[i] * a[i];
      if (stops[at] == StopState::off &&
          (end_x < length_least_[i] || end_x > length_greatest_[i])) {
        stops[at] = end_x < length_least_[i] ? StopState::low : StopState::high;
        changed = true;
      } else if (stops[at] == StopState::low || stops[at] == StopState::high) {
        const bool low = stops[at] == StopState::low;
        const double force =
            stop_stiffness_ * ((low ? length_least_[i] : length_greatest_[i]) - end_x) -
            stop_damping_[i] * (x_rate[i] + h * lever[i] * a[i]);
        if (low ? force < 0.0 : force > 0.0) {  // A stop pushes, it never pulls.
          stops[at] = StopState::released;
          changed = true;
        }
      }
    }
    if (!changed) {
      break;
    }
  }
  state.v_radps += h * a;
  state.q_rad += h * state.v_radps;
  result.acceleration_radps2 = a;
  for (int i = 0; i < kArmJoints; ++i) {
    const auto at = static_cast<std::size_t>(i);
    result.relieved[at] = clamped[at] != 0;
    result.force[i] = clamped[at] > 0   ? gains.force_greatest[i]
                      : clamped[at] < 0 ? gains.force_least[i]
                                        : free[i] - gain[i] * lever[i] * a[i];
  }
  return result;
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
  JointVector x;
  JointVector lever;
  coordinates(state.q_rad, x, lever);
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
