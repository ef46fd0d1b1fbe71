#include "sim/excavator/arm_dynamics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/published_arm.h"
#include "sim/general_arm_dynamics.h"

namespace rigwire::sim {
namespace {

using namespace bench;  // published_arm.h

const JointVector kPose(0.0, 0.35, -1.4, 0.6);

// Centres of mass beside the plane, a foot beside the swing axis, a tilted machine: nothing that
// the closed form could leave out.
ExcavatorParameters lopsided_set() {
  ExcavatorParameters parameters;
  parameters.upper.center_of_mass_m.y() = 0.3;
  parameters.boom.center_of_mass_m.y() = -0.2;
  parameters.stick.center_of_mass_m.y() = 0.15;
  parameters.bucket.center_of_mass_m.y() = 0.1;
  parameters.payload_center_of_mass_m.y() = -0.25;
  parameters.boom_foot_m.y() = 0.4;
  return parameters;
}

TEST(ArmDynamics, ClosedFormIsTheGeneralEvaluationToRounding) {
  for (const bool lopsided : {false, true}) {
    const ExcavatorParameters parameters = lopsided ? lopsided_set() : ExcavatorParameters{};
    for (const double payload_kg : {0.0, 900.0}) {
      const Eigen::Vector3d gravity(lopsided ? 1.5 : 0.0, lopsided ? -2.0 : 0.0, -9.4);
      ArmDynamics fast(parameters, gravity);
      GeneralArmDynamics general(parameters, gravity);
      fast.set_payload_kg(payload_kg);
      general.add_payload_kg(payload_kg);
      for (int i = 0; i < 200; ++i) {
        const JointVector q(0.5 * i, std::sin(1.0 * i), 2.0 * std::sin(2.0 * i),
                            3.0 * std::sin(3.0 * i));
        const JointVector v(std::cos(5.0 * i), std::cos(7.0 * i), -std::cos(11.0 * i),
                            2.0 * std::sin(13.0 * i));
        JointMatrix fast_matrix, matrix;
        JointVector fast_bias, bias;
        fast.evaluate(q, v, fast_matrix, fast_bias);
        general.evaluate(q, v, matrix, bias);
        ASSERT_LT((fast_matrix - matrix).norm(), 1e-13 * matrix.norm()) << i;
        ASSERT_LT((fast_bias - bias).norm(), 1e-12 * std::max(1e5, bias.norm())) << i;
      }
    }
  }
}

// Reference values from Simbody and DART.
TEST(ArmDynamics, MassMatrixDiagonalIsSimbodysAndDarts) {
  const ArmDynamics arm(published_set(), kPublishedGravity);
  JointMatrix mass_matrix;
  JointVector bias;
  arm.evaluate(kPose, JointVector::Zero(), mass_matrix, bias);
  EXPECT_NEAR(mass_matrix(0, 0), 73806.2, 0.05);
  EXPECT_NEAR(mass_matrix(1, 1), 48890.0, 0.5);
  EXPECT_NEAR(mass_matrix(2, 2), 5583.87, 0.005);
  EXPECT_NEAR(mass_matrix(3, 3), 310.0, 1e-9);
  EXPECT_TRUE(mass_matrix.isApprox(mass_matrix.transpose(), 0.0));
}

TEST(ArmDynamics, GravityLoadIsDarts) {
  const ArmDynamics arm(published_set(), kPublishedGravity);
  const JointVector load = arm.gravity_load(kPose);
  EXPECT_NEAR(load[0], 0.0, 1e-9);
  EXPECT_NEAR(load[1], 87856.0, 0.5);
  EXPECT_NEAR(load[2], 11263.9, 0.05);
  EXPECT_NEAR(load[3], 2223.31, 0.005);
}

TEST(ArmDynamics, GravityLoadIsTheSlopeOfThePotential) {
  // A tilted machine, so that swing carries load too.
  const ArmDynamics arm(ExcavatorParameters{}, {1.5, -2.0, -9.4});
  const JointVector q(0.7, 0.2, -1.1, -0.4);
  const JointVector load = arm.gravity_load(q);
  for (int i = 0; i < kArmJoints; ++i) {
    const double h = 1e-5;
    const JointVector step = h * JointVector::Unit(i);
    const double slope =
        (arm.potential_energy_j(q + step) - arm.potential_energy_j(q - step)) / (2.0 * h);
    EXPECT_NEAR(load[i], slope, 1e-3) << i;
  }
}

TEST(ArmDynamics, UndrivenFallBySemiImplicitEulerIsDartsToTheLastDigit) {
  const ArmDynamics arm(published_set(), kPublishedGravity);
  JointVector q = kPose;
  JointVector v = JointVector::Zero();
  JointMatrix mass_matrix;
  JointVector bias;
  for (int i = 0; i < 4000; ++i) {
    arm.evaluate(q, v, mass_matrix, bias);
    v -= 1e-3 * mass_matrix.llt().solve(bias);
    q += 1e-3 * v;
  }
  EXPECT_NEAR(q[0], 0.0, 1e-12);
  EXPECT_NEAR(q[1], -2.252445, 5e-7);
  EXPECT_NEAR(q[2], -1.277158, 5e-7);
  EXPECT_NEAR(q[3], -1.658757, 5e-7);
}

TEST(ArmDynamics, AccelerationsOfTheLinksAreTheDerivativesOfTheirVelocities) {
  const ArmDynamics arm(ExcavatorParameters{}, {0.0, 0.0, -9.80665});
  const JointVector q(0.4, 0.3, -1.2, -0.5);
  const JointVector v(0.9, -0.4, 0.7, 1.1);
  const JointVector a(0.3, 0.8, -0.6, 2.0);
  const double h = 1e-5;
  const auto at = [&](double t) { return arm.motion(q + t * v + 0.5 * t * t * a, v + t * a, a); };
  const auto before = at(-h);
  const auto now = at(0.0);
  const auto after = at(h);
  for (std::size_t i = 0; i < kArmJoints; ++i) {
    EXPECT_TRUE(now[i].v_CB_C.isApprox((after[i].p_CB_C - before[i].p_CB_C) / (2.0 * h), 1e-8) ||
                i == 0);
    EXPECT_LT(((after[i].v_CB_C - before[i].v_CB_C) / (2.0 * h) - now[i].a_CB_C).norm(), 1e-6) << i;
    EXPECT_LT(((after[i].w_CB_C - before[i].w_CB_C) / (2.0 * h) - now[i].alpha_CB_C).norm(), 1e-6)
        << i;
    const Eigen::Matrix3d spin =
        (after[i].R_CB - before[i].R_CB) / (2.0 * h) * now[i].R_CB.transpose();
    EXPECT_LT((Eigen::Vector3d(spin(2, 1), spin(0, 2), spin(1, 0)) - now[i].w_CB_C).norm(), 1e-6);
  }
}

// Research case 4.
TEST(ArmDynamics, PayloadAddsItsPointMassToTheBucket) {
  const ExcavatorParameters parameters = published_set();
  ArmDynamics arm(parameters, kPublishedGravity);
  JointMatrix empty;
  JointMatrix loaded;
  JointVector bias;
  arm.evaluate(kPose, JointVector::Zero(), empty, bias);
  const double empty_load = bias[3];
  arm.set_payload_kg(1200.0);
  arm.evaluate(kPose, JointVector::Zero(), loaded, bias);
  EXPECT_NEAR(loaded(3, 3) - empty(3, 3), 1200.0 * (0.65 * 0.65 + 0.25 * 0.25), 1e-9);
  const double angle = 0.35 - 1.4 + 0.6;
  EXPECT_NEAR(bias[3] - empty_load,
              1200.0 * 9.81 * (0.65 * std::cos(angle) + 0.25 * std::sin(angle)), 1e-8);
  arm.set_payload_kg(0.0);
  arm.evaluate(kPose, JointVector::Zero(), loaded, bias);
  EXPECT_EQ(loaded, empty);
  arm.set_payload_kg(1e9);
  EXPECT_EQ(arm.payload_kg(), 1200.0);
}

}  // namespace
}  // namespace rigwire::sim
