#include "sim/excavator/bucket_load.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <vector>

#include "sim/excavator/excavator.h"

namespace rigwire::sim {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

const Eigen::Vector3d kTip_B(1.4, 0.0, 0.0);

ValveCommand stick_in(double opening) {
  ValveCommand command;
  command.opening[2] = opening;
  return command;
}

TEST(BucketLoad, AForceAtTheTipIsCarriedByTheDrivesAsTheJacobianSays) {
  Excavator machine({}, Eigen::Isometry3d::Identity());
  machine.step(seconds(5));
  const JointVector before = machine.drive_forces();
  const Eigen::Vector3d force_W(-8000.0, 0.0, 5000.0);
  machine.set_bucket_force(force_W, machine.tip_W());
  machine.step(seconds(20));
  const JointVector q = machine.joint_angles_rad();
  const JointVector torque =
      machine.arm().dynamics().bucket_jacobian_C(q, kTip_B).transpose() * force_W;
  const JointVector load = machine.arm().dynamics().gravity_load(q);
  for (int joint = 1; joint < kArmJoints; ++joint) {
    const double lever = machine.linkages().at(joint - 1, q[joint]).lever_m;
    const double expected = (load[joint] - torque[joint]) / lever;
    EXPECT_NEAR(machine.drive_forces()[joint], expected, 1e-6 * std::abs(expected)) << joint;
  }
  machine.set_bucket_force(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  machine.step(seconds(20));
  EXPECT_LT((machine.drive_forces() - before).norm(), 1.0);
}

TEST(BucketLoad, TheJacobianIsTheSlopeOfTheTip) {
  const ArmDynamics arm({}, {0.0, 0.0, -9.80665});
  const JointVector q(0.7, 0.2, -1.1, -0.4);
  const auto J = arm.bucket_jacobian_C(q, kTip_B);
  for (int i = 0; i < kArmJoints; ++i) {
    const JointVector step = 1e-6 * JointVector::Unit(i);
    EXPECT_LT((J.col(i) - (arm.tip_C(q + step) - arm.tip_C(q - step)) / 2e-6).norm(), 1e-8) << i;
  }
}

// A damper of 1e9 N s/m explicitly applied would explode at any usable step.
TEST(BucketLoad, AStiffResistanceHoldsTheTipUntilItFails) {
  Excavator machine({}, Eigen::Isometry3d::Identity());
  const double limit_n = 30e3;
  machine.command(stick_in(0.4));
  bool held = false;
  bool failed = false;
  for (int i = 0; i < 1500; ++i) {
    machine.set_bucket_resistance({.direction_W = Eigen::Vector3d::UnitX(),
                                   .offset_n = 0.0,
                                   .gain_nspm = 1e9,
                                   .limit_n = limit_n,
                                   .point_B = kTip_B});
    machine.step(milliseconds(1));
    ASSERT_TRUE(machine.finite());
    const double force = machine.bucket_resistances_n()[0];
    ASSERT_LE(std::abs(force), limit_n);
    const double speed =
        (machine.arm().dynamics().bucket_jacobian_C(machine.joint_angles_rad(), kTip_B) *
         machine.joint_rates_radps())
            .x();
    if (std::abs(force) < limit_n) {
      held = true;
      ASSERT_LT(std::abs(speed), 1e-3) << i;
    } else {
      failed = true;
      ASSERT_LT(speed * force, 1e-3 * limit_n) << "soil must not push the bucket along";
    }
  }
  EXPECT_TRUE(held);
  EXPECT_TRUE(failed);
}

TEST(BucketLoad, NumbersThatAreNotAreRefusedAndTooManyAreDropped) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Excavator machine({}, Eigen::Isometry3d::Identity());
  machine.set_bucket_force({nan, 0.0, 0.0}, Eigen::Vector3d::Zero());
  std::vector<TipResistance> many(kTipResistances + 2);
  many[0].gain_nspm = nan;
  many[1].gain_nspm = -1.0;
  machine.set_bucket_resistances(many);
  EXPECT_EQ(machine.bucket_resistances_n().size(), kTipResistances);
  machine.set_bucket_resistances({many.data(), 2});
  EXPECT_TRUE(machine.bucket_resistances_n().empty());
  machine.step(seconds(1));
  EXPECT_TRUE(machine.finite());
}

}  // namespace
}  // namespace rigwire::sim
