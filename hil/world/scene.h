// What a scene's description names by file, loaded.
#pragma once

#include <string>
#include <vector>

#include "hil/world/origin.h"
#include "sim/scene/scene_description.h"

namespace rigwire::hil {

/// The arguments of sim::build_scene().
struct SceneFiles {
  sim::SceneDescription description;  ///< With the heights of its height map.
  std::vector<sim::TriangleMesh> meshes;
  std::vector<std::string> report;  ///< Lines for people: what was left out of the files.
};

/// Throws std::invalid_argument as load_model() (hil/files/mesh_file.h) and load_height_map()
/// (hil/files/height_map_file.h).
[[nodiscard]] SceneFiles load_scene_files(const sim::SceneDescription& description,
                                          const OriginConfiguration& origin);

}  // namespace rigwire::hil
