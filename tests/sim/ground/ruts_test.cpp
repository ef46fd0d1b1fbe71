#include "sim/ground/ruts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "allocation_counter.h"
#include "sim/ground/ground.h"

namespace rigwire::sim {
namespace {

using Place = Eigen::Vector2d;

TEST(Ruts, AWheelFindsItsOwnDepthUnderItInEveryDirection) {
  for (int i = 0; i < 360; i += 7) {
    const double angle = i * M_PI / 180.0;
    for (const double at : {0.0, 0.013, -0.049, 1e6 + 0.07}) {
      Ruts ruts(64);
      const Place place(at, -at);
      ruts.press(place, {std::cos(angle), std::sin(angle)}, 0.0, 0.0, 0.08);
      EXPECT_NEAR(ruts.depth_m(place), 0.08, 1e-8) << i << " " << at;
      // What lies ahead by the least reach of a footing is untouched.
      EXPECT_EQ(ruts.depth_m(place + 0.3 * Place(std::cos(angle), std::sin(angle))), 0.0);
    }
  }
}

TEST(Ruts, OnlyGetDeeperAndGoWithTheDiggedGround) {
  Ruts ruts(64);
  ruts.press({1.0, 1.0}, Place::UnitX(), 0.15, 0.2, 0.08);
  ruts.press({1.0, 1.0}, Place::UnitX(), 0.15, 0.2, 0.05);
  EXPECT_NEAR(ruts.depth_m({1.0, 1.0}), 0.08, 1e-8);
  ruts.forget({0.0, 0.0}, {0.95, 2.0});
  EXPECT_NEAR(ruts.depth_m({1.05, 1.0}), 0.08, 1e-8);
  ruts.forget({0.0, 0.0}, {2.0, 2.0});
  EXPECT_EQ(ruts.depth_m({1.0, 1.0}), 0.0);
}

TEST(Ruts, MemoryIsBoundedAndTheOldestIsForgottenFirst) {
  Ruts ruts(8);
  for (int i = 0; i < 100; ++i) {
    ruts.press({3.2 * i + 0.8, 0.8}, Place::UnitX(), 0.15, 0.15, 0.01 * (i + 1));
    EXPECT_LE(ruts.pages(), 8u);
    for (int back = 0; back < 8 && back <= i; ++back) {
      EXPECT_NEAR(ruts.depth_m({3.2 * (i - back) + 0.8, 0.8}), 0.01 * (i - back + 1), 1e-6);
    }
    if (i >= 8) {
      EXPECT_EQ(ruts.depth_m({3.2 * (i - 8) + 0.8, 0.8}), 0.0);
    }
  }
}

TEST(Ruts, ReadContinuously) {
  Ruts ruts(64);
  ruts.press({0.0, 0.0}, {0.6, 0.8}, 0.15, 0.2, 0.1);
  double before = 0.0;
  for (int i = -1000; i <= 1000; ++i) {
    const double now = ruts.depth_m({1e-3 * i, 0.3e-3 * i});
    EXPECT_LT(std::abs(now - before), 3e-3);
    before = now;
  }
}

TEST(Ruts, NoNumberAndNoPageDoNothing) {
  Ruts ruts(4);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ruts.press({nan, 0.0}, Place::UnitX(), 0.15, 0.15, 0.1);
  ruts.press({0.0, 0.0}, Place::UnitX(), 0.15, 0.15, nan);
  ruts.press({1e300, 0.0}, Place::UnitX(), 0.15, 0.15, 0.1);
  EXPECT_EQ(ruts.pages(), 0u);
  EXPECT_EQ(ruts.depth_m({nan, 0.0}), 0.0);
  EXPECT_EQ(ruts.depth_m({1e300, 1e300}), 0.0);
  Ruts none;
  none.press({0.0, 0.0}, Place::UnitX(), 0.15, 0.15, 0.1);
  EXPECT_EQ(none.depth_m({0.0, 0.0}), 0.0);
}

TEST(Ruts, PressingAllocatesNothing) {
  Ruts ruts(16);
  const auto before = rigwire::test::allocations();
  for (int i = 0; i < 1000; ++i) {
    ruts.press({0.3 * i, 0.1 * i}, Place::UnitX(), 0.15, 0.2, 0.1);
  }
  EXPECT_EQ(rigwire::test::allocations(), before);
}

SoilMap halves() {
  SoilMap soils;
  soils.soils.resize(2);
  soils.soils[1].soft = true;
  soils.cells = {0, 1, 0, 1};  // soft beyond x = 0
  return soils;
}

HeightField two_by_two(double cell_m) {
  HeightField field;
  field.origin_m = {-cell_m, -cell_m};
  field.cell_m = cell_m;
  field.columns = field.rows = 3;
  field.heights_m.assign(9, 0.0);
  return field;
}

WheelContact at(double x_m) {
  WheelContact contact;
  contact.point_W.x() = x_m;
  return contact;
}

TEST(Footing, SharesChangeLinearlyOverTheBorder) {
  for (const double cell : {0.2, 0.4, 20.0}) {
    const Ground ground(two_by_two(cell), halves(), {});
    const double half = 0.5 * std::min(0.5, cell);
    for (const double x : {-2.0, -1.0, -0.5, 0.0, 0.3, 1.0, 2.0}) {
      const double expected = std::clamp(0.5 + 0.5 * x, 0.0, 1.0);
      const WheelFooting footing = ground.footing(at(x * half), Eigen::Vector3d::UnitX(), 0.3);
      EXPECT_NEAR(footing.under.whole_share(), expected, 1e-9) << cell << ", " << x;
    }
  }
}

TEST(Footing, StonesAreHardAndShareWithTheSoil) {
  const Ground ground(two_by_two(20.0), halves(), {});
  WheelContact contact = at(5.0);
  contact.terrain_share = 0.25;
  EXPECT_NEAR(ground.footing(contact, Eigen::Vector3d::UnitX(), 0.3).under.whole_share(), 0.25,
              1e-12);
  contact.terrain_share = 0.0;
  EXPECT_EQ(ground.footing(contact, Eigen::Vector3d::UnitX(), 0.3).under.count, 0u);
}

TEST(Footing, DiggingTakesTheRutsAway) {
  Ground ground(two_by_two(20.0), halves(), {});
  ground.press(at(5.0), Eigen::Vector3d::UnitX(), 0.4, 0.1);
  EXPECT_NEAR(ground.ruts().depth_m({5.0, 0.0}), 0.1, 1e-8);
  ground.set_node(1, 1, -0.3);
  EXPECT_EQ(ground.ruts().depth_m({5.0, 0.0}), 0.0);
}

}  // namespace
}  // namespace rigwire::sim
