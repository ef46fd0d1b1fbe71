#include "dig_cycle/machine.h"

#include <gtest/gtest.h>

namespace rigwire::dig_cycle {
namespace {

TEST(DigCycleMachine, StretchedArmReachesTheSumOfItsLinks) {
  const ArmShape shape = arm_shape(Machine{}, {0.0, 0.0, 0.0, 0.0});
  EXPECT_NEAR(shape.tip.x_m, 0.30 + 5.00 + 2.45 + 1.40, 1e-12);
  EXPECT_NEAR(shape.tip.z_m, 2.10, 1e-12);
}

TEST(DigCycleMachine, AnglesAddUpAlongTheChainPositiveUp) {
  // Boom straight up, stick level forward, bucket straight down.
  const ArmShape shape =
      arm_shape(Machine{}, {0.0, 90.0 * kDegree, -90.0 * kDegree, -90.0 * kDegree});
  EXPECT_NEAR(shape.bucket_pin.x_m, 0.30 + 2.45, 1e-12);
  EXPECT_NEAR(shape.bucket_pin.z_m, 2.10 + 5.00, 1e-12);
  EXPECT_NEAR(shape.tip.z_m, 2.10 + 5.00 - 1.40, 1e-12);
}

TEST(DigCycleMachine, ReachIsTheInverseOfTheShape) {
  const Machine machine;
  int reached = 0;
  for (double x_m = 3.5; x_m < 8.5; x_m += 0.25) {
    for (double z_m = -1.5; z_m < 3.0; z_m += 0.25) {
      for (const double bucket_deg : {-105.0, -60.0, -20.0, 25.0}) {
        const auto angles = reach(machine, {x_m, z_m}, bucket_deg * kDegree);
        if (!angles) {
          continue;
        }
        ++reached;
        const ArmShape shape = arm_shape(machine, *angles);
        ASSERT_NEAR(shape.tip.x_m, x_m, 1e-9);
        ASSERT_NEAR(shape.tip.z_m, z_m, 1e-9);
        ASSERT_GE((*angles)[stick], machine.lower_rad[stick]);
        ASSERT_LE((*angles)[stick], machine.upper_rad[stick]);
      }
    }
  }
  EXPECT_GT(reached, 300);
}

TEST(DigCycleMachine, OutOfReachAndBeyondStopsGiveNothing) {
  EXPECT_FALSE(reach(Machine{}, {12.0, 0.0}, 0.0));
  EXPECT_FALSE(reach(Machine{}, {0.3, 2.1}, 0.0));
  EXPECT_FALSE(reach(Machine{}, {9.1, 2.1}, 0.0))
      << "stretched needs a stick at 0, its stop is -30";
  EXPECT_FALSE(reach(Machine{}, {6.0, 0.0}, 60.0 * kDegree)) << "bucket beyond its stop";
}

}  // namespace
}  // namespace rigwire::dig_cycle
