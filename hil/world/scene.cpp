#include "hil/world/scene.h"

#include <variant>

#include "fields/visitor.h"
#include "hil/files/height_map_file.h"
#include "hil/files/mesh_file.h"

namespace rigwire::hil {

void visit(fields::Visitor& v, SceneConfiguration& p) {
  sim::SceneDescription& scene = p.description;
  v.text("name", p.name, "Name of the scene, for people.");
  v.text("text", p.text, "One line for `rigwire list scenes`.");
  v.group(
      "terrain",
      [&scene](fields::Visitor& keys) {
        keys.variant("type", scene.terrain, "Kind of ground; pit when not given.");
      },
      "The ground.");
  v.list("tracks", scene.tracks, "Ways carved into the ground.");
  v.list("soils", scene.soils, "What the ground is made of; the first lies everywhere.");
  v.list("soil_regions", scene.soil_regions, "Where another soil lies than around.");
  v.list("rocks", scene.rocks, "Fields of rocks.");
  v.list("trees", scene.trees, "Forests of closed crowns.");
  v.list("forests", scene.forests, "Forests modelled leaf by leaf.");
  v.list("grass", scene.grass, "Fields of stalks.");
  v.list("boxes", scene.boxes, "Buildings, kerbs: solid boxes.");
  v.list("objects", scene.objects, "Meshes that stand there.");
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
