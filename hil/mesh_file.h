// Meshes from files (Wavefront OBJ, STL, PLY, and what else assimp reads).
#pragma once

#include <filesystem>
#include <string>

#include "sim/scene/triangle_mesh.h"

namespace rigwire::hil {

/// All triangles of the file as one mesh named `name`, in metres, x forward, y left, z up as they
/// stand in the file; polygons are split into triangles, points and lines left out. Throws
/// std::invalid_argument naming the file when it is missing or cannot be read, or holds no mesh
/// that sim::validate() accepts.
[[nodiscard]] sim::TriangleMesh load_mesh(const std::filesystem::path& file,
                                          const std::string& name);

}  // namespace rigwire::hil
