#include <gtest/gtest.h>

#include "sim/cosine_targets.h"
#include "sim/excavator_published_set.h"
#include "simbody_arm.h"

namespace rigwire::sim {
namespace {

oracle::SimbodyModel model_of(const ExcavatorParameters& p) {
  oracle::SimbodyModel model;
  const RigidBodyParameters* links[] = {&p.upper, &p.boom, &p.stick, &p.bucket};
  for (std::size_t i = 0; i < 4; ++i) {
    model.links[i] = {links[i]->mass_kg, links[i]->center_of_mass_m,
                      links[i]->principal_inertia_kgm2};
  }
  model.gravity_mps2 = p.gravity_mps2;
  model.swing_axis_height_m = p.swing_axis_height_m;
  model.boom_foot_m = p.boom_foot_m;
  model.boom_length_m = p.boom_length_m;
  model.stick_length_m = p.stick_length_m;
  model.boom_base_m = p.boom_linkage.base_pin_m;
  model.boom_rod_m = p.boom_linkage.rod_pin_m;
  model.stick_base_m = p.stick_linkage.base_pin_m;
  model.stick_rod_m = p.stick_linkage.rod_pin_m;
  model.bucket_linkage = [linkage = BucketLinkage(p.bucket_linkage, p.stick_length_m)](double q) {
    return std::pair{linkage.at(q).length_m, linkage.at(q).lever_m};
  };
  return model;
}

JointVector own_run(const DrivenArm& arm, const TargetMotion& targets, int steps_per_second) {
  ArmState state{kPublishedPose, JointVector::Zero()};
  for (int i = 0; i < 4 * steps_per_second; ++i) {
    arm.step(IntegrationScheme::runge_kutta4, static_cast<double>(i) / steps_per_second,
             1.0 / steps_per_second, targets, state);
  }
  return state.q_rad;
}

TEST(SimbodyOracle, MassMatrixAndGravityLoadAgreeInManyPoses) {
  const ExcavatorParameters parameters = published_set();
  const oracle::SimbodyArm simbody(model_of(parameters));
  const ArmDynamics arm(parameters, kPublishedGravity);
  for (int i = 0; i < 20; ++i) {
    const JointVector q(0.3 * i, std::sin(1.0 * i), 1.5 * std::sin(2.0 * i), std::sin(3.0 * i));
    JointMatrix m;
    JointVector bias;
    arm.evaluate(q, JointVector::Zero(), m, bias);
    EXPECT_LT((simbody.mass_matrix(q) - m).norm(), 1e-12 * m.norm()) << i;
    EXPECT_LT((simbody.gravity_load(q) - bias).norm(), 1e-11 * 1e5) << i;
  }
}

TEST(SimbodyOracle, DrivenTrajectoryIsTheSameToNineDigits) {
  const ExcavatorParameters parameters = published_set();
  const DrivenArm arm(parameters, kPublishedGravity);
  const CosineTargets targets(arm);
  oracle::SimbodyArm simbody(model_of(parameters));
  const JointVector theirs =
      simbody.run(kPublishedPose, 4.0, 1e-10,
                  {arm.gains.stiffness, arm.gains.damping,
                   [&](double time_s, JointVector& target, JointVector& rate) {
                     targets.at(time_s, target, rate);
                   }});
  const JointVector ours = own_run(arm, targets, 5000);
  EXPECT_LT((theirs - ours).cwiseAbs().maxCoeff(), 1e-9) << theirs.transpose();
  const JointVector published(0.736274963, 0.176523521, -1.399930624, 0.357101577);
  EXPECT_LT((theirs - published).cwiseAbs().maxCoeff(), 2e-9) << theirs.transpose();
}

// A free arm is chaotic: one second, before small differences have grown.
TEST(SimbodyOracle, FreeFallIsTheSameToNineDigits) {
  DrivenArm arm(published_set(), kPublishedGravity);
  arm.gains.stiffness.setZero();
  arm.gains.damping.setZero();
  oracle::SimbodyArm simbody(model_of(published_set()));
  const JointVector theirs = simbody.run(kPublishedPose, 1.0, 1e-11, {});
  ArmState state{kPublishedPose, JointVector::Zero()};
  const LinearTargets targets;
  for (int i = 0; i < 2000; ++i) {
    arm.step(IntegrationScheme::runge_kutta4, 0.0, 5e-4, targets, state);
  }
  EXPECT_LT((theirs - state.q_rad).cwiseAbs().maxCoeff(), 1e-9) << theirs.transpose();
}

}  // namespace
}  // namespace rigwire::sim
