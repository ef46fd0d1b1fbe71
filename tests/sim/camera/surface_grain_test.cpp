#include "sim/camera/surface_grain.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/random.h"

namespace rigwire::sim {
namespace {

GrainPoints points_at(RandomStream& random, float footprint_m, float reach_m = 20.0F) {
  GrainPoints points;
  for (std::size_t i = 0; i < kLanes; ++i) {
    points.x[i] = static_cast<float>(random.uniform(-1.0, 1.0)) * reach_m;
    points.y[i] = static_cast<float>(random.uniform(-1.0, 1.0)) * reach_m;
    points.z[i] = static_cast<float>(random.uniform(-1.0, 1.0)) * reach_m;
    points.frequency_pm[i] = 0.5F;
    points.footprint_m[i] = footprint_m;
    points.upright[i] = 1.0F;
    points.persistence[i] = 1.0F;
  }
  return points;
}

GrainAnchor anchor_at(const Eigen::Vector3d& anchor_m, double frequency_pm) {
  GrainAnchor anchor;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    anchor.set(lane, anchor_m, frequency_pm);
  }
  return anchor;
}

TEST(SurfaceGrain, EndsAtThePixel) {
  RandomStream random(1, "grain");
  const GrainAnchor anchor = anchor_at(Eigen::Vector3d::Zero(), 0.5);
  const auto square = [&](float footprint_m) {
    double sum = 0.0;
    for (int i = 0; i < 500; ++i) {
      Grain grain;
      sum_grain(points_at(random, footprint_m), anchor, grain);
      for (const float value : grain.brightness) {
        EXPECT_TRUE(std::isfinite(value));
        sum += static_cast<double>(value * value) / (500.0 * kLanes);
      }
    }
    return sum;
  };
  // The coarsest cell is 2 m; beyond that of a pixel there is nothing.
  EXPECT_EQ(square(2.7F), 0.0);
  // Each octave down to the pixel adds as much again.
  const double one = square(1.3F);
  EXPECT_GT(one, 0.02);
  EXPECT_NEAR(square(0.65F) / one, 2.0, 0.3);
  EXPECT_NEAR(square(0.1625F) / one, 4.0, 0.5);
}

TEST(SurfaceGrain, DoesNotDependOnWhereTheLocalOriginIs) {
  RandomStream random(2, "grain");
  for (int i = 0; i < 50; ++i) {
    const GrainPoints points = points_at(random, 0.05F);
    const Eigen::Vector3d place(1e6 + 37.0, -4e5 - 11.0, 230.0);
    Grain here;
    sum_grain(points, anchor_at(place, 0.5), here);
    GrainPoints shifted = points;
    for (std::size_t k = 0; k < kLanes; ++k) {
      shifted.x[k] -= 12.0F;
      shifted.y[k] += 5.0F;
    }
    Grain there;
    sum_grain(shifted, anchor_at(place + Eigen::Vector3d(12.0, -5.0, 0.0), 0.5), there);
    for (std::size_t k = 0; k < kLanes; ++k) {
      EXPECT_NEAR(here.brightness[k], there.brightness[k], 2e-3);
      EXPECT_NEAR(here.patch[k], there.patch[k], 1e-4);
    }
  }
}

TEST(SurfaceGrain, SlopeIsTheGradientOfItsOctaves) {
  RandomStream random(3, "grain");
  const GrainAnchor anchor = anchor_at({0.3, 0.7, 0.1}, 0.5);
  // One octave of relief is left (the third; coarser ones have none): cells of 0.5 m.
  constexpr float kFootprint_m = 0.3335F;
  constexpr float kStep_m = 2e-3F;
  for (int i = 0; i < 50; ++i) {
    const GrainPoints points = points_at(random, kFootprint_m, 2.0F);
    Grain grain;
    sum_grain(points, anchor, grain);
    const auto by_axis = [&](LaneArray GrainPoints::*axis) {
      // The third octave alone: all that a pixel twice as wide does not see.
      const auto third = [&](float offset) {
        GrainPoints moved = points;
        for (float& value : moved.*axis) {
          value += offset;
        }
        Grain with;
        sum_grain(moved, anchor, with);
        for (float& footprint : moved.footprint_m) {
          footprint = 2.0F * kFootprint_m;
        }
        Grain without;
        sum_grain(moved, anchor, without);
        LaneArray difference;
        for (std::size_t k = 0; k < kLanes; ++k) {
          difference[k] = with.brightness[k] - without.brightness[k];
        }
        return difference;
      };
      const LaneArray after = third(kStep_m);
      const LaneArray before = third(-kStep_m);
      LaneArray slope;
      for (std::size_t k = 0; k < kLanes; ++k) {
        // Slopes count in cells.
        slope[k] = (after[k] - before[k]) / (2.0F * kStep_m) * 0.5F;
      }
      return slope;
    };
    const LaneArray x = by_axis(&GrainPoints::x);
    const LaneArray y = by_axis(&GrainPoints::y);
    const LaneArray z = by_axis(&GrainPoints::z);
    for (std::size_t k = 0; k < kLanes; ++k) {
      EXPECT_NEAR(grain.slope_x[k], x[k], 0.01);
      EXPECT_NEAR(grain.slope_y[k], y[k], 0.01);
      EXPECT_NEAR(grain.slope_z[k], z[k], 0.01);
    }
  }
}

LaneArray density_of(float share) {
  LaneArray density;
  density.fill(share);
  return density;
}

TEST(SurfaceStones, EndAtThePixel) {
  RandomStream random(4, "stones");
  const StoneAnchor anchor(Eigen::Vector3d::Zero());
  const auto covered = [&](float footprint_m) {
    double sum = 0.0;
    for (int i = 0; i < 500; ++i) {
      Stones stones;
      lay_stones(points_at(random, footprint_m), anchor, density_of(1.0F), stones);
      for (std::size_t k = 0; k < kLanes; ++k) {
        EXPECT_GE(stones.share[k], 0.0F);
        EXPECT_LE(stones.share[k], 1.0F);
        EXPECT_GT(stones.gap[k], 0.0F);
        sum += static_cast<double>(stones.share[k]) / (500.0 * kLanes);
      }
    }
    return sum;
  };
  // The coarsest cells are 0.8 m; 2.5 pixels of 0.32 m.
  EXPECT_EQ(covered(0.33F), 0.0);
  const double coarse = covered(0.05F);
  EXPECT_GT(coarse, 0.002);
  EXPECT_GT(covered(0.002F), 3.0 * coarse);
}

TEST(SurfaceStones, AreNotCutByTheirCells) {
  // On the way along a line the share never jumps: no stone reaches over the edge of its cell.
  const StoneAnchor anchor({12.3, -4.5, 6.7});
  constexpr float kStep_m = 1e-4F;
  float before = -1.0F;
  float greatest = 0.0F;
  float most = 0.0F;
  for (int i = 0; i < 60000; i += static_cast<int>(kLanes)) {
    GrainPoints points{};
    for (std::size_t k = 0; k < kLanes; ++k) {
      points.x[k] = kStep_m * static_cast<float>(i + static_cast<int>(k));
      points.y[k] = 0.31F * points.x[k];
      points.z[k] = 0.1F;
      points.footprint_m[k] = 0.01F;
    }
    Stones stones;
    lay_stones(points, anchor, density_of(1.0F), stones);
    for (const float share : stones.share) {
      greatest = before < 0.0F ? 0.0F : std::max(greatest, std::abs(share - before));
      most = std::max(most, share);
      before = share;
    }
  }
  EXPECT_GT(most, 0.9F);
  EXPECT_LT(greatest, 0.1F);
}

TEST(SurfaceStones, LieWhereverTheLocalOriginIs) {
  RandomStream random(5, "stones");
  double apart = 0.0;
  double covered = 0.0;
  for (int i = 0; i < 200; ++i) {
    const GrainPoints points = points_at(random, 0.02F);
    const Eigen::Vector3d place(1e6 + 37.0, -4e5 - 11.0, 230.0);
    Stones here;
    lay_stones(points, StoneAnchor(place), density_of(1.0F), here);
    GrainPoints shifted = points;
    for (std::size_t k = 0; k < kLanes; ++k) {
      shifted.x[k] -= 12.0F;
      shifted.y[k] += 5.0F;
    }
    Stones there;
    lay_stones(shifted, StoneAnchor(place + Eigen::Vector3d(12.0, -5.0, 0.0)), density_of(1.0F),
               there);
    for (std::size_t k = 0; k < kLanes; ++k) {
      apart += static_cast<double>(std::abs(here.share[k] - there.share[k]));
      covered += static_cast<double>(here.share[k]);
    }
  }
  EXPECT_GT(covered, 20.0);
  EXPECT_LT(apart, 0.01 * covered);
}

TEST(SurfaceStones, AreThereOnlyWhereTheGroundHasSome) {
  RandomStream random(6, "stones");
  LaneArray density = density_of(0.0F);
  density[3] = 1.0F;
  float sum = 0.0F;
  for (int i = 0; i < 300; ++i) {
    Stones stones;
    lay_stones(points_at(random, 0.01F), StoneAnchor(Eigen::Vector3d::Zero()), density, stones);
    for (std::size_t k = 0; k < kLanes; ++k) {
      if (k != 3) {
        ASSERT_EQ(stones.share[k], 0.0F);
        ASSERT_EQ(stones.gap[k], 1.0F);
        ASSERT_EQ(stones.slope_z[k], 0.0F);
      }
    }
    sum += stones.share[3];
  }
  EXPECT_GT(sum, 3.0F);
}

}  // namespace
}  // namespace rigwire::sim
