#include "sim/excavator/bucket_soil.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "allocation_counter.h"
#include "digging_site.h"
#include "sim/excavator/digging_excavator.h"

namespace rigwire::sim {
namespace {

using namespace test;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(BucketCapacity, LevelBucketHoldsStruckPlusRoofAndTheInvertedNothing) {
  const BucketSoilParameters parameters;
  const BucketCapacity capacity(parameters, 1.40);
  EXPECT_NEAR(capacity.heaped_m3(),
              0.55 + 0.25 * 1.15 * 1.15 * std::tan(parameters.heap_repose_rad) * 1.10, 1e-12);
  const double pi = std::numbers::pi;
  EXPECT_NEAR(capacity.held_m3(pi), capacity.heaped_m3(), 0.01 * capacity.heaped_m3());
  EXPECT_EQ(capacity.held_m3(0.0), 0.0);
  EXPECT_EQ(capacity.held_m3(0.2), 0.0);
  EXPECT_EQ(capacity.held_m3(std::nan("")), 0.0);
  EXPECT_NEAR(capacity.held_m3(pi), capacity.held_m3(-pi), 1e-9);
  EXPECT_NEAR(capacity.held_m3(pi + 0.3), capacity.held_m3(0.3 - pi), 1e-9);
  double before = capacity.held_m3(pi);
  for (double tilt = 0.0; tilt < 1.5; tilt += 0.02) {  // Tipping over the teeth.
    const double held = capacity.held_m3(pi + tilt);
    EXPECT_LE(held, before + 0.015) << tilt;
    before = held;
  }
}

TEST(BucketSoil, ForceActsAgainstTheWayForwardAndVanishesOnTheWayBackAndAtRest) {
  Ground ground = sandy();
  DiggableTerrain terrain(ground, {});
  // Teeth down, opening towards -x, lip 0.5 m deep.
  const double pitch = -0.5 * std::numbers::pi;
  BucketSoil bucket({}, 1.40, kGravity, terrain, bucket_at(5.0, 0.9, pitch));
  const BucketGroundLoad load = bucket.load(1e-3, bucket_at(5.0, 0.9, pitch));
  EXPECT_NEAR(bucket.depth_m(), 0.5, 1e-9);
  ASSERT_GT(bucket.resistance_limit_n(), 3000.0);
  const auto force = [&](const Vector3d& v_W) {
    Vector3d sum = load.force_W;
    for (std::size_t i = 0; i < load.count; ++i) {
      const TipResistance& each = load.resistances[i];
      sum += std::clamp(each.offset_n - each.gain_nspm * v_W.dot(each.direction_W), -each.limit_n,
                        each.limit_n) *
             each.direction_W;
    }
    return sum;
  };
  const double tiny = 1e-6 * bucket.resistance_limit_n();
  EXPECT_LT(force(Vector3d::Zero()).norm(), tiny);
  EXPECT_LT(force({0.3, 0.0, 0.0}).norm(), tiny);
  EXPECT_LT(force({0.3, 0.0, 0.4}).norm(), tiny);
  EXPECT_NEAR(force({-0.3, 0.0, 0.0}).x(), bucket.resistance_limit_n(), tiny);
  EXPECT_GT(force({0.0, 0.0, -0.3}).z(), 1000.0);
  EXPECT_LT(force({0.0, 0.2, 0.0}).y(), -1000.0);
  EXPECT_GT(force({0.0, -0.2, 0.0}).y(), 1000.0);
  for (int i = 0; i < 200; ++i) {  // Passive whatever the motion.
    const Vector3d v(0.5 * std::sin(1.0 * i), 0.3 * std::sin(2.3 * i), 0.4 * std::sin(3.7 * i));
    EXPECT_LE(force(v).dot(v), 1e-9 * bucket.resistance_limit_n());
  }
}

TEST(BucketSoil, OutOfTheGroundThereIsNoForce) {
  Ground ground = sandy();
  DiggableTerrain terrain(ground, {});
  BucketSoil bucket({}, 1.40, kGravity, terrain, bucket_at(5.0, 2.0, -1.5));
  const BucketGroundLoad load = bucket.load(1e-3, bucket_at(5.0, 2.0, -1.5));
  EXPECT_EQ(load.count, 0u);
  EXPECT_TRUE(load.force_W.isZero(0.0));
}

TEST(BucketSoil, NotANumberChangesNothing) {
  Ground ground = sandy();
  DiggableTerrain terrain(ground, {});
  BucketSoil bucket({}, 1.40, kGravity, terrain, bucket_at(5.0, 0.9, -1.5));
  LinkMotion broken = bucket_at(std::nan(""), 0.9, -1.5);
  bucket.advance(1e-3, broken);
  EXPECT_EQ(bucket.load(1e-3, broken).count, 0u);
  broken = bucket_at(4.0, 0.9, -1.5);
  bucket.advance(std::nan(""), broken);
  EXPECT_EQ(bucket.units(), 0);
  EXPECT_EQ(terrain.gained_units(), 0);
}

TEST(BucketSoil, EmptyingTakesTheOutflowTimeAndLeavesNoRest) {
  Ground ground = sandy(0.2);
  DiggableTerrain terrain(ground, {});
  const LinkMotion upside_down = bucket_at(5.0, 4.0, 0.3);
  BucketSoil bucket({}, 1.40, kGravity, terrain, upside_down);
  bucket.fill(0.6, 1000.0);
  const std::int64_t full = bucket.units();
  for (int i = 0; i < 350; ++i) {
    bucket.advance(1e-3, upside_down);
  }
  EXPECT_NEAR(static_cast<double>(bucket.units()) / static_cast<double>(full), std::exp(-1.0),
              0.04);
  EXPECT_NEAR(bucket.mass_kg(),
              1000.0 * static_cast<double>(bucket.units()) / static_cast<double>(full), 1e-6);
  for (int i = 0; i < 3000; ++i) {
    bucket.advance(1e-3, upside_down);
  }
  EXPECT_EQ(bucket.units(), 0);
  EXPECT_EQ(bucket.mass_kg(), 0.0);
  EXPECT_EQ(terrain.gained_units(), full);
}

TEST(BucketSoil, SoilThatFallsIntoATruckIsCountedElsewhere) {
  struct Truck final : FallObstacle {
    [[nodiscard]] bool catches(const Vector3d& from_W, double terrain_m) const override {
      return from_W.z() > 2.0 && terrain_m < 2.0;
    }
  } truck;
  Ground ground = sandy();
  DiggableTerrain terrain(ground, {});
  BucketSoil bucket({}, 1.40, kGravity, terrain, bucket_at(5.0, 4.0, 0.3));
  bucket.set_fall_obstacle(&truck);
  bucket.fill(0.6, 1000.0);
  const std::int64_t full = bucket.units();
  for (int i = 0; i < 4000; ++i) {
    bucket.advance(1e-3, bucket_at(5.0, 4.0, 0.3));
  }
  EXPECT_EQ(bucket.units(), 0);
  EXPECT_EQ(bucket.elsewhere_units(), 0);  // What fill() owed is paid.
  EXPECT_EQ(terrain.gained_units(), 0);
  EXPECT_GT(full, 0);
}

TEST(BucketSoil, BadParametersAreRefusedByName) {
  BucketSoilParameters parameters;
  parameters.width_m = 0.0;
  EXPECT_THAT(
      [&] { validate(parameters, 1.4); },
      ThrowsMessage<std::invalid_argument>(HasSubstr("width: found 0 m, allowed 0.001 .. 20 m")));
  parameters = {};
  parameters.rear_lip_m = 1.39;
  EXPECT_THAT(
      [&] { validate(parameters, 1.4); },
      ThrowsMessage<std::invalid_argument>(HasSubstr("rear_lip: found 1.39 m, allowed at most")));
  parameters = {};
  parameters.outflow_time_s = std::nan("");
  EXPECT_THAT([&] { validate(parameters, 1.4); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("outflow_time: found nan")));
}

}  // namespace
}  // namespace rigwire::sim
