#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "sim/random.h"
#include "sim/scene/scene.h"
#include "sim/scene/scene_description.h"

namespace rigwire::sim {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr SimTime kSceneSkyT0 = kStart;
constexpr SimTime kSceneSkyT1 = kStart + std::chrono::milliseconds{1};
constexpr double kClearance_m = 0.05;

Isometry3d scene_sky_at(const Vector3d& p) {
  Isometry3d X = Isometry3d::Identity();
  X.translation() = p;
  return X;
}

const Material kLeaves{.reflectance = 0.5, .label = "crown", .foliage = true};
const Material kWall{.reflectance = 0.5, .label = "building"};

/// Two crowns of 4 m east of the origin, the second one half within the first, and a wall behind.
class SceneSky : public testing::Test {
 protected:
  SceneSky() {
    const auto cube = scene.add_mesh(make_box("cube", {4.0, 4.0, 4.0}));
    scene.add_object(cube, scene_sky_at({10.0, 0.0, 0.0}), 1.0, kLeaves);
    scene.add_object(cube, scene_sky_at({12.0, 0.0, 0.0}), 1.0, kLeaves);
    const auto wall = scene.add_mesh(make_box("wall", {1.0, 2.0, 2.0}));
    scene.add_object(wall, scene_sky_at({30.0, 0.0, 0.0}), 1.0, kWall);
    scene.begin_slice(kSceneSkyT0, kSceneSkyT1, Vector3d::Zero(), {});
  }
  Scene scene;
};

TEST_F(SceneSky, OverlappingCrownsAreMeasuredOnce) {
  // Off the middle, where the ray does not run along edges of triangles.
  const SkyPath path = scene.sky_path({0.0, 0.3, 1.2}, Vector3d::UnitX(), kClearance_m);
  EXPECT_FALSE(path.blocked) << "the wall ends at 1 m";
  EXPECT_NEAR(path.foliage_m, 6.0, 1e-4);
}

TEST_F(SceneSky, DiagonalOfTrianglesCountsOnce) {
  // Through the diagonal of the box's faces, where two triangles meet.
  const SkyPath path = scene.sky_path({0.0, 1.5, 1.5}, Vector3d::UnitX(), kClearance_m);
  EXPECT_NEAR(path.foliage_m, 6.0, 1e-3);
}

TEST_F(SceneSky, ARayThatStartsInACrownHasTheRestOfIt) {
  const SkyPath path = scene.sky_path({9.0, 0.3, 1.2}, Vector3d::UnitX(), kClearance_m);
  EXPECT_NEAR(path.foliage_m, 5.0, 1e-4);
  const SkyPath back = scene.sky_path({9.0, 0.3, 1.2}, -Vector3d::UnitX(), kClearance_m);
  EXPECT_NEAR(back.foliage_m, 1.0, 1e-4);
}

TEST_F(SceneSky, FoliageCountsUpToWhatBlocks) {
  const SkyPath path = scene.sky_path({0.0, 0.3, 0.4}, Vector3d::UnitX(), kClearance_m);
  EXPECT_TRUE(path.blocked);
  EXPECT_NEAR(path.foliage_m, 6.0, 1e-4);
  const SkyPath from_behind = scene.sky_path({40.0, 0.3, 0.4}, -Vector3d::UnitX(), kClearance_m);
  EXPECT_TRUE(from_behind.blocked);
  EXPECT_EQ(from_behind.foliage_m, 0.0);
}

TEST_F(SceneSky, CrownsBlockLightButReflectNoSignal) {
  const Vector3d eye(0.0, 0.3, 1.2);
  EXPECT_TRUE(scene.blocked(eye, Vector3d::UnitX(), kClearance_m));
  EXPECT_FALSE(scene.surface(eye, Vector3d::UnitX(), kClearance_m, 100.0));
  const auto wall = scene.surface({0.0, 0.3, 0.4}, Vector3d::UnitX(), kClearance_m, 100.0);
  ASSERT_TRUE(wall);
  EXPECT_NEAR(wall->range_m, 29.5, 1e-4);
  EXPECT_NEAR(wall->normal_W.x(), -1.0, 1e-6);
  EXPECT_FALSE(scene.surface({0.0, 0.3, 0.4}, Vector3d::UnitX(), kClearance_m, 29.0));
}

TEST(SceneSkyOfBodies, TheMachinesOwnBodyStandsInTheWay) {
  Scene scene;
  const auto body = scene.add_body("cab");
  scene.add_body_part(body, scene.add_mesh(make_box("cab", {2.0, 2.0, 2.0})),
                      scene_sky_at({0.0, 0.0, 3.0}), kWall);
  const BodyMotion here;
  scene.begin_slice(kSceneSkyT0, kSceneSkyT1, Vector3d::Zero(), {&here, 1});
  EXPECT_TRUE(scene.sky_path({0.1, 0.2, 0.0}, Vector3d::UnitZ(), kClearance_m).blocked);
  EXPECT_FALSE(scene.sky_path({0.1, 0.2, 0.0}, Vector3d::UnitX(), kClearance_m).blocked);
}

/// Chord through the solid of revolution of a conifer's crown, found by marching in small steps.
TEST(SceneSkyOfForest, CrownPathsEqualMarchingThroughTheMesh) {
  SceneDescription description;
  LevelTerrain level;
  level.roughness_m = 0.0;
  description.terrain = level;
  TreeField field;
  field.count = 60;
  field.half_lengths_m = {25.0, 25.0};
  description.trees.push_back(field);
  const BuiltScene built = build_scene(description, {}, 1);
  Scene& scene = *built.scene;
  scene.begin_slice(kSceneSkyT0, kSceneSkyT1, Vector3d::Zero(), {});
  RandomStream random(5, "sky");
  double sum_m = 0.0;
  for (int i = 0; i < 20; ++i) {
    const Vector3d eye(random.uniform(-20.0, 20.0), random.uniform(-20.0, 20.0), 2.0);
    const Vector3d direction =
        Vector3d(random.gaussian(), random.gaussian(), std::abs(random.gaussian()) + 0.1)
            .normalized();
    const SkyPath path = scene.sky_path(eye, direction, kClearance_m);
    if (path.blocked) {
      continue;
    }
    // A point is inside when a ray upwards from it starts within foliage: its path to the top is
    // longer than the same ray's from above would be; marching asks for the difference in length.
    constexpr double kStep_m = 0.02;
    double marched_m = 0.0;
    for (double s = 0.5 * kStep_m; s < 70.0; s += kStep_m) {
      const Vector3d p = eye + s * direction;
      const double here_m = scene.sky_path(p, direction, 1e3).foliage_m;
      const double next_m = scene.sky_path(p + 1e-3 * direction, direction, 1e3).foliage_m;
      marched_m += here_m - next_m > 0.5e-3 ? kStep_m : 0.0;
    }
    EXPECT_NEAR(path.foliage_m, marched_m, 0.1 + 0.02 * path.foliage_m);
    sum_m += path.foliage_m;
  }
  EXPECT_GT(sum_m, 20.0) << "the rays should meet crowns at all";
}

}  // namespace
}  // namespace rigwire::sim
