#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "allocation_counter.h"
#include "excavator_rig.h"

namespace rigwire::sim {
namespace {

using namespace test;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr ExcavatorLevel kLevels[] = {ExcavatorLevel::kinematic, ExcavatorLevel::quasi_static,
                                      ExcavatorLevel::dynamic, ExcavatorLevel::chambers};

ExcavatorParameters at_level(ExcavatorLevel level) {
  ExcavatorParameters parameters;
  parameters.level = level;
  return parameters;
}

TEST(ExcavatorLevels, EveryLevelStandsStillWithClosedValves) {
  for (const ExcavatorLevel level : kLevels) {
    Excavator machine(at_level(level), Eigen::Isometry3d::Identity());
    const Eigen::Vector3d start = machine.tip_W();
    machine.step(seconds(20));
    ASSERT_TRUE(machine.finite());
    EXPECT_LT((machine.tip_W() - start).norm(), 1e-6) << static_cast<int>(level);
    EXPECT_LT(machine.joint_rates_radps().norm(), 1e-9) << static_cast<int>(level);
  }
}

// The levels differ by what the oil gives, not by where the arm goes.
TEST(ExcavatorLevels, SmoothMotionsAgreeAmongTheLevels) {
  std::vector<Eigen::Vector3d> tips;
  for (const ExcavatorLevel level : kLevels) {
    Excavator machine(at_level(level), Eigen::Isometry3d::Identity());
    for (int i = 0; i < 300; ++i) {
      const double wave = std::sin(0.01 * i);
      machine.command(openings(0.0, 0.3 * wave, 0.3 * wave, -0.3 * wave));
      machine.step(milliseconds(10));
    }
    machine.command(ValveCommand{});
    machine.step(seconds(3));
    tips.push_back(machine.tip_W());
  }
  EXPECT_LT((tips[0] - tips[2]).norm(), 5e-3);
  EXPECT_LT((tips[1] - tips[2]).norm(), 5e-3);
  // With chambers the stick runs ahead of its oil, by the outlet's reserve of a tenth.
  EXPECT_LT((tips[3] - tips[2]).norm(), 0.2);
}

// The damper of the oil's mode held the swing of level chambers back to 7.5 rpm for good.
TEST(ExcavatorLevels, EveryLevelSwingsAsFastAsItsOil) {
  const ExcavatorParameters p;
  const double expected_radps = p.swing_spool.flow_max_m3ps / p.swing_displacement_m3prad;
  for (const ExcavatorLevel level : kLevels) {
    Excavator machine(at_level(level), Eigen::Isometry3d::Identity());
    machine.command(openings(1.0, 0.0, 0.0, 0.0));
    machine.step(seconds(12));
    ASSERT_TRUE(machine.finite());
    EXPECT_NEAR(machine.joint_rates_radps()[0], expected_radps, 0.01 * expected_radps)
        << static_cast<int>(level);
    // And comes to rest: what takes the rebound out is there still.
    machine.command(ValveCommand{});
    machine.step(seconds(15));
    EXPECT_LT(std::abs(machine.joint_rates_radps()[0]), 1e-3) << static_cast<int>(level);
  }
}

TEST(ExcavatorLevels, KinematicCylindersKeepTheVolumeThatTheyWereGiven) {
  Excavator machine(at_level(ExcavatorLevel::kinematic), Eigen::Isometry3d::Identity());
  machine.command(openings(0.3, 0.4, 0.4, -0.4));
  JointVector volume = machine.drive_positions();
  const ExcavatorParameters p;
  for (int i = 0; i < 900; ++i) {
    machine.step(milliseconds(1));
    for (int k = 1; k < kArmJoints; ++k) {
      const double flow = machine.flows_m3ps()[static_cast<std::size_t>(k)];
      const CylinderParameters& c = k == 1   ? p.boom_cylinder
                                    : k == 2 ? p.stick_cylinder
                                             : p.bucket_cylinder;
      volume[k] += 1e-3 * flow / (flow > 0.0 ? c.bottom_area_m2() : c.rod_side_area_m2());
    }
  }
  // The pose follows by one Newton step, so that only the last step's curvature is missing.
  EXPECT_LT((machine.drive_positions() - volume).tail<3>().norm(), 1e-6);
}

// What quasi-statics is for: forces that are those of the dynamic arm once it stands.
TEST(ExcavatorLevels, QuasiStaticForcesAreGravityOverTheLever) {
  Excavator machine(at_level(ExcavatorLevel::quasi_static), Eigen::Isometry3d::Identity());
  machine.set_payload_kg(1000.0);
  machine.step(seconds(1));
  const JointVector load = machine.arm().dynamics().gravity_load(machine.joint_angles_rad());
  for (int i = 1; i < kArmJoints; ++i) {
    const double lever = machine.linkages().at(i - 1, machine.joint_angles_rad()[i]).lever_m;
    EXPECT_NEAR(machine.drive_forces()[i], load[i] / lever, 1e-6 * std::abs(load[i] / lever));
  }
}

TEST(ExcavatorLevels, EveryLevelWithForcesStallsAtReliefUnderALoadItCannotLift) {
  for (const ExcavatorLevel level :
       {ExcavatorLevel::quasi_static, ExcavatorLevel::dynamic, ExcavatorLevel::chambers}) {
    ExcavatorParameters parameters = at_level(level);
    parameters.payload_max_kg = 20000.0;
    parameters.initial.boom_rad = 0.35;
    parameters.strikes_itself = false;  // Without a ground it falls under its own frame.
    Excavator machine(parameters, Eigen::Isometry3d::Identity());
    machine.set_payload_kg(20000.0);
    machine.command(openings(0.0, 1.0, 0.0, 0.0));
    const double boom = machine.joint_angles_rad()[1];
    machine.step(seconds(2));
    ASSERT_TRUE(machine.finite());
    EXPECT_LT(machine.joint_angles_rad()[1], boom) << static_cast<int>(level);
    const ValveSample sample = machine.valve_sample(machine.time());
    EXPECT_NEAR(sample.port_a_pressure_pa[1], 35e6, 2.5e6) << static_cast<int>(level);
    EXPECT_NEAR(sample.supply_pressure_pa, 35e6, 1.0);
  }
}

// Research case 5 with chambers: p1 = supply, p2 = tank, and quiet.
TEST(ExcavatorLevels, ChambersAtTheEndStopWithTheValveOpenSettleAtSupplyAndTank) {
  for (int joint = 1; joint < kArmJoints; ++joint) {
    for (const double direction : {1.0, -1.0}) {
      Excavator machine(at_level(ExcavatorLevel::chambers), Eigen::Isometry3d::Identity());
      ValveCommand command;
      command.opening[static_cast<std::size_t>(joint)] = direction;
      machine.command(command);
      machine.step(seconds(30));
      ASSERT_TRUE(machine.finite());
      const ValveSample sample = machine.valve_sample(machine.time());
      const auto section = static_cast<std::size_t>(joint);
      const double a = sample.port_a_pressure_pa[section];
      const double b = sample.port_b_pressure_pa[section];
      EXPECT_NEAR(direction > 0.0 ? a : b, sample.supply_pressure_pa, 1.0) << joint << direction;
      EXPECT_NEAR(direction > 0.0 ? b : a, 0.3e6, 1.0) << joint << direction;
      EXPECT_NEAR(sample.supply_pressure_pa, 35e6, 1.0);
      EXPECT_LT(std::abs(machine.drive_rates()[joint]), 1e-9) << "chatter at the stop";
    }
  }
}

TEST(ExcavatorLevels, ChambersConvergeWithTheFirstOrderOfTheirScheme) {
  const auto tip_after = [](double step_s) {
    ExcavatorParameters parameters = at_level(ExcavatorLevel::chambers);
    parameters.step_s = step_s;
    Excavator machine(parameters, Eigen::Isometry3d::Identity());
    machine.command(openings(0.2, 0.4, 0.4, 0.4));
    machine.step(milliseconds(800));
    return machine.tip_W();
  };
  const Eigen::Vector3d reference = tip_after(2e-5);
  const double coarse = (tip_after(2e-3) - reference).norm();
  const double fine = (tip_after(1e-3) - reference).norm();
  EXPECT_LT(fine, 5e-3);
  EXPECT_NEAR(coarse / fine, 2.0, 0.5);
}

TEST(ExcavatorLevels, NoLevelAllocatesInAStep) {
  for (const ExcavatorLevel level : kLevels) {
    Excavator machine(at_level(level), Eigen::Isometry3d::Identity());
    const TipResistance soil{.gain_nspm = 1e6, .limit_n = 2e4};
    const auto before = rigwire::test::allocations();
    for (int i = 0; i < 1000; ++i) {
      machine.command(openings(0.3, i % 200 < 100 ? 1.0 : -1.0, 0.8, -0.8));
      machine.set_bucket_resistance(soil);
      machine.step(milliseconds(2));
    }
    EXPECT_EQ(rigwire::test::allocations(), before) << static_cast<int>(level);
    EXPECT_TRUE(machine.finite());
  }
}

TEST(ExcavatorLevels, EveryLevelStaysFiniteThroughWildCommands) {
  for (const ExcavatorLevel level : kLevels) {
    for (const double step_s : {1e-3, 1e-2}) {
      ExcavatorParameters parameters = at_level(level);
      parameters.step_s = step_s;
      Excavator machine(parameters, Eigen::Isometry3d::Identity());
      for (int i = 0; i < 600; ++i) {
        ValveCommand command = openings(std::sin(7.0 * i), std::sin(1.3 * i) > 0.0 ? 1.0 : -1.0,
                                        std::cos(2.9 * i), std::cos(0.1 * i));
        command.floating[1] = i % 50 > 45;
        machine.command(command);
        machine.set_payload_kg(i % 7 * 200.0);
        machine.step(milliseconds(20));
        ASSERT_TRUE(machine.finite()) << static_cast<int>(level) << ' ' << i;
        ASSERT_LT(machine.joint_rates_radps().norm(), 25.0) << static_cast<int>(level) << ' ' << i;
      }
    }
  }
}

// Finding: level chambers at 20 ms reached 60.5 MPa behind a relief valve of 35.
TEST(ExcavatorLevels, ChambersStayAtTheirReliefValvesAtEveryStep) {
  for (const double step_s : {1e-3, 5e-3, 2e-2}) {
    ExcavatorParameters parameters = at_level(ExcavatorLevel::chambers);
    parameters.step_s = step_s;
    Excavator machine(parameters, Eigen::Isometry3d::Identity());
    double greatest = 0.0;
    // Every function to both ends of its stroke at full opening, and back against its own swing.
    for (int i = 0; i < 1200; ++i) {
      const double way = i / 150 % 2 == 0 ? 1.0 : -1.0;
      machine.command(openings(way, way, -way, way));
      machine.step(milliseconds(20));
      ASSERT_TRUE(machine.finite());
      const ValveSample sample = machine.valve_sample(machine.time());
      greatest = std::max({greatest, *std::ranges::max_element(sample.port_a_pressure_pa),
                           *std::ranges::max_element(sample.port_b_pressure_pa)});
    }
    EXPECT_GT(greatest, 0.85 * parameters.supply.relief_pressure_pa);
    EXPECT_LT(greatest, parameters.supply.relief_pressure_pa + 3e6) << step_s;
  }
}

}  // namespace
}  // namespace rigwire::sim
