#include "dig_cycle/cycle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace rigwire::dig_cycle {
namespace {

constexpr double kStep_s = 0.02;

/// A machine whose joints turn in proportion to the openings.
struct FakeMachine {
  Machine machine;
  Belief belief;
  PerJoint full_speed_radps{1.1, 0.35, 0.5, 0.9};

  FakeMachine() {
    belief.ready = true;
    belief.angles_rad = {0.3, 30.0 * kDegree, -90.0 * kDegree, 0.0};
  }
  void move(const PerJoint& openings) {
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      belief.rates_radps[joint] =
          openings[joint] * machine.opening_sign[joint] * full_speed_radps[joint];
      belief.angles_rad[joint] += belief.rates_radps[joint] * kStep_s;
    }
  }
};

View seen(double ground_m) {
  View view;
  view.ground_z_m = ground_m;
  return view;
}

struct Trace {
  std::vector<Phase> phases;
  double lowest_tip_m = 1e9;
  double lowest_tip_while_swinging_m = 1e9;
  double seconds = 0.0;
};

Trace run(Cycle& cycle, FakeMachine& fake, const View& view, double limit_s) {
  Trace trace;
  while (!cycle.done() && !cycle.fault() && trace.seconds < limit_s) {
    if (trace.phases.empty() || trace.phases.back() != cycle.phase()) {
      trace.phases.push_back(cycle.phase());
    }
    const CycleOutput output = cycle.update(fake.belief, view, kStep_s);
    fake.move(output.openings);
    const double tip_m = arm_shape(fake.machine, fake.belief.angles_rad).tip.z_m;
    trace.lowest_tip_m = std::min(trace.lowest_tip_m, tip_m);
    if (std::abs(fake.belief.rates_radps[swing]) > 0.1) {
      trace.lowest_tip_while_swinging_m = std::min(trace.lowest_tip_while_swinging_m, tip_m);
    }
    trace.seconds += kStep_s;
  }
  return trace;
}

TEST(DigCycleCycle, GoesThroughItsPhasesInOrderAndCounts) {
  FakeMachine fake;
  Cycle cycle(fake.machine, {.cycles = 2});
  const Trace trace = run(cycle, fake, seen(0.0), 240.0);
  const std::vector<Phase> one{Phase::approach,       Phase::dig,  Phase::lift,
                               Phase::swing_to_truck, Phase::dump, Phase::swing_back};
  std::vector<Phase> two = one;
  two.insert(two.end(), one.begin(), one.end());
  EXPECT_EQ(trace.phases, two);
  EXPECT_EQ(cycle.completed(), 2U);
  EXPECT_FALSE(cycle.fault().has_value());
  EXPECT_LT(trace.seconds, 120.0);
  const CycleOutput after = cycle.update(fake.belief, {}, kStep_s);
  EXPECT_EQ(after.openings, PerJoint{}) << "done means neutral";
}

TEST(DigCycleCycle, DigsBelowTheGroundThatTheLidarSees) {
  for (const double ground_m : {-0.6, 0.0, 0.5}) {
    FakeMachine fake;
    Cycle cycle(fake.machine, {.cycles = 1});
    const Trace trace = run(cycle, fake, seen(ground_m), 120.0);
    EXPECT_EQ(cycle.completed(), 1U);
    EXPECT_NEAR(trace.lowest_tip_m, ground_m - 0.35, 0.15) << ground_m;
  }
}

TEST(DigCycleCycle, SwingsOnlyWithTheBucketHigh) {
  FakeMachine fake;
  fake.belief.angles_rad[swing] = 0.0;
  Cycle cycle(fake.machine, {.cycles = 1});
  const Trace trace = run(cycle, fake, seen(0.0), 120.0);
  EXPECT_GT(trace.lowest_tip_while_swinging_m, 3.4);
}

TEST(DigCycleCycle, ObstacleStopsTheSwingAndItsRemovalResumesIt) {
  FakeMachine fake;
  Cycle cycle(fake.machine, {.cycles = 1});
  View view = seen(0.0);
  while (cycle.phase() != Phase::swing_to_truck || fake.belief.angles_rad[swing] < 0.5) {
    fake.move(cycle.update(fake.belief, view, kStep_s).openings);
  }
  view.obstacle_left = true;
  double stopped_at_rad = 0.0;
  for (int i = 0; i < 6000; ++i) {  // two minutes, longer than the limit of a phase
    const CycleOutput output = cycle.update(fake.belief, view, kStep_s);
    EXPECT_TRUE(output.held_by_obstacle);
    fake.move(output.openings);
    if (i == 50) {
      stopped_at_rad = fake.belief.angles_rad[swing];
    }
  }
  EXPECT_NEAR(fake.belief.angles_rad[swing], stopped_at_rad, 1e-6);
  EXPECT_FALSE(cycle.fault().has_value()) << "waiting is no fault";
  view.obstacle_left = false;
  view.obstacle_right = true;  // behind the motion: no reason to stop
  (void)run(cycle, fake, seen(0.0), 120.0);
  EXPECT_EQ(cycle.completed(), 1U);
}

