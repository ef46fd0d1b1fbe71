// What of a mesh is solid: the convex hull of each of its connected parts.
//
// A truck of boxes, plates and wheels keeps its hollow so; a part that is hollow itself is filled.
// Hulls have at most kMostHullPoints points: of more, those that are farthest along as many
// directions, which cuts up to a tenth of a boulder. Parts smaller than 0.1 m are left out; a
// mesh of more than 256 other parts (leaves, gravel) is one hull. Flat parts are 2 cm thick.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sim/contact/convex_shape.h"
#include "sim/scene/triangle_mesh.h"

namespace rigwire::sim {

/// In the meshes' frame times `scale`. Vertices that coincide join their triangles.
[[nodiscard]] std::vector<std::shared_ptr<const ConvexShape>> convex_pieces(
    std::span<const TriangleMesh> meshes, double scale);

}  // namespace rigwire::sim
