#include <gtest/gtest.h>

#include "bench/published_arm.h"
#include "mujoco_arm.h"

namespace rigwire::sim {
namespace {

using namespace bench;  // published_arm.h

TEST(MujocoOracle, MassMatrixAndGravityLoadAgree) {
  MujocoArm mujoco(published_set(), {}, MujocoArmKind::open_chain, 1e-3, "Euler");
  const ArmDynamics arm(published_set(), kPublishedGravity);
  JointMatrix m;
  JointVector bias;
  arm.evaluate(kPublishedPose, JointVector::Zero(), m, bias);
  EXPECT_LT((mujoco.mass_matrix() - m).norm(), 1e-12 * m.norm());
  EXPECT_LT((mujoco.bias() - bias).norm(), 1e-11 * bias.norm());
}

TEST(MujocoOracle, FreeFallByRungeKutta4IsTheSame) {
  MujocoArm mujoco(published_set(), {}, MujocoArmKind::open_chain, 1e-3, "RK4");
  const DrivenArm arm = published_free_arm();
  ArmState state{kPublishedPose, JointVector::Zero()};
  for (int i = 0; i < 1000; ++i) {
    mujoco.step();
    step_arm(arm, 6, 0.0, 1e-3, no_targets, state);
  }
  EXPECT_LT((mujoco.joint_angles_rad() - state.q_rad).cwiseAbs().maxCoeff(), 1e-9);
}

// Without forces on the left-hand side the linearly implicit step is the semi-implicit one.
TEST(MujocoOracle, FreeFallByEulerIsTheSameStepForStep) {
  MujocoArm mujoco(published_set(), {}, MujocoArmKind::open_chain, 1e-3, "Euler");
  const DrivenArm arm = published_free_arm();
  ArmState state{kPublishedPose, JointVector::Zero()};
  for (int i = 0; i < 2000; ++i) {
    mujoco.step();
    step_arm(arm, 1, 0.0, 1e-3, no_targets, state);
  }
  EXPECT_LT((mujoco.joint_angles_rad() - state.q_rad).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(MujocoOracle, LoopedArmFollowsTheClosedFormsWithinItsLoopGap) {
  const DrivenArm arm = published_arm();
  const CosineTargets targets(arm);
  MujocoArm mujoco(published_set(), arm.gains, MujocoArmKind::looped, 5e-4, "Euler");
  EXPECT_EQ(mujoco.degrees_of_freedom(), 12);
  EXPECT_EQ(mujoco.constraint_rows(), 12);
  EXPECT_LT(mujoco.loop_gap_m(), 1e-12) << "the loops close at the start";
  ArmState state{kPublishedPose, JointVector::Zero()};
  double gap = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const DriveTargets at = targets(5e-4 * i);
    mujoco.command(at.position, at.rate);
    mujoco.step();
    gap = std::max(gap, mujoco.loop_gap_m());
    step_arm(arm, 2, 5e-4 * i, 5e-4, targets, state);
  }
  EXPECT_EQ(mujoco.warnings(), 0);
  EXPECT_LT(gap, 5e-3);
  // Soft pins and 160 kg of cylinders that ours does not have.
  EXPECT_LT(
      (arm.dynamics().tip_C(mujoco.joint_angles_rad()) - arm.dynamics().tip_C(state.q_rad)).norm(),
      0.05);
}

}  // namespace
}  // namespace rigwire::sim
