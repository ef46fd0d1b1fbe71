#include "sim/excavator/excavator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <functional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "excavator_rig.h"

namespace rigwire::sim {
namespace {

using namespace test;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

TEST(ExcavatorNumerics, StiffDriveTowardsTheDeadCentreAt20MillisecondsNeverFlipsTheBucket) {
  ExcavatorParameters parameters;
  parameters.drives.boom_stiffness_npm *= 50.0;
  parameters.drives.stick_stiffness_npm *= 50.0;
  parameters.drives.bucket_stiffness_npm *= 50.0;
  parameters.step_s = 0.02;
  ExcavatorParameters fine = parameters;
  fine.step_s = 1e-4;
  Excavator machine = level_machine(parameters);
  Excavator reference = level_machine(fine);
  const WorkingRange& range = machine.linkages().range(2);
  for (int i = 0; i < 300; ++i) {
    const double opening = i < 200 ? 1.0 : -1.0;
    machine.command(openings(0.0, 0.3 * opening, 0.0, opening));
    reference.command(openings(0.0, 0.3 * opening, 0.0, opening));
    machine.step(milliseconds(20));
    reference.step(milliseconds(20));
    ASSERT_GT(machine.joint_angles_rad()[3], range.q_min_rad() - 0.12) << i;
    ASSERT_LT(machine.joint_angles_rad()[3], range.q_max_rad() + 0.12) << i;
    // In motion a step's lag at a tip speed of 14 m/s; the mirrored pose is 4.8 m away.
    ASSERT_LT((machine.tip_W() - reference.tip_W()).norm(), 0.5) << i;
    if (i == 199) {
      EXPECT_NEAR(machine.joint_angles_rad()[3], reference.joint_angles_rad()[3], 1e-3)
          << "at the curled end";
    }
  }
}

// Research case 6: the bucket's drive held at its relief by a load it cannot move, then freed.

TEST(ExcavatorNumerics, ZeroAndNegativeSpansLeaveEveryBit) {
  Excavator machine = level_machine();
  Excavator twin = level_machine();
  for (Excavator* each : {&machine, &twin}) {
    each->command(openings(0.3, 0.4, 0.5, 0.6));
    each->step(milliseconds(123));
  }
  machine.step(nanoseconds(0));
  machine.step(nanoseconds(-5));
  EXPECT_TRUE(same_bits(machine, twin));
  EXPECT_EQ(machine.time(), twin.time());
}

TEST(ExcavatorNumerics, OneLongStepIsManyShortOnesToTheLastBit) {
  Excavator once = level_machine();
  Excavator often = level_machine();
  for (Excavator* machine : {&once, &often}) {
    machine->command(openings(0.3, -0.4, 0.5, 0.6));
  }
  once.step(milliseconds(500));
  for (int i = 0; i < 500; ++i) {
    often.step(milliseconds(1));
  }
  EXPECT_TRUE(same_bits(once, often));
}

TEST(ExcavatorNumerics, TinyAndIrregularSpansStayFiniteAndNearTheRegularRun) {
  Excavator regular = level_machine();
  Excavator irregular = level_machine();
  regular.command(openings(0.3, 0.4, 0.5, 0.6));
  irregular.command(openings(0.3, 0.4, 0.5, 0.6));
  regular.step(milliseconds(300));
  const int parts[] = {1, 700'000, 3, 2'500'000, 17, 999'999, 5'000'001};
  SimTime end{milliseconds(300)};
  for (std::size_t i = 0; irregular.time() < end; ++i) {
    irregular.step(
        std::min<Duration>(nanoseconds(parts[i % std::size(parts)]), end - irregular.time()));
    ASSERT_TRUE(irregular.finite());
    ASSERT_TRUE(irregular.joint_accelerations_radps2().allFinite());
  }
  EXPECT_LT((regular.tip_W() - irregular.tip_W()).norm(), 1e-3);
}

// Research case 34.
TEST(ExcavatorNumerics, TheSameRunTwiceGivesTheSameBits) {
  Excavator first = level_machine();
  Excavator second = level_machine();
  for (Excavator* machine : {&first, &second}) {
    for (int i = 0; i < 200; ++i) {
      machine->command(openings(std::sin(0.1 * i), std::cos(0.2 * i), std::sin(0.3 * i), 0.5));
      machine->step(milliseconds(10));
    }
  }
  EXPECT_TRUE(same_bits(first, second));
}

TEST(ExcavatorNumerics, EightThreadsGiveTheBitsOfOne) {
  const auto run = [](Excavator& machine) {
    for (int i = 0; i < 100; ++i) {
      machine.command(openings(std::sin(0.1 * i), std::cos(0.2 * i), std::sin(0.3 * i), 0.5));
      machine.step(milliseconds(10));
    }
  };
  Excavator alone = level_machine();
  run(alone);
  std::deque<Excavator> machines;
  std::vector<std::thread> threads;
  for (int i = 0; i < 8; ++i) {
    machines.emplace_back(ExcavatorParameters{}, Eigen::Isometry3d::Identity());
    threads.emplace_back(run, std::ref(machines.back()));
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  for (const Excavator& machine : machines) {
    EXPECT_TRUE(same_bits(machine, alone));
  }
}

// Research case 23.
TEST(ExcavatorNumerics, AThousandKilometresFromTheOriginTheArmMovesTheSame) {
  Eigen::Isometry3d far = Eigen::Isometry3d::Identity();
  far.translation() << 1e6, 1e6, 0.0;
  Excavator here = level_machine();
  Excavator there(ExcavatorParameters{}, far);
  for (Excavator* machine : {&here, &there}) {
    machine->command(openings(0.3, 0.4, 0.5, 0.6));
    machine->step(seconds(2));
  }
  EXPECT_TRUE(same_bits(here, there));
  EXPECT_LT((there.tip_W() - far.translation() - here.tip_W()).norm(), 1e-8);
}

// Research case 35.

TEST(ExcavatorNumerics, ADigConvergesWithTheFirstOrderOfTheStep) {
  const auto tip = [](double step_s) {
    ExcavatorParameters parameters;
    parameters.step_s = step_s;
    Excavator machine = level_machine(parameters);
    machine.command(openings(0.3, 0.4, -0.3, 0.5));
    machine.step(milliseconds(1500));
    return machine.tip_W();
  };
  const Eigen::Vector3d reference = 2.0 * tip(1e-5) - tip(2e-5);  // Extrapolated.
  const double coarse = (tip(1e-3) - reference).norm();
  const double fine = (tip(5e-4) - reference).norm();
  EXPECT_LT(fine, 5e-3);
  EXPECT_NEAR(coarse / fine, 2.0, 0.2);
}

TEST(ExcavatorNumerics, StiffestDriveThatValidateAllowsIsStableAtOneMillisecond) {
  ExcavatorParameters parameters;
  double factor = 1.0;
  for (;; factor *= 1.5) {
    ExcavatorParameters next = parameters;
    next.drives.boom_stiffness_npm *= 1.5;
    next.drives.stick_stiffness_npm *= 1.5;
    next.drives.bucket_stiffness_npm *= 1.5;
    next.drives.swing_stiffness_nmprad *= 1.5;
    try {
      validate(next);
    } catch (const std::invalid_argument&) {
      break;
    }
    parameters = next;
  }
  EXPECT_GT(factor, 1e4);
  Excavator stiff = level_machine(parameters);
  Excavator soft = level_machine();
  for (int i = 0; i < 400; ++i) {
    const double wave = std::sin(0.03 * i);
    for (Excavator* machine : {&stiff, &soft}) {
      machine->command(openings(0.0, 0.4 * wave, 0.4 * wave, -0.4 * wave));
      machine->step(milliseconds(10));
    }
    ASSERT_TRUE(stiff.finite());
    ASSERT_LT((stiff.tip_W() - soft.tip_W()).norm(), 0.15) << i;
  }
}

// Judging relief by the spring at the new state once did: 60 mm off at 1 ms.
TEST(ExcavatorNumerics, StiffDriveDoesNotOpenItsReliefOnTheLinkagesCurvature) {
  ExcavatorParameters parameters;
  for (double* stiffness :
       {&parameters.drives.swing_stiffness_nmprad, &parameters.drives.boom_stiffness_npm,
        &parameters.drives.stick_stiffness_npm, &parameters.drives.bucket_stiffness_npm}) {
    *stiffness *= 2e4;
  }
  Excavator machine = level_machine(parameters);
  parameters.step_s = 1e-4;
  Excavator reference = level_machine(parameters);
  for (int i = 0; i < 4; ++i) {
    const double opening = i % 2 == 0 ? 0.5 : -0.5;
    for (Excavator* each : {&machine, &reference}) {
      each->command(openings(0.0, opening, opening, opening));
      each->step(seconds(1));
    }
  }
  for (Excavator* each : {&machine, &reference}) {
    each->command(ValveCommand{});
    each->step(seconds(1));
  }
  EXPECT_LT((machine.tip_W() - reference.tip_W()).norm(), 1e-3);
}

}  // namespace
}  // namespace rigwire::sim
