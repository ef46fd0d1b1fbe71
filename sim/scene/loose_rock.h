// A boulder as a body of its own: its mass and inertia, and its contact hull.
#pragma once

#include <Eigen/Geometry>
#include <string>

#include "sim/contact/loose_bodies.h"
#include "sim/scene/triangle_mesh.h"

namespace rigwire::sim {

/// Mass properties of a closed mesh, filled evenly, for 1 kg/m3.
struct MassProperties {
  double volume_m3 = 0.0;
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia_m5 = Eigen::Matrix3d::Zero();  ///< About the centre.
};
/// Sums over the tetrahedra between the origin and each triangle; precondition: the mesh is closed,
/// triangles facing outwards. Exact but for rounding.
[[nodiscard]] MassProperties mass_properties(const TriangleMesh& mesh);

struct LooseRock {
  LooseBody body;     ///< Its frame: centre of mass, principal axes.
  TriangleMesh mesh;  ///< In that frame, in metres.
};
/// `rock` scaled and placed by X_WM. It touches by the hull of at most 48 of its vertices, those
/// that reach farthest in as many directions: within a few per cent of its size of the mesh.
[[nodiscard]] LooseRock loose_rock(const TriangleMesh& rock, const Eigen::Isometry3d& X_WM,
                                   double scale, double density_kgpm3, std::string name);

}  // namespace rigwire::sim
