#include "sim/scene/trees.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "sim/scene/scene_description.h"

namespace rigwire::sim {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(Trees, StandOnTheGroundApartAndOffTheTrack) {
  const HeightField ground = make_hills({}, 2);
  Track track;
  track.points = {{{-60.0, -10.0}}, {{60.0, 10.0}}};
  const TrackLine line = track_line(track);
  const ClearWay way{&line, 2.0};
  const KeepOut building{{30.0, 30.0}, 12.0};
  TreeField field;
  field.half_lengths_m = {50.0, 40.0};
  field.density_per_ha = 500.0;
  RandomStream random(2, "trees");
  const auto trees = place_trees(field, ground, {&way, 1}, {&building, 1}, random);
  EXPECT_EQ(trees.size(), 400U) << "0.8 ha";
  for (std::size_t i = 0; i < trees.size(); ++i) {
    const Eigen::Vector2d spot = trees[i].foot_m.head<2>();
    EXPECT_GE(line.nearest(spot).distance_m, 2.0 + field.track_distance_m);
    EXPECT_GE((spot - building.centre_m).norm(), building.radius_m);
    EXPECT_EQ(trees[i].foot_m.z(), ground.height_m(spot.x(), spot.y()));
    EXPECT_LE(spot.cwiseAbs().x(), 50.0);
    EXPECT_GE(trees[i].height_m, field.smallest_m);
    EXPECT_LE(trees[i].trunk_diameter_m, field.trunk_diameter_m);
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GE((spot - trees[j].foot_m.head<2>()).norm(), field.spacing_m);
    }
  }
}

TEST(Trees, RaysMeetTrunksAndCrownsWhereTheObstaclesAre) {
  SceneDescription description;
  LevelTerrain level;
  level.roughness_m = 0.0;
  description.terrain = level;
  TreeField field;
  field.count = 1;
  field.conifer_share = 0.0;
  field.smallest_m = field.largest_m = 10.0;
  description.trees.push_back(field);
  const BuiltScene built = build_scene(description, {}, 1);
  ASSERT_EQ(built.obstacles.size(), 1U);
  const Obstacle& trunk = built.obstacles.front();
  EXPECT_EQ(trunk.shape, ObstacleShape::cylinder);
  const Eigen::Vector3d foot(trunk.X_WO.translation().x(), trunk.X_WO.translation().y(), 0.0);
  built.scene->begin_slice(kStart, kStart + Duration{1000}, foot, {});
  const Eigen::Vector3d eye = foot + Eigen::Vector3d(-20.0, 0.01, 1.0);
  const auto hit = built.scene->cast(eye, Eigen::Vector3d::UnitX(), 0.1, 100.0, kStart);
  ASSERT_TRUE(hit.has_value());
  EXPECT_EQ(built.scene->material(hit->instance).label, "trunk");
  EXPECT_NEAR(hit->range_m, 20.0 - trunk.half_lengths_m.x(), 0.02);
  const auto above = built.scene->cast(eye + Eigen::Vector3d(0.0, 0.0, 5.5),
                                       Eigen::Vector3d::UnitX(), 0.1, 100.0, kStart);
  ASSERT_TRUE(above.has_value());
  EXPECT_EQ(built.scene->material(above->instance).label, "crown");
  EXPECT_NEAR(above->range_m, 20.0 - 2.4, 0.3);
}

TEST(Trees, SurfacesFaceOutwards) {
  PlacedTree tree;
  const ForestMeshes forest = forest_meshes({&tree, 1}, Eigen::Vector3d::Zero());
  validate(forest.trunks);
  validate(forest.crowns);
  double volume = 0.0;
  for (const auto& [a, b, c] : forest.crowns.triangles) {
    volume +=
        forest.crowns.vertices[a].dot(forest.crowns.vertices[b].cross(forest.crowns.vertices[c])) /
        6.0;
  }
  EXPECT_GT(volume, 1.0);
}

TEST(Trees, RefuseNonsenseByName) {
  TreeField field;
  field.density_per_ha = std::nan("");
  EXPECT_THAT([&] { validate(field); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("density: ")));
  field = {};
  field.largest_m = 1.0;
  EXPECT_THAT([&] { validate(field); }, ThrowsMessage<std::invalid_argument>(
                                            HasSubstr("largest: not below the smallest, found")));
}

}  // namespace
}  // namespace rigwire::sim
