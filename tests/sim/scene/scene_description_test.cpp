#include "sim/scene/scene_description.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace rigwire::sim {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(Pit, FloorIsFlatUnderTheMachineAndTheTruck) {
  const HeightField ground = make_pit({}, 1);
  for (double x = -4.0; x <= 3.5; x += 0.25) {
    for (double y = -4.0; y <= 9.0; y += 0.25) {
      EXPECT_NEAR(ground.height_m(x, y), 0.0, 0.15) << x << ' ' << y;
    }
  }
}

TEST(Pit, HeapAndWorkingFaceStandWithinTheReachOfTheBoom) {
  const HeightField ground = make_pit({}, 1);
  EXPECT_NEAR(ground.height_m(6.2, 0.0), 1.6, 0.4);
  EXPECT_GT(ground.height_m(9.0, 3.0), 3.0) << "first bench";
  EXPECT_LT(ground.height_m(6.0, 5.0), 0.5) << "foot of the face";
}

TEST(Pit, BenchesRiseToTheRimAndTheRampCutsThemAtItsSlope) {
  PitTerrain smooth;
  smooth.floor_roughness_m = 0.0;
  smooth.face_roughness_m = 0.0;
  const HeightField ground = make_pit(smooth, 1);
  EXPECT_NEAR(ground.height_m(59.0, 0.0), 12.0, 1e-9);
  EXPECT_NEAR(ground.height_m(-50.0, smooth.ramp_y_m), 20.0 * 0.12, 1e-6);
  EXPECT_NEAR(ground.height_m(-59.0, smooth.ramp_y_m), 29.0 * 0.12, 1e-6);
  EXPECT_GT(ground.height_m(-59.0, smooth.ramp_y_m + 12.0), 6.0);
}

TEST(Pit, SameSeedSameGroundOtherSeedOtherGround) {
  const PitTerrain pit;
  EXPECT_EQ(make_pit(pit, 4).heights_m, make_pit(pit, 4).heights_m);
  EXPECT_NE(make_pit(pit, 4).heights_m, make_pit(pit, 5).heights_m);
}

TEST(Pit, RoughnessHasItsDeviation) {
  const HeightField ground = make_pit({}, 9);
  double sum = 0.0;
  double squares = 0.0;
  double count = 0.0;
  for (double x = -25.0; x < -5.0; x += 0.4) {
    for (double y = -15.0; y < 15.0; y += 0.4) {
      const double height = ground.height_m(x, y);
      sum += height;
      squares += height * height;
      count += 1.0;
    }
  }
  const double deviation = std::sqrt(squares / count - std::pow(sum / count, 2));
  EXPECT_GT(deviation, 0.015);
  EXPECT_LT(deviation, 0.05);
}

TEST(Rocks, LieOnTheGroundOutsideTheKeepOutsWithinTheirSizes) {
  const HeightField ground = make_pit({}, 2);
  RandomStream random(2, "rocks");
  RockField field;
  field.count = 500;
  const auto rocks = place_rocks(field, ground, random);
  EXPECT_GT(rocks.size(), 490U);
  int small = 0;
  for (const PlacedRock& rock : rocks) {
    const Eigen::Vector3d p = rock.X_WM.translation();
    for (const KeepOut& disc : field.keep_out) {
      EXPECT_GE((p.head<2>() - disc.centre_m).norm(), disc.radius_m + rock.radius_m);
    }
    EXPECT_NEAR(p.z(), ground.height_m(p.x(), p.y()) + 0.3 * rock.radius_m, 1e-9);
    EXPECT_GE(2.0 * rock.radius_m, field.smallest_m * 0.999);
    EXPECT_LE(2.0 * rock.radius_m, field.largest_m * 1.001);
    small += 2.0 * rock.radius_m < 2.0 * field.smallest_m ? 1 : 0;
  }
  // Share below twice the smallest, by the power law cut at both ends.
  const double power = 1.0 - field.exponent;
  const double share =
      (1.0 - std::pow(2.0, power)) / (1.0 - std::pow(field.largest_m / field.smallest_m, power));
  EXPECT_NEAR(small / static_cast<double>(rocks.size()), share, 0.08);
}

