// Trees with structure: trunk, branches, twigs, and leaves that light passes between.
//
// A tree is grown by rule, not measured: a straight, tapering trunk; branches around it by the
// golden angle, as long as the crown's outline lets them; twigs to both sides of a branch; cards
// with a texture of leaves (sim/scene/leaf_masks.h) along the twigs. Heights, stem diameters and
// crowns are of the size that forest inventories of central Europe give for closed stands; leaf
// areas by leaf_area_m2().
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "sim/scene/revolution.h"
#include "sim/scene/scene.h"

namespace rigwire::sim {

enum class Species : std::uint8_t { spruce, pine, beech, oak, birch, bush };
inline constexpr std::array<std::string_view, 6> kSpeciesNames{"spruce", "pine",  "beech",
                                                               "oak",    "birch", "bush"};

/// How leaves are modelled: cards that rays pass where their texture has gaps, or, cheaper to cast
/// at, as many loose triangles of half the card's area.
enum class LeafModel : std::uint8_t { cards, triangles };

struct TreeModel {
  TriangleMesh wood;
  TriangleMesh leaves;
  double height_m = 20.0;       ///< Height as modelled; instances are scaled.
  double trunk_radius_m = 0.2;  ///< At breast height.
  double crown_base_m = 5.0;    ///< Lowest branch.
  std::vector<Ring> crown;      ///< Closed outline of the crown, for radio signals.
};

/// Foot at the origin, a little below the ground; z up. About 4000 triangles, a bush 1000. The
/// same species, variant and seed give the same tree.
[[nodiscard]] TreeModel make_tree_model(Species species, LeafModel leaves, std::uint64_t seed,
                                        int variant);

/// One side of all leaves, holes taken off.
[[nodiscard]] double leaf_area_m2(const TreeModel& model);

}  // namespace rigwire::sim
