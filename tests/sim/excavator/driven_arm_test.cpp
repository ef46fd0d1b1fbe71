#include "sim/excavator/driven_arm.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "bench/published_arm.h"

namespace rigwire::sim {
namespace {

using namespace bench;  // published_arm.h

JointVector after_4s(const DrivenArm& arm, int order, int steps_per_second) {
  const CosineTargets targets(arm);
  ArmState state{kPublishedPose, JointVector::Zero()};
  const double h = 1.0 / steps_per_second;
  for (int i = 0; i < 4 * steps_per_second; ++i) {
    step_arm(arm, order, static_cast<double>(i) / steps_per_second, h, targets, state);
  }
  return state.q_rad;
}

double tip_error_m(const DrivenArm& arm, const JointVector& q, const JointVector& reference) {
  return (arm.dynamics().tip_C(q) - arm.dynamics().tip_C(reference)).norm();
}

TEST(DrivenArm, TrajectoryOfFourDrivesIsSimbodysToNineDigits) {
  const JointVector q = after_4s(published_arm(), 4, 1000);
  for (int i = 0; i < kArmJoints; ++i) {
    EXPECT_NEAR(q[i], kSimbodyPose[i], 6e-10) << i;
  }
}

TEST(DrivenArm, ConvergesWithTheFirstOrderOfItsStep) {
  for (const double factor : {1.0, 100.0}) {
    const DrivenArm arm = published_arm(factor);
    const JointVector reference = after_4s(arm, 4, 1000);
    const double coarse = tip_error_m(arm, after_4s(arm, 1, 100), reference);
    const double fine = tip_error_m(arm, after_4s(arm, 1, 200), reference);
    EXPECT_NEAR(coarse / fine, 2.0, 0.2) << factor;
  }
}

// Research case 3: a drive 10^4 times as stiff as oil on a bucket of 310 kg m2.
TEST(DrivenArm, StiffDriveOnALightLinkStaysWithin200MicrometresAt20Milliseconds) {
  const DrivenArm arm = published_arm(1e4);
  const JointVector reference = after_4s(arm, 2, 10000);
  EXPECT_LT(tip_error_m(arm, after_4s(arm, 1, 50), reference), 2e-4);
  EXPECT_LT(tip_error_m(arm, after_4s(arm, 1, 1000), reference), 2e-6);
}

// Research case 36 and the energy row of section 3.2.
TEST(DrivenArm, FreeArmKeepsItsEnergyAndFindsTheChaoticReference) {
  const DrivenArm arm = published_free_arm();
  ArmState state{kPublishedPose, JointVector::Zero()};
  const ArmDynamics& dynamics = arm.dynamics();
  const auto energy = [&] {
    return dynamics.kinetic_energy_j(state.q_rad, state.v_radps) +
           dynamics.potential_energy_j(state.q_rad);
  };
  const double at_start = energy();
  for (int i = 0; i < 4000; ++i) {
    step_arm(arm, 6, 1e-3 * i, 1e-3, no_targets, state);
  }
  EXPECT_LT(std::abs(energy() - at_start), 2e-5);
  EXPECT_NEAR(state.q_rad[1], -2.233331, 2e-6);
  EXPECT_NEAR(state.q_rad[2], -1.267838, 2e-6);
  EXPECT_NEAR(state.q_rad[3], -1.629596, 2e-6);
}

TEST(DrivenArm, DampedArmNeverGainsEnergyWhateverTheStep) {
  const DrivenArm arm = published_arm(100.0);
  const JointVector start = arm.pose(kPublishedPose).x;
  const auto targets = [&](double /*time_s*/) { return DriveTargets{start, JointVector::Zero()}; };
  for (const double h : {1e-4, 1e-3, 5e-3, 2e-2}) {
    ArmState state{kPublishedPose, JointVector(0.5, 0.3, -0.4, 0.8)};
    const auto energy = [&] {
      return arm.dynamics().kinetic_energy_j(state.q_rad, state.v_radps) +
             arm.dynamics().potential_energy_j(state.q_rad) +
             0.5 * arm.gains.stiffness.dot((start - arm.pose(state.q_rad).x).cwiseAbs2());
    };
    const double at_start = energy();
    for (int i = 0; i < static_cast<int>(2.0 / h); ++i) {
      step_arm(arm, 1, 0.0, h, targets, state);
      ASSERT_LE(energy(), at_start + 1.0) << "h " << h << " step " << i;
    }
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
