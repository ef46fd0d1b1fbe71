#include "protocols/ubx/precise_position.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace rigwire::protocols::ubx {
namespace {

TEST(UbxPrecisePosition, RestHasTheSignOfTheWhole) {
  EXPECT_EQ(split_angle(8.123456789), (SplitAngle{81'234'567, 89}));
  EXPECT_EQ(split_angle(-8.123456789), (SplitAngle{-81'234'567, -89}));
  EXPECT_EQ(split_angle(-0.000000099), (SplitAngle{0, -99}));
  EXPECT_EQ(split_angle(180.0), (SplitAngle{1'800'000'000, 0}));
  EXPECT_EQ(split_angle(-180.0), (SplitAngle{-1'800'000'000, 0}));
  EXPECT_EQ(split_angle(-4e-10), (SplitAngle{0, 0}));
  EXPECT_EQ(split_height(-1.2349), (SplitHeight{-1234, -9}));
  EXPECT_EQ(split_coordinate(6'378'137.1299), (SplitCoordinate{637'813'712, 99}));
}

TEST(UbxPrecisePosition, CarriesIntoTheCoarseNumber) {
  EXPECT_EQ(split_angle(89.99999999996), (SplitAngle{900'000'000, 0}));
  EXPECT_EQ(split_height(0.99996), (SplitHeight{1000, 0}));
}

TEST(UbxPrecisePosition, WithinHalfAUnitEverywhere) {
  std::mt19937_64 random(20260601);
  std::uniform_real_distribution<double> angle(-180.0, 180.0);
  std::uniform_real_distribution<double> height(-500.0, 50'000.0);
  std::uniform_real_distribution<double> coordinate(-6.4e6, 6.4e6);
  for (int i = 0; i < 20'000; ++i) {
    const double angle_deg = angle(random);
    const auto split = split_angle(angle_deg);
    ASSERT_LE(std::abs(split.rest_e9deg), 99);
    ASSERT_NEAR(join(split), angle_deg, 0.5e-9 + 1e-12);
    const double height_m = height(random);
    ASSERT_LE(std::abs(split_height(height_m).rest_e4m), 9);
    ASSERT_NEAR(join(split_height(height_m)), height_m, 0.5e-4 + 1e-9);
    const double coordinate_m = coordinate(random);
    ASSERT_LE(std::abs(split_coordinate(coordinate_m).rest_e4m), 99);
    ASSERT_NEAR(join(split_coordinate(coordinate_m)), coordinate_m, 0.5e-4 + 1e-8);
  }
}

}  // namespace
}  // namespace rigwire::protocols::ubx
