#include "sim/scene/forest.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <string>

#include "fields/check.h"
#include "fields/visitor.h"
#include "sim/scene/range_checks.h"
#include "sim/scene/trunk_strength.h"

namespace rigwire::sim {

using fields::in;
using fields::IntegerRule;
using fields::plain;

namespace {

constexpr double kFriction = 0.6;
/// Radius of a fallen trunk's thick end as share of its length; the model is 1 m long and scaled.
constexpr double kFallenRadius = 0.022;
constexpr double kLongestFallen_m = 12.0;

Eigen::Isometry3d standing(const Eigen::Vector3d& foot_m, double yaw_rad) {
  Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
  X_WM.linear() = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  X_WM.translation() = foot_m;
  return X_WM;
}

/// Models in use, built when first needed.
class Nursery {
 public:
  Nursery(const Forest& forest, std::uint64_t seed, Scene& scene)
      : forest_(forest), seed_(seed), scene_(scene) {}

  struct Grown {
    TreeModel model;
    Scene::MeshId mesh = 0;
  };

  const Grown& model(Species species, int variant) {
    const auto key = std::pair(species, variant);
    if (const auto found = grown_.find(key); found != grown_.end()) {
      return found->second;
    }
    Grown grown{make_tree_model(species, forest_.leaf_model, seed_, variant)};
    const bool bush = species == Species::bush;
    grown.mesh = scene_.add_model(
        std::vector<MeshPart>{{grown.model.wood, bush ? forest_.bush : forest_.wood},
                              {grown.model.leaves, bush ? forest_.bush : forest_.leaves}});
    return grown_.emplace(key, std::move(grown)).first->second;
  }

