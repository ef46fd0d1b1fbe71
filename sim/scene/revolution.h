// Bodies of revolution: trunks, branches, crowns.
#pragma once

#include <Eigen/Core>
#include <span>

#include "sim/scene/triangle_mesh.h"

namespace rigwire::sim {

/// A ring of a body of revolution; radius 0 is a point.
struct Ring {
  double radius_m = 0.0;
  double z_m = 0.0;  ///< Above the body's foot.
};

/// Stacks rings about the upright axis through `foot_m`, from the lowest upwards, into a surface
/// facing outwards; closed when the first and the last are points.
void add_revolution(TriangleMesh& mesh, const Eigen::Vector3d& foot_m, double yaw_rad, int sides,
                    std::span<const Ring> rings);

/// A point of a bent, tapering tube.
struct TubePoint {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  double radius_m = 0.0;  ///< 0 only at the end: there the tube closes in a point.
};

/// A tube through the points, open at its start: 2 x sides triangles for each stretch, half of them
/// for one that ends in a point. Rings are square to the tube's whole direction.
void add_tube(TriangleMesh& mesh, std::span<const TubePoint> points, int sides);

}  // namespace rigwire::sim
