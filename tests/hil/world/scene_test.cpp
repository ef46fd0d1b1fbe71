// The scenes of configs/scenes: machines can drive in them, and their paths are the tracks'.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <ostream>
#include <sstream>
#include <string>

#include "hil/configuration/document.h"
#include "hil/configuration/reader.h"
#include "hil/rig/rig_configuration.h"
#include "hil/world/scene.h"
#include "sim/local_frame.h"

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
void PrintTo(const DrivableScene& scene, std::ostream* out) {
  *out << scene.name;
}

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
                                         DrivableScene{"forest", 300.0, 0.15},
                                         DrivableScene{"road_site", 200.0, 0.01},
                                         DrivableScene{"campus", 500.0, 0.08}),
                         [](const auto& scene) { return std::string(scene.param.name); });

/// configs/paths/<name>.csv lies on the track; scripts/path-from-track.py makes it.
class PathFiles : public testing::TestWithParam<const char*> {};

TEST_P(PathFiles, LieOnTheTrackForTheDefaultOrigin) {
  const SceneConfiguration scene = load_scene(GetParam());
  const sim::TrackLine line = sim::track_line(scene.description.tracks.front());
  const OriginConfiguration origin;
  const sim::LocalFrame frame({.latitude_deg = origin.latitude_deg,
                               .longitude_deg = origin.longitude_deg,
                               .ellipsoid_height_m = origin.height_m,
                               .geoid_separation_m = origin.geoid_separation_m});
  std::ifstream file(std::string(RIGWIRE_SOURCE_DIR) + "/configs/paths/" + GetParam() + ".csv");
  std::string text;
  double along = 0.0;
  int points = 0;
  while (std::getline(file, text)) {
    std::istringstream fields(text);
    sim::GeodeticPoint place{.ellipsoid_height_m = origin.height_m};
    char comma = 0;
    if (!(fields >> place.latitude_deg >> comma >> place.longitude_deg)) {
      continue;
    }
    const auto nearest = line.nearest(frame.to_world(place).head<2>());
    EXPECT_LT(nearest.distance_m, 0.02) << text;
    EXPECT_GE(nearest.along_m, along - 1e-3) << "in the track's order";
    along = nearest.along_m;
    ++points;
  }
  EXPECT_NEAR(points * 2.0, line.length_m, 4.0);
}

INSTANTIATE_TEST_SUITE_P(Files, PathFiles, testing::Values("forest_track", "campus"),
                         [](const auto& name) { return std::string(name.param); });

TEST(SceneFiles, SoilsLieWhereTheScenesSay) {
  const SceneConfiguration scene = load_scene("forest_track");
  const sim::BuiltScene built = sim::build_scene(scene.description, {}, 1);
  const sim::TrackLine line = sim::track_line(scene.description.tracks.front());
  const sim::Ground ground(built.ground, built.soils, built.obstacles);
  const auto soil_at = [&](double along_m) {
    const Eigen::Vector2d p =
        line.points_m[static_cast<std::size_t>(along_m / sim::kTrackSpacing_m)];
    return ground.soil(ground.at(p.x(), p.y(), 100.0).soil).name;
  };
  EXPECT_EQ(soil_at(100.0), "gravel");
  EXPECT_EQ(soil_at(200.0), "mud");
  EXPECT_EQ(soil_at(220.0), "gravel");
  EXPECT_EQ(ground.soil(ground.at(20.0, 30.0, 100.0).soil).name, "forest_floor");
}

TEST(SceneFiles, TerrainWithoutTypeIsAPit) {
  Problems problems;
  Origins origins;
  const Value document = parse_document("terrain: {size: 80 m}\n", "scene.yaml", ".", problems);
  SceneConfiguration scene;
  read(document, scene, problems, origins);
  problems.throw_if_any();
  EXPECT_EQ(std::get<sim::PitTerrain>(scene.description.terrain).size_m, 80.0);
}

TEST(SceneFiles, AHeightMapIsReadBeforeItsHeightsAreLoaded) {
  const std::string file = testing::TempDir() + "rigwire_scene_test_map.png";
  std::ofstream(file) << "not looked into here";
  Problems problems;
  Origins origins;
  const Value document = parse_document(
      "terrain: {type: height_map, file: " + file + ", size: 9 m}", "scene.yaml", ".", problems);
  SceneConfiguration scene;
  read(document, scene, problems, origins);
  EXPECT_NO_THROW(problems.throw_if_any());
  EXPECT_EQ(std::get<sim::HeightMapTerrain>(scene.description.terrain).size_m, 9.0);
}

}  // namespace
}  // namespace rigwire::hil
