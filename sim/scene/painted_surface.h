// Meshes with colours of their own, as cameras look them up by triangle. Not for other folders.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "sim/scene/colour_texture.h"
#include "sim/scene/triangle_mesh.h"

namespace rigwire::sim {

struct PaintedSurface {
  struct Triangle {
    /// u and v of the first corner, and on the way to the second and to the third.
    std::array<float, 6> corners;
    /// How u and v grow along the mesh's axes, in the triangle's plane: per unit of the mesh.
    std::array<float, 3> grad_u;
    std::array<float, 3> grad_v;
  };
  std::shared_ptr<const MeshColour> colour;
  std::vector<Triangle> triangles;  ///< Without a texture none.
};

/// Returns the surface of a mesh with a colour.
[[nodiscard]] std::shared_ptr<const PaintedSurface> painted_surface(const TriangleMesh& mesh);

}  // namespace rigwire::sim
