#include "sim/excavator/excavator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "excavator_rig.h"

namespace rigwire::sim {
namespace {

using namespace test;
using std::chrono::milliseconds;
using std::chrono::seconds;

double lever(const Excavator& machine, int joint) {
  return machine.linkages().at(joint - 1, machine.joint_angles_rad()[joint]).lever_m;
}

TEST(Excavator, StandsAtRestFromTheFirstStep) {
  Excavator machine = level_machine();
  const JointVector start = machine.joint_angles_rad();
  machine.step(milliseconds(1));
  EXPECT_LT((machine.joint_angles_rad() - start).norm(), 1e-12);
  EXPECT_LT(machine.joint_accelerations_radps2().norm(), 1e-8);
}

// "Arms sink under gravity" is the usual complaint about velocity servos; Eq. 5's spring holds. One
// minute stands for the hour: the state reaches a fixed point of the step, which then repeats.
TEST(Excavator, ClosedValvesHoldForAMinuteWithinAMicrometre) {
  Excavator machine = level_machine();
  machine.set_payload_kg(1200.0);
  machine.step(seconds(10));
  const Eigen::Vector3d tip = machine.tip_W();
  for (int i = 0; i < 60; ++i) {
    machine.step(seconds(1));
  }
  EXPECT_LT((machine.tip_W() - tip).norm(), 1e-6);
}

// Research case 4.
TEST(Excavator, HoldingForcesAreGravityOverTheLeverWithAndWithoutPayload) {
  Excavator machine = level_machine();
  for (const double payload_kg : {0.0, 1200.0, 0.0}) {
    const JointVector before = machine.joint_rates_radps();
    machine.set_payload_kg(payload_kg);
    EXPECT_EQ(machine.joint_rates_radps(), before) << "the payload must not kick the bucket";
    machine.step(seconds(30));
    const JointVector load = machine.arm().dynamics().gravity_load(machine.joint_angles_rad());
    for (int joint = 1; joint < kArmJoints; ++joint) {
      const double expected = load[joint] / lever(machine, joint);
      EXPECT_NEAR(machine.drive_forces()[joint], expected, 1e-9 * std::abs(expected)) << joint;
    }
  }
}

// Research case 26.
TEST(Excavator, AccelerometersAtRestFeelGravityTurnedIntoTheirFrame) {
  Eigen::Isometry3d X_WC = Eigen::Isometry3d::Identity();
  X_WC.linear() = (Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()) *
                   Eigen::AngleAxisd(-0.1, Eigen::Vector3d::UnitY()))
                      .toRotationMatrix();
  X_WC.translation() << 100.0, -50.0, 7.0;
  Excavator machine(ExcavatorParameters{}, X_WC);
  machine.step(seconds(20));
  for (const Link which :
       {Link::undercarriage, Link::upper, Link::boom, Link::stick, Link::bucket}) {
    const LinkMotion& link = machine.link(which);
    EXPECT_LT(link.a_WL_W.norm(), 1e-6);
    EXPECT_LT(link.w_WL_W.norm(), 1e-7);
    EXPECT_TRUE((link.X_WL.linear() * link.X_WL.linear().transpose()).isIdentity(1e-12));
  }
}

TEST(Excavator, LinkAccelerationsAreTheSlopeOfTheLinkVelocities) {
  Excavator machine = level_machine();
  machine.command(openings(0.8, 0.6, -0.5, 0.4));
  LinkMotion before;
  for (int i = 0; i < 700; ++i) {
    before = machine.link(Link::bucket);
    machine.step(milliseconds(1));
  }
  const LinkMotion& now = machine.link(Link::bucket);
  const Eigen::Vector3d slope = (now.v_WL_W - before.v_WL_W) / 1e-3;
  EXPECT_GT(now.v_WL_W.norm(), 0.5);
  EXPECT_LT((slope - now.a_WL_W).norm(), 0.02 + 0.05 * now.a_WL_W.norm());
}

TEST(Excavator, PositiveOpeningsTurnLeftLiftAndDrawIn) {
  const double signs[] = {1.0, 1.0, -1.0, -1.0};
  for (std::size_t section = 0; section < 4; ++section) {
    Excavator machine = level_machine();
    const JointVector start = machine.joint_angles_rad();
    ValveCommand command;
    command.opening[section] = 0.5;
    machine.command(command);
    machine.step(seconds(1));
    const auto row = static_cast<Eigen::Index>(section);
    EXPECT_GT(signs[section] * (machine.joint_angles_rad()[row] - start[row]), 0.05) << section;
    EXPECT_TRUE(machine.finite());
  }
}

TEST(Excavator, CylinderSpeedIsFlowOverArea) {
  Excavator machine = level_machine();
  machine.command(openings(0.0, 0.0, 0.5, 0.0));
  machine.step(milliseconds(700));
  const double flow = machine.flows_m3ps()[2];
  const ExcavatorParameters defaults;
  EXPECT_NEAR(flow, defaults.stick_spool.flow_max_m3ps * (0.5 - 0.04) / 0.96, 1e-9);
  EXPECT_NEAR(machine.drive_rates()[2], flow / defaults.stick_cylinder.bottom_area_m2(), 0.02);
}

TEST(Excavator, SwingReachesElevenTurnsAMinuteAndStops) {
  Excavator machine = level_machine();
  machine.command(openings(1.0, 0.0, 0.0, 0.0));
  machine.step(seconds(6));
  EXPECT_NEAR(machine.joint_rates_radps()[0], 11.0 * 2.0 * std::numbers::pi / 60.0, 0.02);
  machine.command(openings(0.0, 0.0, 0.0, 0.0));
  machine.step(seconds(10));
  EXPECT_NEAR(machine.joint_rates_radps()[0], 0.0, 1e-3);
}

TEST(Excavator, SwingTorqueNeverExceedsTheMotors) {
  Excavator machine = level_machine();
  for (int i = 0; i < 400; ++i) {
    machine.command(openings(i % 100 < 50 ? 1.0 : -1.0, 0.0, 0.0, 0.0));
    machine.step(milliseconds(20));
    ASSERT_LE(std::abs(machine.drive_forces()[0]), 55.1e3);
  }
}

// Research case 7.
TEST(Excavator, SaturatedPumpSharesInTheRatioOfTheRequestsToTheLastBit) {
  Excavator machine = level_machine();
  const ExcavatorParameters defaults;
  machine.command(openings(0.5, 0.8, 1.0, 0.7));
  machine.step(milliseconds(900));
  const auto& flow = machine.flows_m3ps();
  const double sum = std::abs(flow[0]) + std::abs(flow[1]) + std::abs(flow[2]) + std::abs(flow[3]);
  const double power_limited =
      defaults.supply.power_limit_w * defaults.supply.efficiency / machine.supply_pressure_pa();
  EXPECT_LE(sum, defaults.supply.pump_flow_m3ps * (1.0 + 1e-12));
  EXPECT_LE(sum, 1.05 * power_limited);
  const double request1 = defaults.boom_spool.flow_max_m3ps * (0.8 - 0.04) / 0.96;
  const double request2 = defaults.stick_spool.flow_max_m3ps;
  EXPECT_NEAR(flow[1] / flow[2], request1 / request2, 1e-9);
}

// Research case 5.
TEST(Excavator, EndStopWithTheValveOpenStandsQuietlyAtRelief) {
  for (int joint = 1; joint < kArmJoints; ++joint) {
    for (const double direction : {1.0, -1.0}) {
      Excavator machine = level_machine();
      ValveCommand command;
      command.opening[static_cast<std::size_t>(joint)] = direction;
      machine.command(command);
      machine.step(seconds(30));
      const WorkingRange& range = machine.linkages().range(joint - 1);
      const double end = direction > 0.0 ? range.length_max_m : range.length_min_m;
      EXPECT_NEAR(machine.drive_targets()[joint], end, 1e-12) << joint << direction;
      EXPECT_NEAR(machine.drive_positions()[joint], end, 6e-3);
      EXPECT_LT(std::abs(machine.drive_rates()[joint]), 1e-6) << "chatter at the stop";
      const ValveSample sample = machine.valve_sample(machine.time());
      const auto section = static_cast<std::size_t>(joint);
      EXPECT_EQ(
          direction > 0.0 ? sample.port_a_pressure_pa[section] : sample.port_b_pressure_pa[section],
          35e6);
      EXPECT_EQ(machine.flows_m3ps()[section], 0.0);
    }
  }
}

// Research cases 1 and 2: never past the dead centre, at any step.

TEST(Excavator, ReliefStallDoesNotWindUpAndFreesWithoutACatapult) {
  ExcavatorParameters parameters;
  parameters.supply.relief_pressure_pa = 6e6;
  parameters.payload_max_kg = 20000.0;
  Excavator machine = level_machine(parameters);
  machine.set_payload_kg(20000.0);
  machine.step(seconds(1));
  machine.command(openings(0.0, 1.0, 0.0, 0.0));  // Lifts against 20 t, cannot.
  const ForceLimits limits = force_limits(parameters.boom_cylinder.bottom_area_m2(),
                                          parameters.boom_cylinder.rod_side_area_m2(), 6e6, 0.3e6);
  machine.step(milliseconds(300));
  double largest_stretch = 0.0;
  for (int i = 0; i < 600; ++i) {
    machine.step(milliseconds(100));
    ASSERT_LE(machine.drive_forces()[1], limits.greatest * (1.0 + 1e-12));
    if (i >= 100) {  // It has sunk to its stop and stands.
      largest_stretch =
          std::max(largest_stretch, machine.drive_targets()[1] - machine.drive_positions()[1]);
    }
  }
  EXPECT_LE(largest_stretch, 1.01 * limits.greatest / parameters.drives.boom_stiffness_npm);
  machine.command(openings(0.0, 0.0, 0.0, 0.0));
  machine.step(milliseconds(300));
  const double before = machine.drive_positions()[1];
  machine.set_payload_kg(0.0);
  double highest = before;
  for (int i = 0; i < 300; ++i) {
    machine.step(milliseconds(10));
    highest = std::max(highest, machine.drive_positions()[1]);
  }
  EXPECT_LT(highest - before, 3.0 * limits.greatest / parameters.drives.boom_stiffness_npm);
}

// Research case 25.

TEST(Excavator, LostCommandsClosedByTheWatchdogStopWithoutAForceStep) {
  Excavator machine = level_machine();
  machine.command(openings(0.0, 0.6, 0.6, 0.6));
  machine.step(seconds(1));
  machine.command(ValveCommand{});
  JointVector before = machine.drive_forces();
  const ExcavatorParameters defaults;
  const double steepest =
      defaults.drives.boom_stiffness_npm * 0.5 * 1e-3 + 2e6;  // k v dt and the damper's share.
  for (int i = 0; i < 500; ++i) {
    machine.step(milliseconds(1));
    ASSERT_LT((machine.drive_forces() - before).cwiseAbs().maxCoeff(), steepest) << i;
    before = machine.drive_forces();
  }
  machine.step(seconds(5));
  EXPECT_LT(machine.drive_rates().norm(), 1e-4);
}

TEST(Excavator, NotANumberIsRefusedPerSectionAndCounted) {
  Excavator machine = level_machine();
  Excavator clean = level_machine();
  machine.command(openings(0.2, 0.3, 0.0, 0.0));
  clean.command(openings(0.2, 0.3, 0.4, 0.0));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  machine.command(openings(0.2, nan, 0.4, 0.0));
  EXPECT_EQ(machine.refused_commands(), 1u);
  machine.step(seconds(1));
  clean.step(seconds(1));
  EXPECT_TRUE(same_bits(machine, clean));
  machine.command(openings(std::numeric_limits<double>::infinity(), 0.0, 0.0, 0.0));
  machine.step(seconds(1));
  EXPECT_EQ(machine.valve_sample(machine.time()).spool_position[0], 1.0);
  EXPECT_TRUE(machine.finite());
}

TEST(Excavator, FloatingBoomSinksUnderItsWeightAndTheOthersHold) {
  Excavator machine = level_machine();
  const JointVector start = machine.joint_angles_rad();
  ValveCommand command;
  command.floating[1] = true;
  machine.command(command);
  machine.step(seconds(1));
  EXPECT_LT(machine.joint_angles_rad()[1], start[1] - 0.05);
  EXPECT_NEAR(machine.joint_angles_rad()[3], start[3], 0.02);
  const ValveSample sample = machine.valve_sample(machine.time());
  EXPECT_EQ(sample.port_a_pressure_pa[1], 0.3e6);
}

TEST(Excavator, PressuresCarryTheBoomsWeight) {
  Excavator machine = level_machine();
  machine.step(seconds(5));
  const ValveSample sample = machine.valve_sample(SimTime{seconds(5)});
  const ExcavatorParameters defaults;
  const double force = sample.port_a_pressure_pa[1] * defaults.boom_cylinder.bottom_area_m2() -
                       sample.port_b_pressure_pa[1] * defaults.boom_cylinder.rod_side_area_m2();
  EXPECT_NEAR(force, machine.drive_forces()[1], 1e-6);
  EXPECT_GT(sample.port_a_pressure_pa[1], 3e6);
  EXPECT_EQ(sample.supply_pressure_pa, 2.3e6) << "standby: tank and margin";
  EXPECT_EQ(sample.time, SimTime{seconds(5)});
}

}  // namespace
}  // namespace rigwire::sim
