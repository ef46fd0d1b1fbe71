#include <algorithm>
#include <map>
#include <stdexcept>

#include "sim/scene/scene_description.h"

namespace rigwire::sim {
namespace {

std::vector<LaidTrack> lay(const std::vector<Track>& tracks) {
  std::vector<LaidTrack> laid;
  laid.reserve(tracks.size());
  for (const Track& track : tracks) {
    laid.push_back({track, track_line(track)});
  }
  return laid;
}

void add_rocks(const SceneDescription& description, std::uint64_t seed, BuiltScene& built) {
  /// Rocks are cut spheres; this is their mean reach.
  constexpr double kMeanReach = 0.8;
  constexpr double kFriction = 0.7;
  std::vector<Scene::MeshId> shapes;
  RandomStream random(seed, "scene/rocks");
  for (std::size_t i = 0; i < kRockShapes && !description.rocks.empty(); ++i) {
    shapes.push_back(built.scene->add_mesh(make_rock("rock " + std::to_string(i), random)));
  }
  for (const RockField& rocks : description.rocks) {
    for (const PlacedRock& rock : place_rocks(rocks, built.ground, random)) {
      built.scene->add_object(shapes[rock.shape], rock.X_WM, rock.radius_m, rocks.material);
      Obstacle& sphere = built.obstacles.emplace_back();
      sphere.shape = ObstacleShape::sphere;
      sphere.X_WO.translation() = rock.X_WM.translation();
      sphere.half_lengths_m.setConstant(kMeanReach * rock.radius_m);
      sphere.friction = kFriction;
    }
  }
}

/// Trees keep off tracks, and off boxes by their circumscribed circle.
void add_trees(const SceneDescription& description, const std::vector<LaidTrack>& tracks,
               std::uint64_t seed, BuiltScene& built) {
  std::vector<ClearWay> ways;
  for (const LaidTrack& laid : tracks) {
    ways.push_back({&laid.line, 0.5 * laid.track.width_m});
  }
  std::vector<KeepOut> keep_out;
  for (const BoxObject& box : description.boxes) {
    keep_out.push_back({box.position_m.head<2>(), 0.5 * box.size_m.head<2>().norm() + 1.0});
  }
  std::size_t number = 0;
  for (const TreeField& field : description.trees) {
    RandomStream random(seed + field.seed, "scene/trees/" + std::to_string(number++));
    const std::vector<PlacedTree> trees = place_trees(field, built.ground, ways, keep_out, random);
    if (trees.empty()) {
      continue;
    }
    Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
    X_WM.translation() << field.centre_m, trees.front().foot_m.z();
    const ForestMeshes forest = forest_meshes(trees, X_WM.translation());
    built.scene->add_object(built.scene->add_mesh(forest.trunks), X_WM, 1.0, field.trunk);
    built.scene->add_object(built.scene->add_mesh(forest.crowns), X_WM, 1.0, field.crown);
    for (const PlacedTree& tree : trees) {
      built.obstacles.push_back(trunk_obstacle(tree));
    }
  }
}

void add_boxes(const SceneDescription& description, BuiltScene& built) {
  for (const BoxObject& box : description.boxes) {
    const Eigen::Isometry3d X_WM = box_pose(box, built.ground);
    built.scene->add_object(built.scene->add_mesh(make_box(box.name, box.size_m)), X_WM, 1.0,
                            box.material);
    Obstacle& obstacle = built.obstacles.emplace_back();
    obstacle.shape = ObstacleShape::box;
    obstacle.X_WO = X_WM;
    obstacle.half_lengths_m = 0.5 * box.size_m;
  }
}

void add_objects(const SceneDescription& description, const std::vector<TriangleMesh>& meshes,
                 BuiltScene& built) {
  std::map<std::string, Scene::MeshId> added;
  for (const FixedObject& object : description.objects) {
    if (!added.contains(object.mesh)) {
      const auto found = std::ranges::find(meshes, object.mesh, &TriangleMesh::name);
      if (found == meshes.end()) {
        std::string names;
        for (const TriangleMesh& mesh : meshes) {
          names += (names.empty() ? "" : ", ") + mesh.name;
        }
        throw std::invalid_argument("object '" + object.name + "': there is no mesh '" +
                                    object.mesh + "'; there are: " + names);
      }
      added[object.mesh] = built.scene->add_mesh(*found);
    }
    built.scene->add_object(added[object.mesh], object_pose(object, built.ground), 1.0,
                            object.material);
  }
}

struct MakeTerrain {
  std::uint64_t seed;

  HeightField operator()(const PitTerrain& terrain) const { return make_pit(terrain, seed); }
  HeightField operator()(const HillsTerrain& terrain) const { return make_hills(terrain, seed); }
  HeightField operator()(const LevelTerrain& terrain) const { return make_level(terrain, seed); }
};

}  // namespace

HeightField make_terrain(const Terrain& terrain, const std::vector<Track>& tracks,
                         std::uint64_t seed) {
  HeightField field = std::visit(MakeTerrain{seed}, terrain);
  for (const Track& track : tracks) {
    carve(field, track, seed);
  }
  return field;
}

const Material& material(const Terrain& terrain) {
  return std::visit([](const auto& chosen) -> const Material& { return chosen.material; }, terrain);
}

BuiltScene build_scene(const SceneDescription& description, const std::vector<TriangleMesh>& meshes,
                       std::uint64_t seed) {
  validate(description);
  BuiltScene built{std::make_unique<Scene>(),
                   0,
                   make_terrain(description.terrain, description.tracks, seed),
                   {},
                   {}};
  built.terrain = built.scene->add_terrain(built.ground, material(description.terrain));
  const std::vector<LaidTrack> tracks = lay(description.tracks);
  built.soils = make_soil_map(built.ground, description.soils, tracks, description.soil_regions);
  add_rocks(description, seed, built);
  add_trees(description, tracks, seed, built);
  add_boxes(description, built);
  add_objects(description, meshes, built);
  return built;
}

}  // namespace rigwire::sim
