// The arm's equations in continuous time, and ROS2 and Runge-Kutta 4 for them (driven_arm.h).
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "sim/excavator/driven_arm.h"
#include "sim/excavator/joint_solve.h"

namespace rigwire::sim {

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
    // Eq. 5 at this state; at its limit a drive has neither stiffness nor damping.
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
    // The bucket's resistance at this state's speed, within its limit.
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
  return solve_joints(mass_matrix, force);
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
  // ROS2 (Verwer et al. 1999): M - gh df/dv - gh^2 df/dq on the left of both stages.
  left.diagonal() += gh * damping_q + gh * gh * stiffness_q;
  const Eigen::LLT<JointMatrix> factor(left);

  // Stage 1: (I - gh A) k1 = f(t, y) + gh f_t.
  const JointVector k1_v =
      factor.solve(force + gh * force_rate - gh * stiffness_q.cwiseProduct(state.v_radps));
  const JointVector k1_q = state.v_radps + gh * k1_v;

  const ArmState second{state.q_rad + h * k1_q, state.v_radps + h * k1_v};
  JointMatrix mass_matrix2;
  JointVector force2;
  JointVector unused_k;
  JointVector unused_d;
  right_hand_side(second, target, rate, mass_matrix2, force2, unused_k, unused_d);
  // Stage 2: (I - gh A) k2 = f(t + h, y + h k1) - 2 k1 - gh f_t.
  const JointVector rest_q = second.v_radps - 2.0 * k1_q;
  const JointVector rest_v = solve_joints(mass_matrix2, force2) - 2.0 * k1_v;
  const JointVector k2_v =
      factor.solve(mass_matrix * rest_v - gh * force_rate - gh * stiffness_q.cwiseProduct(rest_q));
  const JointVector k2_q = rest_q + gh * k2_v;

  // y + h (3 k1 + k2) / 2
  state.q_rad += h * (1.5 * k1_q + 0.5 * k2_q);
  state.v_radps += h * (1.5 * k1_v + 0.5 * k2_v);
  return at_end(state, target, rate);
}

ArmStep DrivenArm::step_runge_kutta4(double time_s, double h, const TargetMotion& targets,
                                     ArmState& state) const {
  JointVector target;
  JointVector rate;
  targets.at(time_s, target, rate);
  // Classical Runge-Kutta on q' = v, v' = a(q, v, t).
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
