// Forests: trees strewn over a rectangle, off the tracks.
//
// The trees of a square of kTreeTile_m are two meshes, trunks and crowns: few instances are quick
// to place and to cast at, and when one tree is pushed over, what must be built anew is small.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "fields/rules.h"
#include "sim/ground/ground.h"
#include "sim/random.h"
#include "sim/scene/height_field.h"
#include "sim/scene/keep_out.h"
#include "sim/scene/scene.h"
#include "sim/scene/track.h"
#include "sim/scene/triangle_mesh.h"

namespace rigwire::sim {

struct TreeField {
  int count = 0;                ///< 0: by density.
  double density_per_ha = 300;  ///< Trees per hectare of the rectangle, tracks included.
  std::uint64_t seed = 0;       ///< Another forest on the same ground.
  Eigen::Vector2d centre_m{0.0, 0.0};
  Eigen::Vector2d half_lengths_m{100.0, 100.0};  ///< [east, north].
  double smallest_m = 6.0;                       ///< Height; uniform up to the largest.
  double largest_m = 22.0;
  double trunk_diameter_m = 0.45;  ///< For a tree of the largest height; others in proportion.
  double conifer_share = 0.6;      ///< The rest have round crowns.
  double track_distance_m = 1.5;   ///< From a track's edge to a trunk's axis, at least.
  double spacing_m = 1.5;          ///< Between trunks, at least.
  std::vector<KeepOut> keep_out;
  Material trunk{.reflectance = 0.3, .label = "trunk"};
  Material crown{.reflectance = 0.5, .label = "crown", .foliage = true};
};
void visit(fields::Visitor& v, TreeField& p);

/// Throws std::invalid_argument naming the key, the value and what is allowed.
void validate(const TreeField& trees);

struct PlacedTree {
  Eigen::Vector3d foot_m = Eigen::Vector3d::Zero();  ///< On the ground.
  double height_m = 10.0;
  double trunk_diameter_m = 0.2;
  double yaw_rad = 0.0;
  bool conifer = true;
};

/// A way with the width that trees keep off.
struct ClearWay {
  const TrackLine* line = nullptr;
  double half_width_m = 2.0;
};

/// A field without room has fewer trees than asked for. Validates.
[[nodiscard]] std::vector<PlacedTree> place_trees(const TreeField& trees, const HeightField& ground,
                                                  std::span<const ClearWay> ways,
                                                  std::span<const KeepOut> keep_out,
                                                  RandomStream& random);

/// All trunks, and all crowns, as one mesh each; world coordinates less `origin_m`. The trunk
/// begins a little below the ground and ends within the crown.
struct ForestMeshes {
  TriangleMesh trunks;
  TriangleMesh crowns;
  /// First triangle of each tree in trunks and crowns, in their order; one entry more than trees.
  std::vector<std::array<std::uint32_t, 2>> first_triangles;
};
inline constexpr double kTreeTile_m = 64.0;
[[nodiscard]] ForestMeshes forest_meshes(std::span<const PlacedTree> trees,
                                         const Eigen::Vector3d& origin_m);

/// Returns the obstacle for machines: the trunk up to the crown.
[[nodiscard]] Obstacle trunk_obstacle(const PlacedTree& tree);

}  // namespace rigwire::sim
