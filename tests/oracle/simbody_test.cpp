#include <gtest/gtest.h>

#include "bench/published_arm.h"
#include "simbody_arm.h"

namespace rigwire::sim {
namespace {

using namespace bench;  // published_arm.h

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
  const DrivenArm arm = published_arm();
  const CosineTargets targets(arm);
  oracle::SimbodyArm simbody(model_of(parameters));
  const JointVector theirs =
      simbody.run(kPublishedPose, 4.0, 1e-10,
                  {arm.gains.stiffness, arm.gains.damping,
                   [&](double time_s, JointVector& target, JointVector& rate) {
                     const DriveTargets at = targets(time_s);
                     target = at.position;
                     rate = at.rate;
                   }});
  ArmState state{kPublishedPose, JointVector::Zero()};
  for (int i = 0; i < 4000; ++i) {
    step_arm(arm, 4, 1e-3 * i, 1e-3, targets, state);
  }
  EXPECT_LT((theirs - state.q_rad).cwiseAbs().maxCoeff(), 1e-9) << theirs.transpose();
  EXPECT_LT((theirs - kSimbodyPose).cwiseAbs().maxCoeff(), 2e-9) << theirs.transpose();
}

// A free arm is chaotic: one second, before small differences have grown.
TEST(SimbodyOracle, FreeFallIsTheSameToNineDigits) {
  const DrivenArm arm = published_free_arm();
  oracle::SimbodyArm simbody(model_of(published_set()));
  const JointVector theirs = simbody.run(kPublishedPose, 1.0, 1e-11, {});
  ArmState state{kPublishedPose, JointVector::Zero()};
  for (int i = 0; i < 1000; ++i) {
    step_arm(arm, 6, 0.0, 1e-3, no_targets, state);
  }
  EXPECT_LT((theirs - state.q_rad).cwiseAbs().maxCoeff(), 1e-9) << theirs.transpose();
}

}  // namespace
}  // namespace rigwire::sim