TEST(DigCycleCycle, HardGroundEndsTheDigAndTheRestGoesOn) {
  FakeMachine fake;
  Cycle cycle(fake.machine, {.cycles = 1});
  double seconds = 0.0;
  while (cycle.phase() != Phase::lift && seconds < 100.0) {
    const PerJoint openings = cycle.update(fake.belief, {}, kStep_s).openings;
    if (cycle.phase() != Phase::dig) {
      fake.move(openings);  // in the dig nothing moves
    }
    seconds += kStep_s;
  }
  EXPECT_EQ(cycle.phase(), Phase::lift);
}

TEST(DigCycleCycle, MachineThatDoesNotFollowIsAFaultWithNeutralValves) {
  FakeMachine fake;
  Cycle cycle(fake.machine, {});
  for (int i = 0; i < 61 * 50; ++i) {
    (void)cycle.update(fake.belief, {}, kStep_s);
  }
  ASSERT_TRUE(cycle.fault().has_value());
  EXPECT_THAT(std::string(*cycle.fault()), ::testing::HasSubstr("approach"));
  EXPECT_EQ(cycle.update(fake.belief, {}, kStep_s).openings, PerJoint{});
}

// The bucket opened while the stick still went out, and poured its load before the truck.
TEST(DigCycleCycle, OpensTheBucketOverTheTruckOnly) {
  FakeMachine fake;
  Cycle cycle(fake.machine, {.cycles = 2});
  constexpr double kSide_m = 4.05;  // Distance of the truck's near side from the swing axis.
  while (!cycle.done() && !cycle.fault()) {
    fake.move(cycle.update(fake.belief, seen(0.0), kStep_s).openings);
    const PerJoint& angles = fake.belief.angles_rad;
    const double pitch_rad = angles[boom] + angles[stick] + angles[bucket];
    const bool loaded = cycle.phase() == Phase::swing_to_truck || cycle.phase() == Phase::dump;
    if (loaded && pitch_rad > -160.0 * kDegree) {
      EXPECT_GT(arm_shape(fake.machine, angles).tip.x_m, kSide_m) << pitch_rad / kDegree;
      EXPECT_NEAR(angles[swing], 90.0 * kDegree, 5.0 * kDegree);
    }
  }
  EXPECT_EQ(cycle.completed(), 2U);
}

// What the boom bears, of a bucket that weighs nothing.
TEST(DigCycleCycle, EmptyBucketsAreNotCarriedToTheTruckAndThePitEnds) {
  FakeMachine fake;
  Cycle cycle(fake.machine, {.dig_sector_rad = 10.0 * kDegree});
  View weightless = seen(0.0);
  weightless.boom_force_n = 250e3;
  const Trace trace = run(cycle, fake, weightless, 600.0);
  EXPECT_EQ(std::ranges::count(trace.phases, Phase::swing_to_truck), 0);
  EXPECT_EQ(std::ranges::count(trace.phases, Phase::dig), 3 * Lanes::kMostPoor);
  ASSERT_TRUE(cycle.finished().has_value());
  EXPECT_THAT(*cycle.finished(), ::testing::HasSubstr("the pit is empty"));
}

// A rock in the way ended the run, or held the bucket for ever.
TEST(DigCycleCycle, LaneThatKeepsTheBucketOutIsLeftForTheNext) {
  FakeMachine fake;
  fake.belief.angles_rad[swing] = 0.0;
  fake.belief.angles_rad[boom] = 50.0 * kDegree;
  Cycle cycle(fake.machine, {.cycles = 1});
  double seconds = 0.0;
  double dug_at_rad = 0.0;
  while (!cycle.done() && !cycle.fault() && seconds < 200.0) {
    FakeMachine before = fake;
    fake.move(cycle.update(fake.belief, seen(0.0), kStep_s).openings);
    const double tip_m = arm_shape(fake.machine, fake.belief.angles_rad).tip.z_m;
    if (std::abs(fake.belief.angles_rad[swing]) < 4.0 * kDegree && tip_m < 1.5 &&
        tip_m < arm_shape(fake.machine, before.belief.angles_rad).tip.z_m) {
      fake = before;  // the rock
    }
    if (cycle.phase() == Phase::dig) {
      dug_at_rad = fake.belief.angles_rad[swing];
    }
    seconds += kStep_s;
  }
  EXPECT_EQ(cycle.completed(), 1U) << cycle.fault().value_or("");
  EXPECT_NEAR(std::abs(dug_at_rad), 9.0 * kDegree, 3.0 * kDegree);
}

TEST(DigCycleCycle, RefusesADigBeyondTheArmsReach) {
  EXPECT_THROW(Cycle(Machine{}, {.dig_start_radius_m = 9.5}), std::invalid_argument);
  EXPECT_THROW(Cycle(Machine{}, {.dig_duration_s = 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::dig_cycle
