// The scenes of configs/scenes: machines can drive in them, and their paths are the tracks'.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "hil/configuration/document.h"
#include "hil/configuration/reader.h"
#include "hil/configuration/scene.h"

namespace rigwire::hil {
namespace {

SceneConfiguration load_scene(const std::string& name) {
  Problems problems;
  const Value document = load_document(
      std::string(RIGWIRE_SOURCE_DIR) + "/configs/scenes/" + name + ".yaml", problems);
  Origins origins;
  SceneConfiguration scene;
  read(document, scene, problems, origins);
  problems.throw_if_any();
  return scene;
}

struct DrivableScene {
  const char* name;
  double length_m;
  double steepest;  ///< Rise over run along the track, over 3 m.
};

class DrivableScenes : public testing::TestWithParam<DrivableScene> {};

TEST_P(DrivableScenes, TrackIsGentleAndClear) {
  const SceneConfiguration scene = load_scene(GetParam().name);
  const sim::BuiltScene built = sim::build_scene(scene.description, {}, 1);
  ASSERT_FALSE(scene.description.tracks.empty());
  const sim::Track& track = scene.description.tracks.front();
  const sim::TrackLine line = sim::track_line(track);
  EXPECT_NEAR(line.length_m, GetParam().length_m, 5.0);
  constexpr std::size_t kApart = 6;
  for (std::size_t i = 0; i + kApart < line.points_m.size(); ++i) {
    const auto height = [&](std::size_t k) {
      return built.ground.height_m(line.points_m[k].x(), line.points_m[k].y());
    };
    EXPECT_LT(std::abs(height(i + kApart) - height(i)) / 3.0, GetParam().steepest) << i;
  }
  for (const sim::Obstacle& obstacle : built.obstacles) {
    if (obstacle.shape != sim::ObstacleShape::box) {
      EXPECT_GT(line.nearest(obstacle.X_WO.translation().head<2>()).distance_m,
                0.5 * track.width_m + obstacle.half_lengths_m.x());
    }
  }
  EXPECT_GT(built.obstacles.size(), 50U);
}

INSTANTIATE_TEST_SUITE_P(Files, DrivableScenes,
                         testing::Values(DrivableScene{"forest_track", 300.0, 0.15},
                                         DrivableScene{"road_site", 200.0, 0.01},
                                         DrivableScene{"campus", 500.0, 0.08}),
                         [](const auto& scene) { return std::string(scene.param.name); });

TEST(SceneFiles, TerrainWithoutTypeIsAPit) {
  Problems problems;
  Origins origins;
  const Value document = parse_document("terrain: {size: 80 m}\n", "scene.yaml", ".", problems);
  SceneConfiguration scene;
  read(document, scene, problems, origins);
  problems.throw_if_any();
  EXPECT_EQ(std::get<sim::PitTerrain>(scene.description.terrain).size_m, 80.0);
}

}  // namespace
}  // namespace rigwire::hil
