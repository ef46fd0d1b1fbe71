#include "sim/excavator/driven_arm.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "sim/excavator_published_set.h"

namespace rigwire::sim {
namespace {

const JointVector kPose(0.0, 0.35, -1.4, 0.6);
constexpr IntegrationScheme kSchemes[] = {IntegrationScheme::linearly_implicit_euler,
                                          IntegrationScheme::rosenbrock2,
                                          IntegrationScheme::runge_kutta4};

class CosineTargets final : public TargetMotion {
 public:
  explicit CosineTargets(const DrivenArm& arm) {
    JointVector lever;
    arm.coordinates(kPose, start_, lever);
  }
  void at(double time_s, JointVector& target, JointVector& rate) const override {
    const JointVector w = 2.0 * std::numbers::pi * JointVector(0.15, 0.2, 0.25, 0.3);
    const JointVector half = 0.5 * JointVector(0.8, -0.35, 0.5, 0.2);
    for (int i = 0; i < kArmJoints; ++i) {
      target[i] = start_[i] + half[i] * (1.0 - std::cos(w[i] * time_s));
      rate[i] = half[i] * w[i] * std::sin(w[i] * time_s);
    }
  }

 private:
  JointVector start_;
};

DrivenArm arm_with_stiffness(double factor) {
  DrivenArm arm(published_set(), kPublishedGravity);
  arm.gains.stiffness *= factor;
  arm.gains.damping *= std::sqrt(factor);
  return arm;
}

JointVector after_4s(const DrivenArm& arm, IntegrationScheme scheme, int steps_per_second) {
  const CosineTargets targets(arm);
  ArmState state{kPose, JointVector::Zero()};
  for (int i = 0; i < 4 * steps_per_second; ++i) {
    arm.step(scheme, static_cast<double>(i) / steps_per_second, 1.0 / steps_per_second, targets,
             state);
  }
  return state.q_rad;
}

double tip_error_m(const DrivenArm& arm, const JointVector& q, const JointVector& reference) {
  return (arm.dynamics().tip_C(q) - arm.dynamics().tip_C(reference)).norm();
}

// Simbody (Merson and CPODES at 1e-10) gives the same nine digits.
const JointVector kSimbody(0.736274963, 0.176523521, -1.399930624, 0.357101577);

TEST(DrivenArm, TrajectoryOfFourDrivesIsSimbodysToNineDigits) {
  const JointVector q = after_4s(arm_with_stiffness(1.0), IntegrationScheme::runge_kutta4, 5000);
  for (int i = 0; i < kArmJoints; ++i) {
    EXPECT_NEAR(q[i], kSimbody[i], 6e-10) << i;
  }
}

TEST(DrivenArm, EverySchemeConvergesWithItsOrder) {
  const DrivenArm arm = arm_with_stiffness(1.0);
  const JointVector reference = after_4s(arm, IntegrationScheme::runge_kutta4, 5000);
  const double orders[] = {1.0, 2.0, 4.0};
  for (std::size_t i = 0; i < 3; ++i) {
    const double coarse = tip_error_m(arm, after_4s(arm, kSchemes[i], 100), reference);
    const double fine = tip_error_m(arm, after_4s(arm, kSchemes[i], 200), reference);
    EXPECT_NEAR(std::log2(coarse / fine), orders[i], 0.4) << i;
  }
}

// Research case 3: a drive 10^4 times as stiff as oil on a bucket of 310 kg m2.
TEST(DrivenArm, StiffDriveOnALightLinkStaysWithin200MicrometresAt20Milliseconds) {
  const DrivenArm arm = arm_with_stiffness(1e4);
  const JointVector reference = after_4s(arm, IntegrationScheme::rosenbrock2, 10000);
  EXPECT_LT(
      tip_error_m(arm, after_4s(arm, IntegrationScheme::linearly_implicit_euler, 50), reference),
      2e-4);
  EXPECT_LT(
      tip_error_m(arm, after_4s(arm, IntegrationScheme::linearly_implicit_euler, 1000), reference),
      2e-6);
}

TEST(DrivenArm, RungeKutta4IsFiniteButWrongJustBelowItsLimit) {
  // Why validate() stops it at half the stability limit.
  const DrivenArm arm = arm_with_stiffness(100.0);
  const JointVector reference = after_4s(arm, IntegrationScheme::rosenbrock2, 10000);
  EXPECT_GT(tip_error_m(arm, after_4s(arm, IntegrationScheme::runge_kutta4, 500), reference), 1e-3);
  EXPECT_LT(tip_error_m(arm, after_4s(arm, IntegrationScheme::runge_kutta4, 2000), reference),
            1e-6);
}

// Research case 36 and the energy row of section 3.2.
TEST(DrivenArm, FreeArmKeepsItsEnergyAndFindsTheChaoticReference) {
  DrivenArm arm(published_set(), kPublishedGravity);
  arm.gains.stiffness.setZero();
  arm.gains.damping.setZero();
  ArmState state{kPose, JointVector::Zero()};
  const LinearTargets targets;
  const ArmDynamics& dynamics = arm.dynamics();
  const auto energy = [&] {
    return dynamics.kinetic_energy_j(state.q_rad, state.v_radps) +
           dynamics.potential_energy_j(state.q_rad);
  };
  const double at_start = energy();
  for (int i = 0; i < 4000; ++i) {
    arm.step(IntegrationScheme::runge_kutta4, 1e-3 * i, 1e-3, targets, state);
  }
  EXPECT_LT(std::abs(energy() - at_start), 2e-5);
  EXPECT_NEAR(state.q_rad[1], -2.233331, 2e-6);
  EXPECT_NEAR(state.q_rad[2], -1.267838, 2e-6);
  EXPECT_NEAR(state.q_rad[3], -1.629596, 2e-6);
}

TEST(DrivenArm, DampedArmNeverGainsEnergyWhateverTheStep) {
  for (const double h : {1e-4, 1e-3, 5e-3, 2e-2}) {
    DrivenArm arm = arm_with_stiffness(100.0);
    ArmState state{kPose, JointVector(0.5, 0.3, -0.4, 0.8)};
    LinearTargets targets;
    JointVector lever;
    arm.coordinates(kPose, targets.start, lever);
    const auto energy = [&] {
      JointVector x;
      arm.coordinates(state.q_rad, x, lever);
      return arm.dynamics().kinetic_energy_j(state.q_rad, state.v_radps) +
             arm.dynamics().potential_energy_j(state.q_rad) +
             0.5 * arm.gains.stiffness.dot((targets.start - x).cwiseAbs2());
    };
    const double at_start = energy();
    for (int i = 0; i < static_cast<int>(2.0 / h); ++i) {
      arm.step(IntegrationScheme::linearly_implicit_euler, 0.0, h, targets, state);
      ASSERT_LE(energy(), at_start + 1.0) << "h " << h << " step " << i;
    }
  }
}

TEST(DrivenArm, ZeroStepLeavesEveryBitOfTheState) {
  const DrivenArm arm = arm_with_stiffness(1.0);
  const CosineTargets targets(arm);
  for (const IntegrationScheme scheme : kSchemes) {
    ArmState state{kPose, JointVector(0.1, 0.2, 0.3, 0.4)};
    const ArmStep step = arm.step(scheme, 1.0, 0.0, targets, state);
    EXPECT_EQ(state.q_rad, kPose);
    EXPECT_EQ(state.v_radps, JointVector(0.1, 0.2, 0.3, 0.4));
    EXPECT_TRUE(step.acceleration_radps2.allFinite() && step.force.allFinite());
  }
}

// Research case 21: exact periods of a pendulum with L = 1 m, g = 9.80665 m/s2.
TEST(DrivenArm, PendulumPeriodIsTheEllipticIntegralAtLargeAmplitude) {
  ExcavatorParameters parameters = published_set();
  // A bucket that is a point mass of 500 kg at 1 m to 1e-9, everything else too heavy to move.
  parameters.bucket.center_of_mass_m = {1.0, 0.0, 0.0};
  parameters.bucket.principal_inertia_kgm2 = Eigen::Vector3d::Constant(1e-7);
  const ArmDynamics dynamics(parameters, {0.0, 0.0, -9.80665});
  const double hanging = -0.5 * std::numbers::pi - (0.35 - 1.4);
  for (const auto& [amplitude_deg, period_s] :
       {std::pair{90.0, 2.368246346}, {150.0, 3.535701938}, {170.0, 4.894360029}}) {
    // The bucket alone: q4'' = -bias4 / M44 with the other joints at rest.
    double q = hanging + amplitude_deg * std::numbers::pi / 180.0;
    double v = 0.0;
    const double h = 1e-4;
    const auto a = [&](double angle, double rate) {
      JointMatrix mass_matrix;
      JointVector bias;
      dynamics.evaluate({0.0, 0.35, -1.4, angle}, {0.0, 0.0, 0.0, rate}, mass_matrix, bias);
      return -bias[3] / mass_matrix(3, 3);
    };
    double time = 0.0;
    double previous_v = 0.0;
    for (;;) {
      const double a1 = a(q, v), v2 = v + 0.5 * h * a1, a2 = a(q + 0.5 * h * v, v2);
      const double v3 = v + 0.5 * h * a2, a3 = a(q + 0.5 * h * v2, v3);
      const double v4 = v + h * a3, a4 = a(q + h * v3, v4);
      previous_v = v;
      q += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
      v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
      time += h;
      if (previous_v < 0.0 && v >= 0.0) {
        break;  // The far turning point, half a period.
      }
      ASSERT_LT(time, 10.0);
    }
    const double half = time - h * v / (v - previous_v);
    EXPECT_NEAR(2.0 * half, period_s, 2e-8) << amplitude_deg;
  }
}

// Relief valves that open one after the other: whatever the order, each drive ends with the force
// of its law at the rate found, or with its limit. One that stayed at its limit after another had
// opened would push along the motion (10 kW here, in one of 350 steps).
TEST(DrivenArm, EachReliefValveAgreesWithTheRatesThatTheStepFound) {
  const ExcavatorParameters parameters;
  DrivenArm arm(parameters, Eigen::Vector3d(0.0, 0.0, -9.81));
  arm.gains.force_greatest << 55e3, 7.3e5, 4.3e5, 3.0e5;
  arm.gains.force_least << -55e3, -3.7e5, -2.0e5, -1.5e5;
  std::mt19937 generator(7);
  const auto draw = [&generator](double least, double greatest) {
    const double share = static_cast<double>(generator()) / 4294967296.0;
    return least + (greatest - least) * share;
  };
  const double h = 1e-3;
  int relieved = 0;
  for (int n = 0; n < 20000; ++n) {
    ArmState state;
    state.q_rad << draw(-3.0, 3.0), draw(-0.3, 0.8), draw(-2.4, -0.8), draw(-0.3, 1.8);
    state.v_radps << draw(-0.5, 0.5), draw(-0.5, 0.5), draw(-1.0, 1.0), draw(-1.0, 1.0);
    const ArmPose at = arm.pose(state.q_rad);
    JointVector target = at.x;
    JointVector rate;
    for (int i = 0; i < kArmJoints; ++i) {
      target[i] += draw(-1.2, 1.2) * arm.gains.force_greatest[i] / arm.gains.stiffness[i];
      rate[i] = at.lever[i] * state.v_radps[i] + draw(-0.2, 0.2);
    }
    const DriveLaws laws = arm.laws(at, h, target, rate);
    const ArmStep step = arm.advance(h, at, laws, state);
    for (int i = 0; i < kArmJoints; ++i) {
      const auto drive = static_cast<std::size_t>(i);
      const double free = laws.force[drive].at(at.lever[i] * state.v_radps[i]);
      const double wanted = std::clamp(free, laws.least[i], laws.greatest[i]);
      ASSERT_NEAR(step.force[i], wanted, 1e-6 * laws.greatest[i]) << n << " drive " << i;
      relieved += step.relieved[drive] ? 1 : 0;
    }
  }
  EXPECT_GT(relieved, 10000);
}

}  // namespace
}  // namespace rigwire::sim
