#include "dig_cycle/surroundings.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigwire::dig_cycle {
namespace {

class DigCycleSurroundings : public ::testing::Test {
 protected:
  /// A point of the upper structure's frame, as the sensor on its mount reports it.
  void see(double x_m, double y_m, double z_m) {
    surroundings.add({x_m - mount.x_m, y_m - mount.y_m, z_m - mount.z_m}, arm);
  }
  void see_ground(double z_m) {
    for (double x_m = 4.0; x_m < 12.0; x_m += 0.2) {
      for (double y_m = -3.0; y_m <= 3.0; y_m += 0.2) {
        see(x_m, y_m, z_m);
      }
    }
  }
  LidarMount mount{1.2, 0.8, 3.35, 0.0, 0.0};
  Surroundings surroundings{SurroundingsSettings{.mount = mount}};
  ArmShape arm = arm_shape(Machine{}, {0.0, 56.0 * kDegree, -95.0 * kDegree, -105.0 * kDegree});
};

TEST_F(DigCycleSurroundings, GroundAheadIsWhereItIs) {
  see_ground(-0.7);
  surroundings.finish_revolution();
  ASSERT_TRUE(surroundings.view().ground_z_m.has_value());
  EXPECT_NEAR(*surroundings.view().ground_z_m, -0.7, 1e-9);
}

TEST_F(DigCycleSurroundings, TooFewPointsSayNothing) {
  see(7.0, 0.0, 0.0);
  surroundings.finish_revolution();
  EXPECT_FALSE(surroundings.view().ground_z_m.has_value());
  see_ground(0.0);
  surroundings.finish_revolution();
  EXPECT_TRUE(surroundings.view().ground_z_m.has_value());
  surroundings.finish_revolution();
  EXPECT_FALSE(surroundings.view().ground_z_m.has_value()) << "an old answer was kept";
}

TEST_F(DigCycleSurroundings, OwnArmIsNeitherGroundNorNearest) {
  for (double share = 0.0; share < 1.0; share += 0.01) {
    see(std::lerp(arm.foot.x_m, arm.stick_pin.x_m, share), 0.2,
        std::lerp(arm.foot.z_m, arm.stick_pin.z_m, share));
    see(std::lerp(arm.bucket_pin.x_m, arm.tip.x_m, share), -0.4,
        std::lerp(arm.bucket_pin.z_m, arm.tip.z_m, share));
  }
  surroundings.finish_revolution();
  EXPECT_FALSE(surroundings.nearest_range_m().has_value());
  see(8.0, 0.0, 0.0);
  surroundings.finish_revolution();
  ASSERT_TRUE(surroundings.nearest_range_m().has_value());
  EXPECT_NEAR(*surroundings.nearest_range_m(), std::hypot(8.0 - mount.x_m, mount.y_m, mount.z_m),
              1e-9);
}

TEST_F(DigCycleSurroundings, PoleBesideTheBucketIsAnObstacleOnItsSide) {
  for (double z_m = 0.0; z_m < 6.0; z_m += 0.1) {
    see(4.8 * std::cos(20.0 * kDegree), 4.8 * std::sin(20.0 * kDegree), z_m);
  }
  surroundings.finish_revolution();
  EXPECT_TRUE(surroundings.view().obstacle_left);
  EXPECT_FALSE(surroundings.view().obstacle_right);
}

TEST_F(DigCycleSurroundings, WhatTheBucketClearsIsNoObstacle) {
  for (double z_m = 0.0; z_m < 3.0; z_m += 0.05) {  // a truck's side, the bucket is at 4 m
    see(4.8 * std::cos(20.0 * kDegree), -4.8 * std::sin(20.0 * kDegree), z_m);
  }
  for (double z_m = 0.0; z_m < 8.0; z_m += 0.05) {  // a wall beyond the bucket's circle
    see(7.5 * std::cos(20.0 * kDegree), -7.5 * std::sin(20.0 * kDegree), z_m);
  }
  surroundings.finish_revolution();
  EXPECT_FALSE(surroundings.view().obstacle_left);
  EXPECT_FALSE(surroundings.view().obstacle_right);
}

TEST(DigCycleSurroundingsMount, PitchAndYawOfTheMountAreTakenOut) {
  SurroundingsSettings settings;
  settings.mount = {.x_m = 0.0, .y_m = 0.0, .z_m = 3.0, .yaw_rad = 0.5, .pitch_rad = -0.4};
  Surroundings surroundings(settings);
  const ArmShape arm = arm_shape(Machine{}, {0.0, 56.0 * kDegree, -75.0 * kDegree, 0.0});
  for (double x_m = 6.0; x_m < 8.0; x_m += 0.05) {
    // (x, 1, 0.2) of the upper structure, turned into the sensor's frame step by step.
    const double ahead_m = x_m * std::cos(0.5) + 1.0 * std::sin(0.5);
    const double left_m = -x_m * std::sin(0.5) + 1.0 * std::cos(0.5);
    const double up_m = 0.2 - 3.0;
    surroundings.add({ahead_m * std::cos(-0.4) + up_m * std::sin(-0.4), left_m,
                      -ahead_m * std::sin(-0.4) + up_m * std::cos(-0.4)},
                     arm);
  }
  surroundings.finish_revolution();
  ASSERT_TRUE(surroundings.view().ground_z_m.has_value());
  EXPECT_NEAR(*surroundings.view().ground_z_m, 0.2, 1e-9);
}

}  // namespace
}  // namespace rigwire::dig_cycle
