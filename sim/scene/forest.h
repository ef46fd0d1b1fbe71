// Forests modelled leaf by leaf: trees of several species, bushes, fallen trunks.
//
// A few models of each species (sim/scene/tree_model.h) are built once and placed in the scene as
// thousands of instances, turned and scaled. The cheaper alternative, closed crowns in one mesh, is
// sim/scene/trees.h.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "fields/rules.h"
#include "sim/ground/ground.h"
#include "sim/scene/keep_out.h"
#include "sim/scene/scene.h"
#include "sim/scene/tree_model.h"
#include "sim/scene/trees.h"

namespace rigwire::sim {

/// One species' part of a forest.
struct SpeciesShare {
  Species species = Species::spruce;
  double share = 1.0;        ///< Weight of the species among all trees.
  double smallest_m = 14.0;  ///< Minimum height.
  double largest_m = 25.0;   ///< Maximum height; uniform between.
};
void visit(fields::Visitor& v, SpeciesShare& p);

struct Forest {
  int count = 0;                ///< 0: by density.
  double density_per_ha = 450;  ///< Stems per hectare of the rectangle, tracks included.
  std::uint64_t seed = 0;       ///< Another forest on the same ground.
  Eigen::Vector2d centre_m{0.0, 0.0};
  Eigen::Vector2d half_lengths_m{100.0, 100.0};  ///< [east, north].
  std::vector<SpeciesShare> species{SpeciesShare{}};
  int variants = 3;  ///< Models of each species.
  LeafModel leaf_model = LeafModel::cards;
  double track_distance_m = 1.5;  ///< From a track's edge to a trunk's axis, at least.
  double spacing_m = 2.0;         ///< Between trunks, at least (Poisson disc).
  double bushes_per_ha = 150.0;   ///< Between the trees, 0.6 to 2.5 m high.
  double fallen_per_ha = 15.0;    ///< Trunks on the ground, 3 to 12 m long.
  std::vector<KeepOut> keep_out;
  Material wood{.reflectance = 0.3, .label = "trunk"};
  Material leaves{.reflectance = 0.5, .label = "crown", .loose_leaves = true};
  Material bush{.reflectance = 0.5, .label = "bush", .loose_leaves = true};
  Material fallen{.reflectance = 0.25, .label = "fallen trunk"};
};
void visit(fields::Visitor& v, Forest& p);

/// Throw std::invalid_argument naming the key, the value and what is allowed.
void validate(const SpeciesShare& share);
void validate(const Forest& forest);

/// Puts the forest on the ground: instances and, for radio signals, one canopy of the outlines of
/// all crowns. Standing trunks become obstacles, as cylinders; fallen ones as boxes. Validates.
void add_forest(const Forest& forest, const HeightField& ground, std::span<const ClearWay> ways,
                std::span<const KeepOut> keep_out, std::uint64_t seed, Scene& scene,
                std::vector<Obstacle>& obstacles, std::vector<ObstacleLook>& looks);

}  // namespace rigwire::sim
