#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "sim/scene/convex_pieces.h"
#include "sim/scene/loose_rock.h"
#include "sim/scene/mesh_repair.h"
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

/// Straight up or down until its lowest points touch the terrain under them.
void lay_on_ground(LooseBody& body, const HeightField& ground) {
  double sunk_m = -1e300;
  for (const Eigen::Vector3d& p_B : body.shape.outline()) {
    const Eigen::Vector3d p = body.X_WB * p_B;
    sunk_m = std::max(sunk_m, ground.height_m(p.x(), p.y()) - p.z());
  }
  body.X_WB.translation().z() += sunk_m;
}

void add_rocks(const SceneDescription& description, std::uint64_t seed, BuiltScene& built) {
  /// Rocks are cut spheres; this is their mean reach.
  constexpr double kMeanReach = 0.8;
  constexpr double kFriction = 0.7;
  std::vector<TriangleMesh> rock_meshes;
  std::vector<Scene::MeshId> shapes;
  RandomStream random(seed, "scene/rocks");
  for (std::size_t i = 0; i < kRockShapes && !description.rocks.empty(); ++i) {
    rock_meshes.push_back(make_rock("rock " + std::to_string(i), random));
    shapes.push_back(built.scene->add_mesh(rock_meshes.back()));
  }
  std::size_t number = 0;
  for (const RockField& rocks : description.rocks) {
    for (const PlacedRock& rock : place_rocks(rocks, built.ground, random)) {
      if (rocks.loose) {
        LooseRock loose = loose_rock(rock_meshes[rock.shape], rock.X_WM, rock.radius_m,
                                     rocks.density_kgpm3, "rock " + std::to_string(number++));
        lay_on_ground(loose.body, built.ground);
        built.loose.push_back(std::move(loose.body));
        built.loose_looks.push_back({built.scene->add_mesh(loose.mesh), rocks.material});
        continue;
      }
      built.scene->add_object(shapes[rock.shape], rock.X_WM, rock.radius_m, rocks.material,
                              "rock " + std::to_string(number++));
      Obstacle& sphere = built.obstacles.emplace_back();
      sphere.shape = ObstacleShape::sphere;
      sphere.X_WO.translation() = rock.X_WM.translation();
      sphere.half_lengths_m.setConstant(kMeanReach * rock.radius_m);
      sphere.friction = kFriction;
      sphere.name = "rock " + std::to_string(number - 1);
    }
  }
}

/// Discs that cover the box's outline and a metre beside it, in a row along its longer side.
void cover(const BoxObject& box, std::vector<KeepOut>& discs) {
  constexpr double kBeside_m = 1.0;
  constexpr double kLeastSpacing_m = 1.0;
  const bool along_x = box.size_m.x() >= box.size_m.y();
  const double length = std::max(box.size_m.x(), box.size_m.y());
  const double width = std::min(box.size_m.x(), box.size_m.y());
  const double turn = box.yaw_rad + (along_x ? 0.0 : 0.5 * std::numbers::pi);
  const Eigen::Vector2d along(std::cos(turn), std::sin(turn));
  const auto count = static_cast<int>(std::ceil(length / std::max(width, kLeastSpacing_m)));
  const double spacing = length / count;
  for (int i = 0; i < count; ++i) {
    discs.push_back({box.position_m.head<2>() + along * (spacing * (i + 0.5) - 0.5 * length),
                     0.5 * std::hypot(width, spacing) + kBeside_m});
  }
}

/// Places to keep clear of plants: tracks and boxes.
struct Clearings {
  std::vector<ClearWay> ways;
  std::vector<KeepOut> keep_out;
};

Clearings clearings(const SceneDescription& description, const std::vector<LaidTrack>& tracks) {
  Clearings clear;
  for (const LaidTrack& laid : tracks) {
    clear.ways.push_back({&laid.line, 0.5 * laid.track.width_m});
  }
  for (const BoxObject& box : description.boxes) {
    if (box.solid || box.loose) {
      cover(box, clear.keep_out);
    }
  }
  return clear;
}

