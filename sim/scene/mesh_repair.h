// Meshes from elsewhere made fit for the ray caster.
#pragma once

#include <cstddef>

#include "sim/scene/triangle_mesh.h"

namespace rigwire::sim {

/// Triangles that were left out of a mesh, by the first reason that holds.
struct DroppedTriangles {
  std::size_t not_finite = 0;  ///< A corner, or its texture coordinate, is no number.
  std::size_t too_far = 0;     ///< A corner over kFarthestVertex_m from the mesh's origin.
  std::size_t no_area = 0;

  [[nodiscard]] std::size_t total() const { return not_finite + too_far + no_area; }
  DroppedTriangles& operator+=(const DroppedTriangles& other);
};

/// Vertices are floats, good for 0.5 mm there.
inline constexpr double kFarthestVertex_m = 10e3;

/// Removes triangles that rays cannot hit correctly, and unused vertices; keeps the order of the
/// rest. Precondition: all indices are of existing vertices.
DroppedTriangles drop_bad_triangles(TriangleMesh& mesh);

/// Splits triangles until no edge is longer than `longest_m`: in floats, rays miss the far parts of
/// huge or skinny triangles by centimetres. Edges are halved alike on both their sides, so that no
/// gap opens. Throws std::invalid_argument naming the mesh when it would have more than 5 million
/// triangles.
void tessellate(TriangleMesh& mesh, double longest_m);

}  // namespace rigwire::sim
