// Grass, reed, crops: stalks with a stated density.
//
// Stalks are at random positions in square patches; a few patches are built once and placed side by
// side over a rectangle, each turned by a random quarter, so that stalks are a Poisson process at
// distances up to a patch's size. A level ray at height z hits its first stalk within L with
// probability 1 - exp(-n d(z) L), n stalks per square metre, d(z) = d (1 - z / h) mean width there.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "fields/rules.h"
#include "sim/random.h"
#include "sim/scene/keep_out.h"
#include "sim/scene/scene.h"
#include "sim/scene/trees.h"

namespace rigwire::sim {

struct GrassField {
  Eigen::Vector2d centre_m{0.0, 0.0};
  Eigen::Vector2d half_lengths_m{20.0, 20.0};  ///< [east, north].
  std::uint64_t seed = 0;                      ///< Other grass at the same place.
  double stalks_per_m2 = 120.0;
  double height_m = 0.4;          ///< Height of every stalk.
  double diameter_m = 0.005;      ///< Mean width at the foot, seen from any side; 0 at the tip.
  double lean_rad = 0.15;         ///< Standard deviation of a stalk's lean.
  double patch_m = 2.0;           ///< Edge of a patch.
  double track_distance_m = 0.3;  ///< From a track's edge to a patch's middle, at least.
  std::vector<KeepOut> keep_out;
  Material material{.reflectance = 0.45, .label = "grass", .loose_leaves = true};
};
void visit(fields::Visitor& v, GrassField& p);

/// Throws std::invalid_argument naming the key, the value and what is allowed; patches and a
/// patch's stalks are limited to 500 000 and 200 000.
void validate(const GrassField& grass);

/// Returns a patch with its middle at the origin of level ground, of stalks of three triangles.
[[nodiscard]] TriangleMesh make_grass_patch(const GrassField& grass, RandomStream& random);

/// Places the patches on the ground, tilted with it. Validates.
void add_grass(const GrassField& grass, const HeightField& ground, std::span<const ClearWay> ways,
               std::span<const KeepOut> keep_out, std::uint64_t seed, Scene& scene);

}  // namespace rigwire::sim
