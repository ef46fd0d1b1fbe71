// Finds where the side of a rolling cylinder comes nearest to the terrain.
//
// Three circles across the cylinder are searched, its rims and its middle: on the lower half of
// each, the places where the gap to the terrain has a minimum. On even ground that is one line
// below the axle, which stays there as the cylinder rolls; in a corner there are two. Over an edge,
// where the terrain's normal jumps from n1 to n2 within the minimum, the result is the normal
// between them that is perpendicular to the circle, so that a cylinder rolling over an edge turns
// about it.
//
// A point inside the terrain is as deep as the plane of the terrain above it says.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "sim/contact/convex_shape.h"
#include "sim/ground/ground.h"

namespace rigwire::sim {

inline constexpr std::size_t kMostSidePlaces = 24;

struct SidePlace {
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal_W = Eigen::Vector3d::UnitZ();  ///< Unit normal of the terrain.
  double gap_m = 0.0;                                   ///< Negative: inside.
  GroundPoint under;
};

/// Those within reach_m, circle by circle, in place of what `places` had; kMostSidePlaces at most.
/// The cylinder's axis is z of its shape. About 90 look-ups of the terrain.
void nearest_on_side(const Ground& ground, const ConvexShape& cylinder,
                     const Eigen::Isometry3d& X_WS, double reach_m, std::vector<SidePlace>& places);

}  // namespace rigwire::sim
