// What is fixed may leave its place: rays pass where it was and meet it where it is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "sim/scene/scene.h"
#include "sim/scene/scene_description.h"

namespace rigwire::sim {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr SimTime kSceneDisplacedT0 = kStart;
constexpr SimTime kSceneDisplacedT1 = kStart + std::chrono::milliseconds{1};

Isometry3d tipped_north(const Vector3d& foot, double angle_rad) {
  return Eigen::Translation3d(foot) * Eigen::AngleAxisd(-angle_rad, Vector3d::UnitX()) *
         Eigen::Translation3d(-foot);
}

/// A field of two trees and nothing else, off the origin.
BuiltScene two_trees() {
  SceneDescription description;
  description.terrain = LevelTerrain{};
  TreeField& field = description.trees.emplace_back();
  field.count = 2;
  field.centre_m = {30.0, 0.0};
  field.half_lengths_m = {8.0, 3.0};
  field.spacing_m = 6.0;
  field.smallest_m = field.largest_m = 12.0;
  field.conifer_share = 1.0;
  return build_scene(description, {}, 3);
}

/// Range to what is met level at z, from the south, above x.
std::optional<SceneHit> from_south(const Scene& scene, double x, double z) {
  return scene.cast({x, -30.0, z}, Vector3d::UnitY(), 0.1, 100.0, kSceneDisplacedT0);
}

TEST(SceneDisplaced, ATreeOfAFieldFallsAloneAndIsMetWhereItLies) {
  const BuiltScene built = two_trees();
  Scene& scene = *built.scene;
  ASSERT_EQ(built.obstacles.size(), 2U);
  ASSERT_EQ(built.looks.size(), 4U) << "trunk and crown of each";
  const Vector3d fallen = built.obstacles[0].foot_W();
  const Vector3d other = built.obstacles[1].foot_W();
  const Vector3d ground(fallen.x(), fallen.y(), 0.0);
  scene.begin_slice(kSceneDisplacedT0, kSceneDisplacedT1, Vector3d::Zero(), {});
  const auto twin = scene.twin();
  const auto before = from_south(scene, fallen.x(), 1.0);
  ASSERT_TRUE(before);
  EXPECT_EQ(scene.label(before->instance), "trunk");
  for (const ObstacleLook& look : built.looks) {
    if (look.obstacle == 0) {
      scene.displace(look.piece, tipped_north(ground, 0.5 * std::numbers::pi));
    }
  }
  EXPECT_TRUE(from_south(scene, fallen.x(), 1.0)) << "shown from the next slice on";
  scene.begin_slice(kSceneDisplacedT0, kSceneDisplacedT1, Vector3d::Zero(), {});
  twin->begin_slice(kSceneDisplacedT0, kSceneDisplacedT1, scene.placement(), {});
  for (const Scene* seen :
       {static_cast<const Scene*>(&scene), static_cast<const Scene*>(twin.get())}) {
    EXPECT_FALSE(from_south(*seen, fallen.x(), 2.5)) << "nothing stands there any more";
    const auto still = from_south(*seen, other.x(), 1.0);
    ASSERT_TRUE(still) << "the neighbour stands";
    // From above, where the trunk lies: one radius high; its crown farther on.
    const auto trunk = seen->cast({fallen.x(), fallen.y() + 1.0, 5.0}, -Vector3d::UnitZ(), 0.1,
                                  10.0, kSceneDisplacedT0);
    ASSERT_TRUE(trunk);
    EXPECT_NEAR(5.0 - trunk->range_m, 0.225, 0.03);
    EXPECT_EQ(seen->label(trunk->instance), "trunk");
    EXPECT_EQ(trunk->instance, before->instance) << "the field's trunks, as before";
    EXPECT_GT(trunk->normal_W.z(), 0.8);
    const auto crown = seen->cast({fallen.x(), fallen.y() + 4.0, 5.0}, -Vector3d::UnitZ(), 0.1,
                                  10.0, kSceneDisplacedT0);
    ASSERT_TRUE(crown);
    EXPECT_EQ(seen->label(crown->instance), "crown");
  }
  // Far away, where the scene's local origin is another one, all is the same.
  scene.begin_slice(kSceneDisplacedT0, kSceneDisplacedT1, {0.0, 90.0, 0.0}, {});
  EXPECT_FALSE(from_south(scene, fallen.x(), 2.5));
  EXPECT_TRUE(from_south(scene, other.x(), 1.0));
  EXPECT_TRUE(scene.cast({fallen.x(), fallen.y() + 1.0, 5.0}, -Vector3d::UnitZ(), 0.1, 4.9,
                         kSceneDisplacedT0));
}

TEST(SceneDisplaced, RadioFollowsACrownOfLeavesToWhereItLies) {
  SceneDescription description;
  description.terrain = LevelTerrain{};
  Forest& forest = description.forests.emplace_back();
  forest.count = 2;
  forest.half_lengths_m = {12.0, 0.5};
  forest.spacing_m = 12.0;
  forest.species = {{Species::spruce, 1.0, 20.0, 20.0}};
  forest.bushes_per_ha = forest.fallen_per_ha = 0.0;
  const BuiltScene built = build_scene(description, {}, 1);
  Scene& scene = *built.scene;
  ASSERT_EQ(built.obstacles.size(), 2U);
  scene.begin_slice(kSceneDisplacedT0, kSceneDisplacedT1, Vector3d::Zero(), {});
  const auto foliage_m = [&](const Vector3d& p, const Vector3d& way) {
    return scene.sky_path(p, way, 0.05).foliage_m;
  };
  for (std::size_t i = 0; i < 2; ++i) {
    const Vector3d foot = built.obstacles[i].foot_W();
    ASSERT_GT(foliage_m(foot + Vector3d(0.6, -30.0, 11.0), Vector3d::UnitY()), 1.0);
  }
  const Vector3d fallen = built.obstacles[0].foot_W();
  for (const ObstacleLook& look : built.looks) {
    if (look.obstacle == 0) {
      scene.displace(look.piece, tipped_north(fallen, 0.5 * std::numbers::pi));
    }
  }
  scene.begin_slice(kSceneDisplacedT0, kSceneDisplacedT1, Vector3d::Zero(), {});
  EXPECT_EQ(foliage_m(fallen + Vector3d(0.6, -30.0, 11.0), Vector3d::UnitY()), 0.0);
  EXPECT_GT(foliage_m(fallen + Vector3d(0.6, 11.0, -0.1), Vector3d::UnitZ()), 0.05);
  EXPECT_GT(foliage_m(built.obstacles[1].foot_W() + Vector3d(0.6, -30.0, 11.0), Vector3d::UnitY()),
            1.0);
}

TEST(SceneDisplaced, WhatIsNotThereOrCannotMoveIsRefused) {
  const BuiltScene built = two_trees();
  Scene& scene = *built.scene;
  const auto displace = [&](const ScenePiece& piece) {
    return [&scene, piece] { scene.displace(piece, Isometry3d::Identity()); };
  };
  EXPECT_THAT(displace({.thing = 99}),
              ThrowsMessage<std::invalid_argument>(HasSubstr("no such thing")));
  EXPECT_THAT(displace({.thing = built.terrain}),
              ThrowsMessage<std::invalid_argument>(HasSubstr("not fixed")));
  EXPECT_THAT(
      displace({.thing = built.looks[0].piece.thing, .first_triangle = 1, .triangles = 9999}),
      ThrowsMessage<std::invalid_argument>(HasSubstr("triangles")));
  Isometry3d bad = Isometry3d::Identity();
  bad.translation().x() = std::nan("");
  EXPECT_THAT([&] { scene.displace(built.looks[0].piece, bad); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("not finite")));
  scene.displace(built.looks[0].piece, Isometry3d::Identity());
  ScenePiece half = built.looks[0].piece;
  half.triangles /= 2;
  EXPECT_THAT(displace(half), ThrowsMessage<std::invalid_argument>(HasSubstr("gone already")));
}

}  // namespace
}  // namespace rigwire::sim
