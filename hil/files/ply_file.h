// Triangles of a Stanford polygon file (PLY 1.0), in text or in binary of either byte order.
//
// Source: G. Turk, "The PLY Polygon File Format", 1994. Read are x, y and z of the element `vertex`
// and the list `vertex_indices` or `vertex_index` of the element `face`, whose polygons are split
// into triangles about their first corner. Everything else of the file is passed over.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "sim/scene/triangle_mesh.h"

namespace rigwire::hil {

/// Returns the triangles of the file's content, without a name; of faces with corners in one place
/// or on a line, too. Throws std::invalid_argument with `who` in front, and line or byte: what is
/// no PLY, ends early, has faces of vertices that are not there, or has no triangle.
[[nodiscard]] sim::TriangleMesh read_ply(std::span<const std::uint8_t> bytes,
                                         const std::string& who);

}  // namespace rigwire::hil