 private:
  const Forest& forest_;
  std::uint64_t seed_;
  Scene& scene_;
  std::map<std::pair<Species, int>, Grown> grown_;
};

TreeField as_field(const Forest& forest, int count, double density_per_ha, double spacing_m) {
  TreeField field;
  field.count = count;
  field.density_per_ha = density_per_ha;
  field.centre_m = forest.centre_m;
  field.half_lengths_m = forest.half_lengths_m;
  field.track_distance_m = forest.track_distance_m;
  field.spacing_m = spacing_m;
  field.keep_out = forest.keep_out;
  return field;
}

const SpeciesShare& drawn(const std::vector<SpeciesShare>& all, double p) {
  double total = 0.0;
  for (const SpeciesShare& one : all) {
    total += one.share;
  }
  double left = p * total;
  for (const SpeciesShare& one : all) {
    left -= one.share;
    if (left < 0.0) {
      return one;
    }
  }
  return all.back();
}

void add_crown(const TreeModel& model, const Eigen::Vector3d& foot_m, double yaw_rad, double scale,
               TriangleMesh& canopy) {
  constexpr int kSides = 9;
  std::vector<Ring> rings = model.crown;
  for (Ring& ring : rings) {
    ring.radius_m *= scale;
    ring.z_m *= scale;
  }
  add_revolution(canopy, foot_m, yaw_rad, kSides, rings);
}

Wood wood_of(Species species) {
  return species == Species::spruce ? Wood::spruce
         : species == Species::pine ? Wood::pine
                                    : Wood::broadleaf;
}

void add_trees(const Forest& forest, std::span<const PlacedTree> trees, RandomStream& random,
               Nursery& nursery, Scene& scene, std::vector<Obstacle>& obstacles,
               std::vector<ObstacleLook>& looks) {
  TriangleMesh canopy;
  canopy.name = "canopy";
  const Eigen::Vector3d origin = trees.front().foot_m;
  std::size_t number = 0;
  std::vector<ObstacleLook> crowns;
  for (const PlacedTree& tree : trees) {
    const SpeciesShare& kind = drawn(forest.species, random.uniform());
    const auto variant = static_cast<int>(random.bits() % static_cast<unsigned>(forest.variants));
    const double height = random.uniform(kind.smallest_m, kind.largest_m);
    const Nursery::Grown& grown = nursery.model(kind.species, variant);
    const double scale = height / grown.model.height_m;
    const auto name = std::string(kSpeciesNames[static_cast<std::size_t>(kind.species)]) + " " +
                      std::to_string(number++);
    looks.push_back(
        {obstacles.size(),
         {scene.add_model_object(grown.mesh, standing(tree.foot_m, tree.yaw_rad), scale, name)}});
    const auto first = static_cast<std::uint32_t>(canopy.triangles.size());
    add_crown(grown.model, tree.foot_m - origin, tree.yaw_rad, scale, canopy);
    crowns.push_back(
        {obstacles.size(),
         {0, true, first, static_cast<std::uint32_t>(canopy.triangles.size()) - first}});
    Obstacle& trunk = obstacles.emplace_back();
    trunk.shape = ObstacleShape::cylinder;
    const double radius = scale * grown.model.trunk_radius_m;
    const double half_height = 0.5 * std::max(2.0, scale * grown.model.crown_base_m);
    trunk.half_lengths_m = {radius, radius, half_height};
    trunk.X_WO.translation() = tree.foot_m + Eigen::Vector3d(0.0, 0.0, half_height);
    trunk.friction = kFriction;
    trunk.name = name;
    root(trunk, wood_of(kind.species), 2.0 * radius, height);
  }
  const Scene::CanopyId added = scene.add_canopy(canopy, standing(origin, 0.0));
  for (ObstacleLook& crown : crowns) {
    crown.piece.thing = added;
    looks.push_back(crown);
  }
}

void add_bushes(const Forest& forest, std::span<const PlacedTree> spots, RandomStream& random,
                Nursery& nursery, Scene& scene) {
  constexpr double kSmallest_m = 0.6;
  constexpr double kLargest_m = 2.5;
  std::size_t number = 0;
  for (const PlacedTree& spot : spots) {
    const auto variant = static_cast<int>(random.bits() % static_cast<unsigned>(forest.variants));
    const Nursery::Grown& grown = nursery.model(Species::bush, variant);
    scene.add_model_object(grown.mesh, standing(spot.foot_m, spot.yaw_rad),
                           random.uniform(kSmallest_m, kLargest_m) / grown.model.height_m,
                           "bush " + std::to_string(number++));
  }
}

void add_fallen(const Forest& forest, std::span<const PlacedTree> spots, const HeightField& ground,
                RandomStream& random, Scene& scene, std::vector<Obstacle>& obstacles) {
  constexpr int kSides = 8;
  constexpr double kShortest_m = 3.0;
  TriangleMesh log;
  log.name = "fallen trunk";
  // Along x, 1 m long, closed at both ends.
  const std::array<TubePoint, 2> butt{
      {{{-0.499, 0.0, 0.0}, kFallenRadius}, {{-0.5, 0.0, 0.0}, 0.0}}};
  const std::array<TubePoint, 4> stem{{{{-0.499, 0.0, 0.0}, kFallenRadius},
                                       {{0.0, 0.0, 0.0}, 0.85 * kFallenRadius},
                                       {{0.499, 0.0, 0.0}, 0.7 * kFallenRadius},
                                       {{0.5, 0.0, 0.0}, 0.0}}};
  add_tube(log, butt, kSides);
  add_tube(log, stem, kSides);
  const Scene::MeshId mesh = scene.add_mesh(log);
  std::size_t number = 0;
  for (const PlacedTree& spot : spots) {
    const double length = random.uniform(kShortest_m, kLongestFallen_m);
    const Eigen::Vector3d flat(std::cos(spot.yaw_rad), std::sin(spot.yaw_rad), 0.0);
    const auto end = [&](double side) {
      Eigen::Vector3d p = spot.foot_m + 0.5 * side * length * flat;
      p.z() = ground.height_m(p.x(), p.y());
      return p;
    };
    const Eigen::Vector3d along = (end(1.0) - end(-1.0)).normalized();
    const double radius = kFallenRadius * length;
    Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
    X_WM.linear().col(0) = along;
    X_WM.linear().col(1) = Eigen::Vector3d::UnitZ().cross(along).normalized();
    X_WM.linear().col(2) = along.cross(X_WM.linear().col(1));
    X_WM.translation() = 0.5 * (end(1.0) + end(-1.0)) + Eigen::Vector3d(0.0, 0.0, 0.7 * radius);
    scene.add_object(mesh, X_WM, length, forest.fallen, "fallen trunk " + std::to_string(number++));
    Obstacle& obstacle = obstacles.emplace_back();
    obstacle.shape = ObstacleShape::box;
    obstacle.X_WO = X_WM;
    obstacle.half_lengths_m = {0.5 * length, 0.8 * radius, 0.8 * radius};
    obstacle.friction = kFriction;
  }
}

constexpr double kMostTrees = 50'000.0;
constexpr double kTallest_m = 80.0;

constexpr std::array<fields::Choice<Species>, 5> kTreeSpecies{
    {{Species::spruce, "spruce", "Cone to near the ground, needles."},
     {Species::pine, "pine", "Bare stem, crown at the top, needles."},
     {Species::beech, "beech", "Wide round crown."},
     {Species::oak, "oak", "Widest crown, thick branches."},
     {Species::birch, "birch", "Slim, hanging twigs."}}};
constexpr std::array<fields::Choice<LeafModel>, 2> kLeafModels{
    {{LeafModel::cards, "cards", "Cards that rays pass where the texture has gaps."},
     {LeafModel::triangles, "triangles", "Loose triangles: cheaper to cast at."}}};

}  // namespace

void visit(fields::Visitor& v, SpeciesShare& p) {
  v.choice("species", p.species, kTreeSpecies, "Species of these trees.");
  v.number("share", p.share, plain().between(0, 1e6),
           "Share of all trees, weighed against the others' shares.");
  v.number("smallest", p.smallest_m, in("m").between(0.3, kTallest_m),
           "Height of the smallest of these trees.");
  v.number("largest", p.largest_m, in("m").between(0.3, kTallest_m),
           "Height of the largest of these trees.");
}

void visit(fields::Visitor& v, Forest& p) {
  constexpr fields::NumberRule kPerHectare = in("1/ha").stored_as("1/ha").between(0, 20'000);
  v.integer("count", p.count, IntegerRule{0, static_cast<std::int64_t>(kMostTrees)},
            "Number of trees; 0 = by density.");
  v.only_if(p.count == 0, "count", "count: 0", [&p, &kPerHectare](fields::Visitor& w) {
    w.number("density", p.density_per_ha, kPerHectare,
             "Trees per area of the rectangle, tracks included.");
  });
  v.integer("seed", p.seed, IntegerRule{0}, "Another forest on the same ground.");
  v.vector2("centre", p.centre_m, in("m").between(-4000, 4000), "[east, north] of the rectangle.");
  v.vector2("half_lengths", p.half_lengths_m, in("m").between(0.5, 4000),
            "[east, north] from the centre to the rectangle's edges.");
  v.list("species", p.species, "Species of the trees.");
  v.integer("variants", p.variants, IntegerRule{1, 100}, "Models of each species.");
  v.choice("leaf_model", p.leaf_model, kLeafModels, "How leaves are modelled.");
  v.number("track_distance", p.track_distance_m, in("m").between(0, 1000),
           "Least distance from a track's edge to a trunk.");
  v.number("spacing", p.spacing_m, in("m").between(0, 100), "Least distance between trunks.");
  v.number("bushes", p.bushes_per_ha, kPerHectare, "Bushes per area of the rectangle.");
  v.number("fallen", p.fallen_per_ha, kPerHectare,
           "Trunks on the ground per area of the rectangle.");
  v.list("keep_out", p.keep_out, "Discs without trees.");
  v.section("wood", p.wood, "Surface of trunks, branches and twigs.");
  v.section("leaves", p.leaves, "Surface of the leaves.");
  v.section("bush", p.bush, "Surface of the bushes.");
  v.section("fallen_wood", p.fallen, "Surface of the fallen trunks.");
}

void validate(const SpeciesShare& share) {
  fields::check(share);
  require_within(share.largest_m, share.smallest_m, kTallest_m, "m", "largest",
                 "not below the smallest");
}

void validate(const Forest& forest) {
  fields::check(forest);
  const double hectares = 4e-4 * forest.half_lengths_m.prod();
  require_within(forest.density_per_ha * hectares, 0.0, kMostTrees, "", "density",
                 "trees by the rectangle's area");
  require_within(forest.bushes_per_ha * hectares, 0.0, kMostTrees, "", "bushes",
                 "bushes by the rectangle's area");
  require_within(forest.fallen_per_ha * hectares, 0.0, kMostTrees, "", "fallen",
                 "trunks by the rectangle's area");
  if (forest.species.empty()) {
    throw fields::Refused("species", "there is none");
  }
  double total = 0.0;
  for (const SpeciesShare& kind : forest.species) {
    total += kind.share;
  }
  require_within(total, 1e-9, 1e9, "", "species", "sum of the shares");
}

void add_forest(const Forest& forest, const HeightField& ground, std::span<const ClearWay> ways,
                std::span<const KeepOut> keep_out, std::uint64_t seed, Scene& scene,
                std::vector<Obstacle>& obstacles, std::vector<ObstacleLook>& looks) {
  validate(forest);
  constexpr double kBushSpacing_m = 1.0;
  constexpr double kFallenSpacing_m = 3.0;
  const auto spots = [&](const char* what, const TreeField& field) {
    RandomStream random(seed + forest.seed, std::string("scene/forest/") + what);
    return place_trees(field, ground, ways, keep_out, random);
  };
  Nursery nursery(forest, seed + forest.seed, scene);
  RandomStream random(seed + forest.seed, "scene/forest/kinds");
  if (const auto trees =
          spots("trees", as_field(forest, forest.count, forest.density_per_ha, forest.spacing_m));
      !trees.empty()) {
    add_trees(forest, trees, random, nursery, scene, obstacles, looks);
  }
  add_bushes(forest, spots("bushes", as_field(forest, 0, forest.bushes_per_ha, kBushSpacing_m)),
             random, nursery, scene);
  TreeField clear_of_tracks = as_field(forest, 0, forest.fallen_per_ha, kFallenSpacing_m);
  clear_of_tracks.track_distance_m += 0.5 * kLongestFallen_m;
  if (const auto fallen = spots("fallen", clear_of_tracks); !fallen.empty()) {
    add_fallen(forest, fallen, ground, random, scene, obstacles);
  }
}

}  // namespace rigwire::sim
