#include "sim/scene/forest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "sim/scene/scene_description.h"

namespace rigwire::sim {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr SimTime kForestT0 = kStart;
constexpr SimTime kForestT1 = kStart + std::chrono::milliseconds{1};

SceneDescription small_forest() {
  SceneDescription description;
  LevelTerrain terrain;
  terrain.size_m = 120.0;
  terrain.roughness_m = 0.0;
  description.terrain = terrain;
  Forest forest;
  forest.half_lengths_m = {40.0, 40.0};
  forest.variants = 1;
  forest.species = {{Species::spruce, 3.0, 14.0, 24.0}, {Species::beech, 1.0, 12.0, 20.0}};
  description.forests = {forest};
  return description;
}

TEST(TreeModel, HasThousandsOfTrianglesAndATreesMeasures) {
  for (const auto species :
       {Species::spruce, Species::pine, Species::beech, Species::oak, Species::birch}) {
    const TreeModel tree = make_tree_model(species, LeafModel::cards, 1, 0);
    SCOPED_TRACE(tree.wood.name);
    EXPECT_NO_THROW(validate(tree.wood));
    EXPECT_NO_THROW(validate(tree.leaves));
    const std::size_t triangles = tree.wood.triangles.size() + tree.leaves.triangles.size();
    EXPECT_GE(triangles, 3000U);
    EXPECT_LE(triangles, 5000U);
    float top = 0.0F;
    float reach = 0.0F;
    for (const auto* mesh : {&tree.wood, &tree.leaves}) {
      for (const auto& vertex : mesh->vertices) {
        top = std::max(top, vertex.z());
        reach = std::max(reach, vertex.head<2>().norm());
      }
    }
    EXPECT_NEAR(top, tree.height_m, 1.5);
    EXPECT_GT(reach, 1.5F);
    EXPECT_LT(reach, 7.0F);
    // Leaf area over the crown's shade: closed stands have an index of 3 to 9.
    double shade_m2 = 0.0;
    for (const Ring& ring : tree.crown) {
      shade_m2 = std::max(shade_m2, 3.14159 * ring.radius_m * ring.radius_m);
    }
    EXPECT_GT(leaf_area_m2(tree) / shade_m2, 3.0);
    EXPECT_LT(leaf_area_m2(tree) / shade_m2, 9.0);
  }
}

TEST(TreeModel, SeedAndVariantMakeTheTree) {
  const auto leaves = [](std::uint64_t seed, int variant) {
    return make_tree_model(Species::oak, LeafModel::cards, seed, variant).leaves.vertices;
  };
  EXPECT_EQ(leaves(1, 0), leaves(1, 0));
  EXPECT_NE(leaves(1, 0), leaves(1, 1));
  EXPECT_NE(leaves(1, 0), leaves(2, 0));
}

TEST(TreeModel, LooseTrianglesHaveNoMaskAndAboutTheSameArea) {
  const TreeModel cards = make_tree_model(Species::spruce, LeafModel::cards, 1, 0);
  const TreeModel loose = make_tree_model(Species::spruce, LeafModel::triangles, 1, 0);
  EXPECT_FALSE(loose.leaves.alpha);
  EXPECT_NEAR(leaf_area_m2(loose) / leaf_area_m2(cards), 1.0, 0.3);
}

TEST(Forest, StemsKeepDensityAndSpacing) {
  SceneDescription description = small_forest();
  const BuiltScene built = build_scene(description, {}, 1);
  std::vector<Eigen::Vector2d> stems;
  for (const Obstacle& obstacle : built.obstacles) {
    if (obstacle.shape == ObstacleShape::cylinder) {
      stems.emplace_back(obstacle.X_WO.translation().head<2>());
    }
  }
  EXPECT_NEAR(static_cast<double>(stems.size()), 450.0 * 0.64, 3.0);
  for (std::size_t i = 0; i < stems.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      ASSERT_GE((stems[i] - stems[k]).norm(), description.forests[0].spacing_m);
    }
  }
}

TEST(Forest, RaysTellWoodFromLeavesAndTreesByName) {
  const BuiltScene built = build_scene(small_forest(), {}, 1);
  Scene& scene = *built.scene;
  scene.begin_slice(kForestT0, kForestT1, Vector3d::Zero(), {});
  RandomStream random(1, "rays");
  std::map<std::string, int> labels;
  std::set<std::string> trees;
  for (int i = 0; i < 20000; ++i) {
    const Vector3d direction =
        Vector3d(random.gaussian(), random.gaussian(), 0.4 * random.gaussian()).normalized();
    const auto hit = scene.cast({0.0, 0.0, 2.5}, direction, 0.5, 60.0, kForestT0);
    if (!hit) {
      continue;
    }
    ++labels[scene.label(hit->instance)];
    if (scene.label(hit->instance) == "crown") {
      trees.insert(scene.name(hit->instance));
      EXPECT_EQ(scene.name(hit->instance), scene.name(hit->instance - 1)) << "its wood";
      EXPECT_EQ(scene.label(hit->instance - 1), "trunk");
    }
  }
  EXPECT_GT(labels["ground"], 1000);
  EXPECT_GT(labels["trunk"], 300);
  EXPECT_GT(labels["crown"], 1000);
  EXPECT_GT(labels["bush"], 20);
  EXPECT_GT(trees.size(), 10U);
  EXPECT_THAT(*trees.begin(),
              testing::AnyOf(testing::StartsWith("beech "), testing::StartsWith("spruce ")));
}

