#include "dig_cycle/lanes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "dig_cycle/load_scale.h"

namespace rigwire::dig_cycle {
namespace {

LaneSettings five_lanes() {
  return {
      .middle_rad = 0.1, .sector_rad = 0.2, .spacing_rad = 0.1, .depth_m = 0.3, .deepest_m = 0.6};
}

TEST(DigCycleLanes, BeginInTheMiddleAndGoOnToTheHighest) {
  Lanes lanes(five_lanes());
  EXPECT_EQ(lanes.count(), 5U);
  EXPECT_EQ(lanes.azimuth_rad(), 0.1);
  lanes.cut(1.0, false);  // a heap: it is the highest still
  ASSERT_TRUE(lanes.next());
  EXPECT_EQ(lanes.azimuth_rad(), 0.1);
  EXPECT_DOUBLE_EQ(lanes.ground_m(1.0), 0.7) << "what it cut itself";
  EXPECT_DOUBLE_EQ(lanes.ground_m(0.4), 0.4) << "what the lidar sees lower";
  lanes.cut(0.2, false);
  ASSERT_TRUE(lanes.next());
  EXPECT_DOUBLE_EQ(lanes.azimuth_rad(), 0.2);
  EXPECT_DOUBLE_EQ(lanes.ground_m(-5.0), -0.3) << "no cut below the deepest";
}

// It went on digging where the buckets came up empty.
TEST(DigCycleLanes, EndWhereBucketsComeUpEmptyWhereBlockedAndAtTheDeepest) {
  Lanes lanes(five_lanes());
  int cuts = 0;
  do {
    ++cuts;
    ASSERT_LT(cuts, 100);
    if (lanes.azimuth_rad() > 0.25) {
      lanes.block();
    } else {
      lanes.cut(lanes.ground_m(0.0), lanes.azimuth_rad() < 0.0);
    }
  } while (lanes.next());
  EXPECT_EQ(lanes.blocked(), 1U);
  // Two cuts of 0.3 m in each of four lanes, one look at the blocked one.
  EXPECT_EQ(cuts, 2 * 4 + 1);
}

TEST(DigCycleLoadScale, WeighsByTheBoomsCylinders) {
  const Machine machine;
  const PerJoint pose{0.0, 0.9, -1.8, -2.1};
  LoadScale scale(machine);
  const auto weigh = [&scale](double force_n) {
    scale.begin();
    for (int i = 0; i < LoadScale::kSamples; ++i) {
      scale.add(force_n);
    }
  };
  weigh(200e3);
  EXPECT_FALSE(scale.load_kg(pose).has_value()) << "without a tare";
  scale.tare();
  // Virtual work: the cylinders' force by the change of their length is the weight by its height.
  const double turn = 1e-6;
  const auto length_m = [&](double boom_rad) {
    const double x = machine.boom_rod_x_m * std::cos(boom_rad) -
                     machine.boom_rod_z_m * std::sin(boom_rad) - machine.boom_base_x_m;
    const double z = machine.boom_rod_x_m * std::sin(boom_rad) +
                     machine.boom_rod_z_m * std::cos(boom_rad) - machine.boom_base_z_m;
    return std::hypot(x, z);
  };
  const auto load_height_m = [&](double boom_rad) {
    const PerJoint angles{0.0, boom_rad, pose[stick], pose[bucket]};
    const double pitch_rad = boom_rad + pose[stick] + pose[bucket];
    return arm_shape(machine, angles).bucket_pin.z_m + machine.load_x_m * std::sin(pitch_rad) +
           machine.load_z_m * std::cos(pitch_rad);
  };
  const double more_n = 1000.0 * 9.80665 *
                        (load_height_m(pose[boom] + turn) - load_height_m(pose[boom] - turn)) /
                        (length_m(pose[boom] + turn) - length_m(pose[boom] - turn));
  weigh(200e3 + more_n);
  ASSERT_TRUE(scale.load_kg(pose).has_value());
  EXPECT_NEAR(*scale.load_kg(pose), 1000.0, 0.1);
  scale.begin();
  EXPECT_FALSE(scale.load_kg(pose).has_value()) << "without samples";
}

}  // namespace
}  // namespace rigwire::dig_cycle
