// Contact points of two convex bodies: up to four points of the area that their surfaces share,
// seen along the normal, each with its own gap.
//
// The features that face each other (convex_shape.h) are clipped against each other in the plane
// across the normal; each corner of the result has the gap of the two features' planes there. When
// a rotation changes the features, points appear and vanish with a gap, not with an overlap, as
// long as the features are wider than their overlap is deep; so forces do not jump. The minimum gap
// is the pair's own.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>

#include "sim/contact/closest.h"

namespace rigwire::sim {

inline constexpr std::size_t kManifoldPoints = 4;

struct ManifoldPoint {
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();  ///< Midway between the two surfaces.
  double gap_m = 0.0;
};

struct Manifold {
  std::array<ManifoldPoint, kManifoldPoints> points;
  std::size_t count = 0;
};

/// Returns points with gaps up to `reach_m`; at least one. Allocates nothing.
[[nodiscard]] Manifold manifold(const PlacedShape& a, const PlacedShape& b,
                                const Separation& separation, double reach_m);

}  // namespace rigwire::sim