TEST(Rocks, ShapesAreClosedAndOfUnitSize) {
  RandomStream random(3, "shape");
  const TriangleMesh rock = make_rock("rock", random);
  validate(rock);
  EXPECT_EQ(rock.vertices.size(), 162U);
  ASSERT_EQ(rock.triangles.size(), 320U);  // Euler: V - E + F = 2 with E = 3 F / 2
  double volume = 0.0;
  for (const auto& [a, b, c] : rock.triangles) {
    volume += rock.vertices[a].dot(rock.vertices[b].cross(rock.vertices[c])) / 6.0;
  }
  EXPECT_GT(volume, 1.0) << "facing outwards";
  for (const auto& vertex : rock.vertices) {
    EXPECT_LE(vertex.norm(), 1.0F + 1e-6F);
    EXPECT_GE(vertex.norm(), 0.55F);
  }
}

TEST(BuildScene, HoldsGroundRocksAndObjectsWithLabels) {
  SceneDescription description;
  description.rocks.emplace_back().count = 10;
  FixedObject truck;
  truck.name = "haul_truck";
  truck.mesh = "truck";
  truck.position_m = {-1.0, 7.0, 0.0};
  truck.yaw_rad = 0.5 * std::numbers::pi;
  truck.material = {.reflectance = 0.6, .label = "truck"};
  description.objects.push_back(truck);
  const BuiltScene built = build_scene(description, {make_box("truck", {8.0, 3.0, 4.0})}, 1);
  ASSERT_EQ(built.scene->instance_count(), 12U);
  built.scene->begin_slice(kStart, kStart + Duration{1000}, Eigen::Vector3d::Zero(), {});
  const auto hit = built.scene->cast({-1.0, 0.0, 1.0}, Eigen::Vector3d::UnitY(), 0.1, 50.0, kStart);
  ASSERT_TRUE(hit.has_value());
  EXPECT_NEAR(hit->range_m, 3.0, 1e-5) << "long side turned along y";
  EXPECT_EQ(built.scene->material(hit->instance).label, "truck");
}

TEST(BuildScene, BoxesThatAreNotSolidAreSeenAndNeitherRunIntoNorPlantedAround) {
  SceneDescription description;
  description.terrain = LevelTerrain{};
  TreeField& trees = description.trees.emplace_back();
  trees.count = 200;
  const BuiltScene without = build_scene(description, {}, 1);
  BoxObject& sign = description.boxes.emplace_back();
  sign.name = "sign";
  sign.size_m = {0.02, 0.6, 0.6};
  sign.position_m = {5.0, 0.0, 1.0};
  sign.solid = false;
  sign.material = {.reflectance = 0.6, .label = "sign", .retro_gain = 0.3};
  const BuiltScene with = build_scene(description, {}, 1);
  ASSERT_EQ(with.obstacles.size(), without.obstacles.size());
  for (std::size_t i = 0; i < with.obstacles.size(); ++i) {
    EXPECT_TRUE(with.obstacles[i].X_WO.isApprox(without.obstacles[i].X_WO)) << i;
  }
  with.scene->begin_slice(kStart, kStart + Duration{1000}, Eigen::Vector3d::Zero(), {});
  const double height_m = with.ground.height_m(5.0, 0.0) + 1.3;
  const auto hit =
      with.scene->cast({4.0, 0.0, height_m}, Eigen::Vector3d::UnitX(), 0.1, 5.0, kStart);
  ASSERT_TRUE(hit.has_value());
  EXPECT_EQ(with.scene->material(hit->instance).retro_gain, 0.3);
}

TEST(BuildScene, MissingMeshIsNamed) {
  SceneDescription description;
  FixedObject object;
  object.name = "haul_truck";
  object.mesh = "truk";
  description.objects.push_back(object);
  EXPECT_THAT(
      [&] {
        (void)build_scene(description, {make_box("truck", {1.0, 1.0, 1.0})}, 1);
      },
      ThrowsMessage<std::invalid_argument>(
          HasSubstr("'haul_truck': there is no mesh 'truk'; there are: truck")));
}

TEST(SceneDescription, RefusesNonsenseByName) {
  PitTerrain pit;
  pit.cell_m = 0.0;
  EXPECT_THAT([&] { validate(pit); }, ThrowsMessage<std::invalid_argument>(
                                          HasSubstr("cell: found 0 m, allowed 0.05 .. 400 m")));
  pit = {};
  pit.face_angle_deg = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { validate(pit); }, ThrowsMessage<std::invalid_argument>(HasSubstr(
                                          "face_angle: found nan deg, allowed 20 .. 85 deg")));
  RockField rocks;
  rocks.count = -1;
  EXPECT_THAT([&] { validate(rocks); }, ThrowsMessage<std::invalid_argument>(
                                            HasSubstr("count: found -1, allowed 0 .. 100000")));
}

}  // namespace
}  // namespace rigwire::sim
