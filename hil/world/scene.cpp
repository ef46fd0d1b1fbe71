#include "hil/world/scene.h"

#include <variant>

#include "fields/visitor.h"
#include "hil/files/height_map_file.h"
#include "hil/files/mesh_file.h"

namespace rigwire::hil {

void visit(fields::Visitor& v, SceneConfiguration& p) {
  v.text("name", p.name, "Name of the scene, for people.");
  v.text("text", p.text, "One line for `rigwire list scenes`.");
  visit(v, p.description);
  v.section("weather", p.weather, "What is in the air, and how it changes.");
}

SceneFiles load_scene_files(const sim::SceneDescription& description,
                            const OriginConfiguration& origin) {
  SceneFiles files;
  files.description = description;
  if (auto* map = std::get_if<sim::HeightMapTerrain>(&files.description.terrain)) {
    map->heights = load_height_map(*map, {origin.latitude_deg, origin.longitude_deg});
  }
  files.meshes = load_meshes(description.objects, files.report);
  return files;
}

}  // namespace rigwire::hil
