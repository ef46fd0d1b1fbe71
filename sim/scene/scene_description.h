// A scene as data: what configs/scenes/*.yaml fills. World frame: x east, y north, z up, metres
// from the scene's map origin; the machine works at (0, 0).
#pragma once

#include "fields/rules.h"

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "sim/contact/loose_bodies.h"
#include "sim/ground/ground.h"
#include "sim/scene/forest.h"
#include "sim/scene/grass.h"
#include "sim/scene/height_map.h"
#include "sim/scene/keep_out.h"
#include "sim/scene/open_ground.h"
#include "sim/scene/scene.h"
#include "sim/scene/soil_regions.h"
#include "sim/scene/track.h"
#include "sim/scene/trees.h"

namespace rigwire::sim {

/// A cone of loose material.
struct Heap {
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();
  double height_m = 1.5;
  double repose_deg = 37.0;  ///< Slope of the cone.
};
void visit(fields::Visitor& v, Heap& p);

/// The lowest level of an open pit, made by formula and noise: a flat floor bounded by a working
/// face, above it benches with flat berms and safety windrows, and an access ramp cut to the west.
struct PitTerrain {
  static constexpr fields::Named kNamed{
      "pit", "Lowest level of an open pit: floor, benches, ramp, heaps."};

  double size_m = 120.0;  ///< Edge of the square area, its middle at (0, 0).
  double cell_m = 0.4;    ///< Distance of the nodes.
  double floor_height_m = 0.0;
  Eigen::Vector2d floor_centre_m{-20.0, 0.0};
  Eigen::Vector2d floor_half_lengths_m{27.0, 26.0};  ///< East reach: the working face's toe.
  int benches = 3;
  double bench_height_m = 4.0;
  double face_angle_deg = 70.0;
  double berm_width_m = 6.0;
  double windrow_height_m = 0.8;  ///< Ridge along the outer edge of each berm.
  double ramp_width_m = 9.0;
  double ramp_slope = 0.12;         ///< Rise over run.
  double ramp_start_x_m = -30.0;    ///< The ramp rises from here to the west.
  double ramp_y_m = -6.0;           ///< Its centre line.
  double floor_roughness_m = 0.03;  ///< Standard deviation of the noise on floor and ramp.
  double face_roughness_m = 0.25;   ///< On faces and berms.
  std::vector<Heap> heaps{{{6.2, 0.0}, 1.6, 37.0}};
  Material material{.reflectance = 0.35, .label = "ground"};
};
void visit(fields::Visitor& v, PitTerrain& p);

/// Boulders strewn over a disc, diameters by a power law: the number above d falls as
/// d^(1 - exponent).
struct RockField {
  int count = 80;
  Eigen::Vector2d centre_m{0.0, 0.0};
  double radius_m = 35.0;
  double smallest_m = 0.2;
  double largest_m = 1.8;
  double exponent = 2.7;
  Material material{.reflectance = 0.45, .label = "rock"};
  std::vector<KeepOut> keep_out{{{0.0, 0.0}, 5.0}, {{-1.0, 7.0}, 6.0}};
  bool loose = false;             ///< They lie on the ground, and machines push and lift them.
  double density_kgpm3 = 2650.0;  ///< Density of loose rocks.
};
void visit(fields::Visitor& v, RockField& p);

/// What a part of a mesh is, by the name of its material in the mesh's file.
struct NamedMaterial {
  std::string name;
  Material material{.reflectance = 0.6, .label = "object"};

