#include "dig_cycle/joint_control.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigwire::dig_cycle {
namespace {

constexpr double kDigCycleJointControlStep_s = 0.02;

TEST(DigCycleJointControl, OpensTheCylinderThatMovesTowardsTheTarget) {
  JointControl control(Machine{}, {});
  const PerJoint openings =
      control.update({0.5, 0.5, -1.5, 0.5}, {0.0, 0.0, -1.0, 0.0}, kDigCycleJointControlStep_s);
  EXPECT_GT(openings[swing], 0.0) << "left";
  EXPECT_GT(openings[boom], 0.0) << "cylinder out raises the boom";
  EXPECT_GT(openings[stick], 0.0) << "cylinder out pulls the stick in: the angle falls";
  EXPECT_LT(openings[bucket], 0.0) << "cylinder in opens the bucket: the angle rises";
}

TEST(DigCycleJointControl, SlopeLimitsEveryChange) {
  const JointControlSettings settings;
  JointControl control(Machine{}, settings);
  PerJoint last{};
  for (int i = 0; i < 200; ++i) {
    const double target = i % 40 < 20 ? 1.0 : -0.5;
    const PerJoint now =
        control.update({target, target, -1.0, target}, {}, kDigCycleJointControlStep_s);
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      ASSERT_LE(std::abs(now[joint] - last[joint]),
                settings.slope_per_s * kDigCycleJointControlStep_s + 1e-12);
      ASSERT_LE(std::abs(now[joint]), settings.largest_opening[joint] + 1e-12);
    }
    last = now;
  }
}

TEST(DigCycleJointControl, NeverDrivesIntoAStop) {
  const Machine machine;
  JointControl control(machine, {});
  PerJoint angles{0.0, 40.0 * kDegree, -100.0 * kDegree, 0.0};
  const PerJoint beyond{0.0, 3.0, -6.0, -3.0};
  for (int i = 0; i < 3000; ++i) {
    const PerJoint openings = control.update(beyond, angles, kDigCycleJointControlStep_s);
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      angles[joint] +=
          openings[joint] * machine.opening_sign[joint] * 0.5 * kDigCycleJointControlStep_s;
    }
    for (const Joint joint : {boom, stick, bucket}) {
      ASSERT_LE(angles[joint], machine.upper_rad[joint] - 1.5 * kDegree);
      ASSERT_GE(angles[joint], machine.lower_rad[joint] + 1.5 * kDegree);
    }
  }
}

TEST(DigCycleJointControl, LeavesAStopThatTheJointAlreadyStandsOn) {
  const Machine machine;
  JointControl control(machine, {});
  const PerJoint at_stops{0.0, machine.upper_rad[boom], machine.lower_rad[stick],
                          machine.lower_rad[bucket]};
  const PerJoint openings =
      control.update({0.0, 0.2, -1.0, 0.5}, at_stops, kDigCycleJointControlStep_s);
  EXPECT_LT(openings[boom], 0.0);
  EXPECT_LT(openings[stick], 0.0);
  EXPECT_LT(openings[bucket], 0.0);
}

TEST(DigCycleJointControl, NeutralForgetsTheSlope) {
  JointControl control(Machine{}, {});
  for (int i = 0; i < 100; ++i) {
    (void)control.update({1.0, 0.5, -1.5, 0.5}, {}, kDigCycleJointControlStep_s);
  }
  control.neutral();
  const PerJoint openings = control.update({1.0, 0.0, 0.0, 0.0}, {}, kDigCycleJointControlStep_s);
  EXPECT_LE(openings[swing], 3.0 * kDigCycleJointControlStep_s + 1e-12);
}

// Its inertial unit tells no more than 250 deg/s: what turned faster was believed 26 degrees off.
TEST(DigCycleJointControl, ACurledBucketIsOpenedNoFasterThanItsSensorTells) {
  JointControl control(Machine{}, {});
  const PerJoint curled{0.0, 0.5, -1.5, -120.0 * kDegree};
  PerJoint openings{};
  for (int i = 0; i < 100; ++i) {
    openings = control.update({0.0, 0.5, -1.5, 0.0}, curled, kDigCycleJointControlStep_s);
  }
  EXPECT_NEAR(std::abs(openings[bucket]), 0.35, 1e-12);
  for (int i = 0; i < 100; ++i) {
    openings = control.update({0.0, 0.5, -1.5, 0.0}, {0.0, 0.5, -1.5, -90.0 * kDegree},
                              kDigCycleJointControlStep_s);
  }
  EXPECT_NEAR(std::abs(openings[bucket]), 0.8, 1e-12);
}

}  // namespace
}  // namespace rigwire::dig_cycle
