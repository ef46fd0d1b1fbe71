#include "sim/scene/trees.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <unordered_map>

#include "fields/check.h"
#include "fields/visitor.h"
#include "sim/scene/range_checks.h"
#include "sim/scene/revolution.h"
#include "sim/scene/trunk_strength.h"

namespace rigwire::sim {

using fields::in;
using fields::IntegerRule;
using fields::plain;

namespace {

/// Where the crown begins, as a share of the height.
constexpr double kConiferCrownBase = 0.15;
constexpr double kRoundCrownBase = 0.35;
constexpr double kTreeBelowGround_m = 0.3;
constexpr int kTrunkSides = 8;
constexpr int kCrownSides = 9;

/// Stores the trees' places by cells of the spacing.
class Stand {
 public:
  explicit Stand(double spacing_m) : spacing_m_(std::max(spacing_m, 1e-3)) {}

  [[nodiscard]] bool free(const Eigen::Vector2d& spot) const {
    for (std::int64_t dx = -1; dx <= 1; ++dx) {
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        const auto [begin, end] = cells_.equal_range(key(spot, dx, dy));
        for (auto it = begin; it != end; ++it) {
          if ((it->second - spot).norm() < spacing_m_) {
            return false;
          }
        }
      }
    }
    return true;
  }
  void add(const Eigen::Vector2d& spot) { cells_.emplace(key(spot, 0, 0), spot); }

 private:
  [[nodiscard]] std::int64_t key(const Eigen::Vector2d& spot, std::int64_t dx,
                                 std::int64_t dy) const {
    const auto x = static_cast<std::int64_t>(std::floor(spot.x() / spacing_m_)) + dx;
    const auto y = static_cast<std::int64_t>(std::floor(spot.y() / spacing_m_)) + dy;
    return x * 0x100000000LL + y;
  }

  double spacing_m_;
  std::unordered_multimap<std::int64_t, Eigen::Vector2d> cells_;
};

}  // namespace