TEST(Forest, SatellitesSeeCrownsAsFoliageAndTrunksAsWalls) {
  Scene scene;
  std::vector<Obstacle> obstacles;
  HeightField ground;
  ground.cell_m = 100.0;
  ground.origin_m = {-100.0, -100.0};
  ground.columns = ground.rows = 3;
  ground.heights_m.assign(9, 0.0);
  Forest forest;
  forest.count = 1;
  forest.half_lengths_m = {0.5, 0.5};
  forest.species = {{Species::spruce, 1.0, 20.0, 20.0}};
  forest.bushes_per_ha = forest.fallen_per_ha = 0.0;
  std::vector<ObstacleLook> looks;
  add_forest(forest, ground, {}, {}, 1, scene, obstacles, looks);
  scene.begin_slice(kForestT0, kForestT1, Vector3d::Zero(), {});
  ASSERT_EQ(obstacles.size(), 1U);
  const Vector3d stem = obstacles[0].X_WO.translation();
  // Level through the crown at half its height, beside the stem.
  const Vector3d p(stem.x() - 30.0, stem.y() + 0.6, 11.0);
  const SkyPath path = scene.sky_path(p, Vector3d::UnitX(), 0.05);
  EXPECT_GT(path.foliage_m, 1.0);
  EXPECT_LT(path.foliage_m, 4.5);
  const SkyPath above = scene.sky_path({p.x(), p.y(), 21.0}, Vector3d::UnitX(), 0.05);
  EXPECT_FALSE(above.blocked);
  EXPECT_EQ(above.foliage_m, 0.0);
  const SkyPath low = scene.sky_path({p.x(), stem.y(), 1.5}, Vector3d::UnitX(), 0.05);
  EXPECT_TRUE(low.blocked) << "the stem";
  EXPECT_EQ(low.foliage_m, 0.0);
  // Loose leaves are no walls to radio; light stops at some of them.
  int light = 0;
  int radio = 0;
  RandomStream random(1, "rays");
  for (int i = 0; i < 2000; ++i) {
    const Vector3d q(p.x(), stem.y() + random.uniform(-1.5, 1.5), random.uniform(6.0, 14.0));
    light += scene.blocked(q, Vector3d::UnitX(), 0.05) ? 1 : 0;
    radio += scene.surface(q, Vector3d::UnitX(), 0.05, 100.0).has_value() ? 1 : 0;
  }
  EXPECT_GT(light, 400);
  EXPECT_LT(radio, light / 2) << "stem, branches and twigs alone";
}

TEST(Forest, NothingGrowsAtDensityZero) {
  SceneDescription description = small_forest();
  Forest& forest = description.forests[0];
  forest.density_per_ha = forest.bushes_per_ha = forest.fallen_per_ha = 0.0;
  const BuiltScene built = build_scene(description, {}, 1);
  EXPECT_EQ(built.scene->instance_count(), 1U) << "the ground alone";
  built.scene->begin_slice(kForestT0, kForestT1, Vector3d::Zero(), {});
  EXPECT_EQ(built.scene->sky_path({0, 0, 1}, Vector3d::UnitZ(), 0.05).foliage_m, 0.0);
}

TEST(Forest, SameSeedSameHits) {
  const auto ranges = [](std::uint64_t seed) {
    const BuiltScene built = build_scene(small_forest(), {}, seed);
    built.scene->begin_slice(kForestT0, kForestT1, Vector3d::Zero(), {});
    RandomStream random(9, "rays");
    std::vector<double> found;
    for (int i = 0; i < 2000; ++i) {
      const Vector3d direction =
          Vector3d(random.gaussian(), random.gaussian(), random.gaussian()).normalized();
      const auto hit = built.scene->cast({0, 0, 2.5}, direction, 0.5, 60.0, kForestT0);
      found.push_back(hit ? hit->range_m : 0.0);
    }
    return found;
  };
  const auto first = ranges(1);
  EXPECT_EQ(first, ranges(1));
  EXPECT_NE(first, ranges(2));
}

TEST(Forest, BadForestsAreRefusedNamingTheMember) {
  const auto refused = [](auto&& change, const char* what) {
    Forest forest;
    change(forest);
    EXPECT_THAT([&] { validate(forest); }, ThrowsMessage<std::invalid_argument>(HasSubstr(what)));
  };
  refused([](Forest& f) { f.density_per_ha = 1e9; }, "density: found");
  refused([](Forest& f) { f.bushes_per_ha = -1.0; }, "bushes: found -1 1/ha");
  refused([](Forest& f) { f.species.clear(); }, "species: there is none");
  refused([](Forest& f) { f.species[0].share = 0.0; }, "species: sum of the shares, found 0");
  refused([](Forest& f) { f.species[0].largest_m = 1.0; },
          "species.0.largest: not below the smallest, found 1 m");
  refused([](Forest& f) { f.variants = 0; }, "variants: found 0, allowed 1 .. 100");
  refused([](Forest& f) { f.leaves.reflectance = 2.0; },
          "leaves.reflectance: found 2, allowed 0 .. 1");
}

}  // namespace
}  // namespace rigwire::sim
