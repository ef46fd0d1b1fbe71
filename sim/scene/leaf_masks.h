// Textures of leaves: what is leaf and what is gap on the cards that crowns are made of.
#pragma once

#include <memory>

#include "sim/scene/alpha_mask.h"

namespace rigwire::sim {

/// A spray of broad leaves along a twig, 64 x 64 texels; about half of it is leaf.
[[nodiscard]] std::shared_ptr<const AlphaMask> broad_leaves();
/// A twig with needles on both sides, 64 x 64 texels; about half of it is needle.
[[nodiscard]] std::shared_ptr<const AlphaMask> needles();

}  // namespace rigwire::sim