void visit(fields::Visitor& v, TreeField& p) {
  v.integer("count", p.count, IntegerRule{0, 50'000}, "Number of trees; 0 = by density.");
  v.only_if(p.count == 0, "count", "count: 0", [&p](fields::Visitor& w) {
    w.number("density", p.density_per_ha, in("1/ha").stored_as("1/ha").between(0, 20'000),
             "Trees per area of the rectangle, tracks included.");
  });
  v.integer("seed", p.seed, IntegerRule{0}, "Another forest on the same ground.");
  v.vector2("centre", p.centre_m, in("m").between(-4000, 4000), "[east, north] of the rectangle.");
  v.vector2("half_lengths", p.half_lengths_m, in("m").between(0.5, 4000),
            "[east, north] from the centre to the rectangle's edges.");
  v.number("smallest", p.smallest_m, in("m").between(0.5, 100), "Height of the smallest tree.");
  v.number("largest", p.largest_m, in("m").between(0.5, 100), "Height of the largest tree.");
  v.number("trunk_diameter", p.trunk_diameter_m, in("m").between(0.01, 20),
           "Trunk of the largest tree, at most a fifth of its height.");
  v.number("conifer_share", p.conifer_share, plain().between(0, 1),
           "Share of conifers; the rest have round crowns.");
  v.number("track_distance", p.track_distance_m, in("m").between(0, 1000),
           "Least distance from a track's edge to a trunk.");
  v.number("spacing", p.spacing_m, in("m").between(0, 100), "Least distance between trunks.");
  v.list("keep_out", p.keep_out, "Discs without trees.");
  v.section("trunk", p.trunk, "Surface of the trunks.");
  v.section("crown", p.crown, "Surface of the crowns.");
}

void validate(const TreeField& trees) {
  fields::check(trees);
  require_within(trees.density_per_ha * 4e-4 * trees.half_lengths_m.prod(), 0.0, 50'000.0, "",
                 "density", "trees by the rectangle's area");
  require_within(trees.largest_m, trees.smallest_m, 100.0, "m", "largest",
                 "not below the smallest");
  require_within(trees.trunk_diameter_m, 0.01, 0.2 * trees.largest_m, "m", "trunk_diameter",
                 "at most a fifth of the largest height");
}

std::vector<PlacedTree> place_trees(const TreeField& trees, const HeightField& ground,
                                    std::span<const ClearWay> ways,
                                    std::span<const KeepOut> keep_out, RandomStream& random) {
  validate(trees);
  constexpr int kTriesPerTree = 20;
  constexpr double kSquareMetresPerHectare = 1e4;
  const double area_ha = 4.0 * trees.half_lengths_m.prod() / kSquareMetresPerHectare;
  const auto wanted =
      trees.count > 0 ? trees.count : static_cast<int>(std::lround(trees.density_per_ha * area_ha));
  const auto within = [](std::span<const KeepOut> discs, const Eigen::Vector2d& spot) {
    return std::ranges::any_of(
        discs, [&](const KeepOut& disc) { return (spot - disc.centre_m).norm() < disc.radius_m; });
  };
  const auto on_way = [&](const Eigen::Vector2d& spot) {
    return std::ranges::any_of(ways, [&](const ClearWay& way) {
      return way.line->nearest(spot).distance_m < way.half_width_m + trees.track_distance_m;
    });
  };
  Stand stand(trees.spacing_m);
  std::vector<PlacedTree> placed;
  for (int i = 0; i < wanted; ++i) {
    for (int attempt = 0; attempt < kTriesPerTree; ++attempt) {
      const double x = random.uniform(-1.0, 1.0);
      const double y = random.uniform(-1.0, 1.0);
      // Hard-core stand: uniform places, those nearer than the spacing to another drawn again.
      const Eigen::Vector2d spot =
          trees.centre_m + trees.half_lengths_m.cwiseProduct(Eigen::Vector2d(x, y));
      if (within(trees.keep_out, spot) || within(keep_out, spot) || !stand.free(spot) ||
          on_way(spot)) {
        continue;
      }
      stand.add(spot);
      PlacedTree& tree = placed.emplace_back();
      tree.foot_m << spot, ground.height_m(spot.x(), spot.y());
      tree.height_m = random.uniform(trees.smallest_m, trees.largest_m);
      tree.trunk_diameter_m = trees.trunk_diameter_m * tree.height_m / trees.largest_m;
      tree.yaw_rad = random.uniform(0.0, 2.0 * std::numbers::pi);
      tree.conifer = random.uniform() < trees.conifer_share;
      break;
    }
  }
  return placed;
}

/// Trunks and crowns are bodies of revolution whose radii and heights are shares of the tree's
/// height h: the trunk tapers from 0.3 h to its end at 0.6 h, the crown is a double cone or a
/// rounded body.
ForestMeshes forest_meshes(std::span<const PlacedTree> trees, const Eigen::Vector3d& origin_m) {
  ForestMeshes forest;
  forest.trunks.name = "trunks";
  forest.crowns.name = "crowns";
  const auto mark = [&forest] {
    forest.first_triangles.push_back({static_cast<std::uint32_t>(forest.trunks.triangles.size()),
                                      static_cast<std::uint32_t>(forest.crowns.triangles.size())});
  };
  for (const PlacedTree& tree : trees) {
    mark();
    const Eigen::Vector3d foot = tree.foot_m - origin_m;
    const double h = tree.height_m;
    const double r = 0.5 * tree.trunk_diameter_m;
    add_revolution(
        forest.trunks, foot, tree.yaw_rad, kTrunkSides,
        std::array<Ring, 3>{{{r, -kTreeBelowGround_m}, {r, 0.3 * h}, {0.5 * r, 0.6 * h}}});
    if (tree.conifer) {
      add_revolution(forest.crowns, foot, tree.yaw_rad, kCrownSides,
                     std::array<Ring, 4>{{{0.0, kConiferCrownBase * h},
                                          {0.17 * h, (kConiferCrownBase + 0.03) * h},
                                          {0.08 * h, 0.6 * h},
                                          {0.0, h}}});
    } else {
      add_revolution(forest.crowns, foot, tree.yaw_rad, kCrownSides,
                     std::array<Ring, 5>{{{0.0, kRoundCrownBase * h},
                                          {0.2 * h, 0.48 * h},
                                          {0.25 * h, 0.68 * h},
                                          {0.16 * h, 0.9 * h},
                                          {0.0, h}}});
    }
  }
  mark();
  return forest;
}

Obstacle trunk_obstacle(const PlacedTree& tree) {
  const double top_m = (tree.conifer ? kConiferCrownBase : kRoundCrownBase) * tree.height_m;
  Obstacle trunk;
  trunk.shape = ObstacleShape::cylinder;
  const double half_height_m = 0.5 * (std::max(top_m, 2.0) + kTreeBelowGround_m);
  trunk.half_lengths_m = {0.5 * tree.trunk_diameter_m, 0.5 * tree.trunk_diameter_m, half_height_m};
  trunk.X_WO.translation() =
      tree.foot_m + Eigen::Vector3d(0.0, 0.0, half_height_m - kTreeBelowGround_m);
  trunk.friction = 0.6;
  root(trunk, tree.conifer ? Wood::spruce : Wood::broadleaf, tree.trunk_diameter_m, tree.height_m);
  return trunk;
}

}  // namespace rigwire::sim