/// Returns the indices of the trees on each square of kTreeTile_m, square by square.
std::vector<std::vector<std::size_t>> tiles(std::span<const PlacedTree> trees) {
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::size_t>> by_square;
  for (std::size_t i = 0; i < trees.size(); ++i) {
    const Eigen::Vector2d square = (trees[i].foot_m.head<2>() / kTreeTile_m).array().floor();
    by_square[{static_cast<std::int64_t>(square.x()), static_cast<std::int64_t>(square.y())}]
        .push_back(i);
  }
  std::vector<std::vector<std::size_t>> all;
  all.reserve(by_square.size());
  for (auto& [square, own] : by_square) {
    all.push_back(std::move(own));
  }
  return all;
}

void add_trees(const SceneDescription& description, const Clearings& clear, std::uint64_t seed,
               BuiltScene& built) {
  std::size_t number = 0;
  for (const TreeField& field : description.trees) {
    RandomStream random(seed + field.seed, "scene/trees/" + std::to_string(number++));
    const std::vector<PlacedTree> trees =
        place_trees(field, built.ground, clear.ways, clear.keep_out, random);
    if (trees.empty()) {
      continue;
    }
    const std::size_t first = built.obstacles.size();
    std::size_t stem = 0;
    for (const PlacedTree& tree : trees) {
      built.obstacles.push_back(trunk_obstacle(tree));
      built.obstacles.back().name = "tree " + std::to_string(stem++);
    }
    for (const std::vector<std::size_t>& tile : tiles(trees)) {
      std::vector<PlacedTree> own;
      std::ranges::transform(tile, std::back_inserter(own),
                             [&](std::size_t i) { return trees[i]; });
      Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
      X_WM.translation() = own.front().foot_m.array().round();
      const ForestMeshes forest = forest_meshes(own, X_WM.translation());
      const std::array<Scene::InstanceId, 2> meshes{
          built.scene->add_object(built.scene->add_mesh(forest.trunks), X_WM, 1.0, field.trunk),
          built.scene->add_object(built.scene->add_mesh(forest.crowns), X_WM, 1.0, field.crown)};
      for (std::size_t i = 0; i < own.size(); ++i) {
        for (std::size_t k = 0; k < meshes.size(); ++k) {
          const std::uint32_t from = forest.first_triangles[i][k];
          built.looks.push_back(
              {first + tile[i], {meshes[k], false, from, forest.first_triangles[i + 1][k] - from}});
        }
      }
    }
  }
}

void add_boxes(const SceneDescription& description, BuiltScene& built) {
  for (const BoxObject& box : description.boxes) {
    const Eigen::Isometry3d X_WM = box_pose(box, built.ground);
    TriangleMesh mesh = make_box(box.name, box.size_m);
    if (box.loose) {
      LooseBody crate{.name = box.name, .shape = ConvexShape::box(0.5 * box.size_m)};
      const Eigen::Array3d squares = box.size_m.array().square();
      crate.mass_kg = box.mass_kg;
      crate.inertia_kgm2 = box.mass_kg / 12.0 * (squares.sum() - squares).matrix();
      crate.X_WB = X_WM;
      crate.friction = box.friction;
      built.loose.push_back(std::move(crate));
      built.loose_looks.push_back({built.scene->add_mesh(mesh), box.material});
      continue;
    }
    tessellate(mesh, kLongestEdge_m);
    built.scene->add_object(built.scene->add_mesh(mesh), X_WM, 1.0, box.material);
    if (!box.solid) {
      continue;
    }
    Obstacle& obstacle = built.obstacles.emplace_back();
    obstacle.shape = ObstacleShape::box;
    obstacle.X_WO = X_WM;
    obstacle.half_lengths_m = 0.5 * box.size_m;
    obstacle.name = box.name;
  }
}

/// What cameras see of the soils, each by its name, and what lidars measure of them.
void cover_with_soils(BuiltScene& built) {
  std::vector<std::string> names;
  std::vector<double> reflectances;
  for (const SoilParameters& soil : built.soils.soils) {
    names.push_back(soil.name);
    reflectances.push_back(soil.reflectance);
  }
  std::vector<std::uint8_t> cells = built.soils.cells;
  if (cells.empty()) {
    cells.assign((built.ground.columns - 1) * (built.ground.rows - 1), 0);
  }
  built.scene->cover_terrain(built.terrain, std::move(names), std::move(cells),
                             std::move(reflectances));
}