  friend bool operator==(const NamedMaterial&, const NamedMaterial&) = default;
};
void visit(fields::Visitor& v, NamedMaterial& p);

/// A mesh at a fixed place in the scene.
struct FixedObject {
  std::string name;
  std::string mesh;  ///< Name of a mesh in the library given to build_scene().
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< Position of the mesh's origin.
  double yaw_rad = 0.0;                                  ///< Left from east.
  bool on_ground = true;  ///< Then position_m.z() counts from the terrain's height.
  double scale = 1.0;     ///< Metres for each unit of the mesh.
  bool solid = true;      ///< Machines collide with it (sim/scene/convex_pieces.h).
  Material material{.reflectance = 0.6, .label = "object"};
  std::vector<NamedMaterial> materials;  ///< Materials of named parts; the others have `material`.
};
void visit(fields::Visitor& v, FixedObject& p);

/// A box at a fixed place in the scene: a building, a kerb.
struct BoxObject {
  std::string name;
  Eigen::Vector3d size_m = Eigen::Vector3d::Ones();      ///< Full lengths along its own axes.
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< Middle of its base.
  /// Direction of its x axis, left from east.
  double yaw_rad = 0.0;
  bool on_ground = true;   ///< Then position_m.z() counts from the terrain's height at the middle.
  bool solid = true;       ///< Machines collide with it, and plants keep clear of it.
  bool loose = false;      ///< A crate: machines push and lift it. Solid in any case.
  double mass_kg = 500.0;  ///< Mass of a loose box.
  double friction = 0.6;
  Material material{.reflectance = 0.5, .label = "building"};
};
void visit(fields::Visitor& v, BoxObject& p);

using Terrain = std::variant<PitTerrain, HillsTerrain, LevelTerrain, HeightMapTerrain>;

struct SceneDescription {
  Terrain terrain;
  std::vector<Track> tracks;  ///< Carved into the terrain, in this order.
  /// What the ground is made of. The first lies everywhere, others where tracks and regions say.
  std::vector<SoilParameters> soils{SoilParameters{}};
  std::vector<SoilRegion> soil_regions;
  std::vector<RockField> rocks;
  std::vector<TreeField> trees;  ///< Cheap: closed crowns, in two meshes.
  std::vector<Forest> forests;   ///< Leaf by leaf.
  std::vector<GrassField> grass;
  std::vector<BoxObject> boxes;
  std::vector<FixedObject> objects;
};

/// Throw std::invalid_argument naming the key, the value and what is allowed.
void validate(const PitTerrain& terrain);
void validate(const RockField& rocks);
void validate(const BoxObject& box);
void validate(const FixedObject& object);
void visit(fields::Visitor& v, SceneDescription& p);
void validate(const SceneDescription& description);

/// The terrain as heights, tracks carved in; the same seed gives the same heights. Validates.
[[nodiscard]] HeightField make_terrain(const Terrain& terrain, const std::vector<Track>& tracks,
                                       std::uint64_t seed);
[[nodiscard]] const Material& material(const Terrain& terrain);

/// The terrain as heights; the same seed gives the same heights. Validates.
[[nodiscard]] HeightField make_pit(const PitTerrain& terrain, std::uint64_t seed);

/// One boulder, ready to be instanced.
struct PlacedRock {
  std::size_t shape = 0;  ///< 0 .. kRockShapes-1.
  Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
  double radius_m = 0.5;
};
inline constexpr std::size_t kRockShapes = 8;

/// Rocks on the terrain, about a third sunk in. A field whose keep-outs leave no room has fewer
/// rocks than asked for. Validates.
[[nodiscard]] std::vector<PlacedRock> place_rocks(const RockField& rocks, const HeightField& ground,
                                                  RandomStream& random);

/// Where an object, or the middle of a box, is in the world.
[[nodiscard]] Eigen::Isometry3d object_pose(const FixedObject& object, const HeightField& ground);
[[nodiscard]] Eigen::Isometry3d box_pose(const BoxObject& box, const HeightField& ground);

/// A loose body as rays see it: its mesh in the body's frame.
struct LooseLook {
  Scene::MeshId mesh = 0;
  Material material;
};

/// A scene and the ground and obstacles for machines: Ground(ground, soils, obstacles).
struct BuiltScene {
  std::unique_ptr<Scene> scene;
  Scene::InstanceId terrain = 0;
  HeightField ground;
  SoilMap soils;
  /// Rocks as spheres that reach as high as they on average do, trunks as cylinders, boxes, and
  /// solid mesh objects as the convex hulls of their parts.
  std::vector<Obstacle> obstacles;
  /// What rays see of those that may give way, trees; in the order of the obstacles.
  std::vector<ObstacleLook> looks;
  /// Rocks and crates that lie loose, for Ground::set_loose(); each becomes a body of the scene
  /// (Scene::add_loose_body()), after those of the machine's links.
  std::vector<LooseBody> loose;
  std::vector<LooseLook> loose_looks;
};

/// Edges of boxes and meshes are split to this length.
inline constexpr double kLongestEdge_m = 16.0;

/// Builds everything fixed. `meshes` holds the meshes that the objects name, several of one name
/// for one of several materials; a missing one, or a material that none of its parts has, throws
/// std::invalid_argument naming the object and what there is. Machine links are added afterwards
/// with Scene::add_body().
[[nodiscard]] BuiltScene build_scene(const SceneDescription& description,
                                     const std::vector<TriangleMesh>& meshes, std::uint64_t seed);

}  // namespace rigwire::sim