template <class Range, class Name>
std::string listed(const Range& range, Name&& name) {
  std::string names;
  for (const auto& one : range) {
    names += (names.empty() ? "" : ", ") + name(one);
  }
  return names.empty() ? "none" : names;
}

/// The object's parts with their surfaces.
std::vector<MeshPart> parts_of(const FixedObject& object, const std::vector<TriangleMesh>& meshes) {
  std::vector<MeshPart> parts;
  for (const TriangleMesh& mesh : meshes) {
    if (mesh.name == object.mesh) {
      const auto named = std::ranges::find(object.materials, mesh.material, &NamedMaterial::name);
      parts.push_back({mesh, named != object.materials.end() ? named->material : object.material});
      tessellate(parts.back().mesh, kLongestEdge_m / object.scale);
    }
  }
  if (parts.empty()) {
    throw std::invalid_argument(
        "object '" + object.name + "': there is no mesh '" + object.mesh +
        "'; there are: " + listed(meshes, [](const TriangleMesh& mesh) { return mesh.name; }));
  }
  for (const NamedMaterial& named : object.materials) {
    if (std::ranges::none_of(
            parts, [&](const MeshPart& part) { return part.mesh.material == named.name; })) {
      throw std::invalid_argument(
          "object '" + object.name + "': its mesh has no material '" + named.name +
          "'; it has: " + listed(parts, [](const MeshPart& part) { return part.mesh.material; }));
    }
  }
  return parts;
}

void add_objects(const SceneDescription& description, const std::vector<TriangleMesh>& meshes,
                 BuiltScene& built) {
  // Objects alike in mesh, scale and surfaces share one model.
  std::vector<std::pair<const FixedObject*, Scene::MeshId>> added;
  for (const FixedObject& object : description.objects) {
    auto alike = std::ranges::find_if(added, [&](const auto& entry) {
      const FixedObject& other = *entry.first;
      return other.mesh == object.mesh && other.scale == object.scale &&
             other.material == object.material && other.materials == object.materials;
    });
    if (alike == added.end()) {
      alike = added.emplace(added.end(), &object, built.scene->add_model(parts_of(object, meshes)));
    }
    built.scene->add_model_object(alike->second, object_pose(object, built.ground), object.scale,
                                  object.name);
    if (!object.solid) {
      continue;
    }
    std::vector<TriangleMesh> own;
    std::ranges::copy_if(meshes, std::back_inserter(own),
                         [&](const TriangleMesh& mesh) { return mesh.name == object.mesh; });
    for (const auto& piece : convex_pieces(own, object.scale)) {
      Obstacle& obstacle = built.obstacles.emplace_back();
      obstacle.shape = ObstacleShape::hull;
      obstacle.X_WO = object_pose(object, built.ground);
      obstacle.half_lengths_m = piece->half_lengths_m();
      obstacle.hull = piece;
      obstacle.name = object.name;
    }
  }
}

struct MakeTerrain {
  std::uint64_t seed;

  HeightField operator()(const PitTerrain& terrain) const { return make_pit(terrain, seed); }
  HeightField operator()(const HillsTerrain& terrain) const { return make_hills(terrain, seed); }
  HeightField operator()(const LevelTerrain& terrain) const { return make_level(terrain, seed); }
  HeightField operator()(const HeightMapTerrain& terrain) const { return make_height_map(terrain); }
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
                   {},
                   {},
                   {},
                   {}};
  built.terrain = built.scene->add_terrain(built.ground, material(description.terrain));
  const std::vector<LaidTrack> tracks = lay(description.tracks);
  built.soils = make_soil_map(built.ground, description.soils, tracks, description.soil_regions);
  cover_with_soils(built);
  add_rocks(description, seed, built);
  const Clearings clear = clearings(description, tracks);
  add_trees(description, clear, seed, built);
  for (const Forest& forest : description.forests) {
    add_forest(forest, built.ground, clear.ways, clear.keep_out, seed, *built.scene,
               built.obstacles, built.looks);
  }
  for (const GrassField& grass : description.grass) {
    add_grass(grass, built.ground, clear.ways, clear.keep_out, seed, *built.scene);
  }
  add_boxes(description, built);
  add_objects(description, meshes, built);
  std::ranges::stable_sort(built.looks, {}, &ObstacleLook::obstacle);
  return built;
}

}  // namespace rigwire::sim
