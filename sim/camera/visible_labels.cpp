#include "sim/camera/visible_labels.h"

#include <set>

#include "sim/scene/scene.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {

std::vector<std::string> visible_labels(const Scene& scene) {
  std::set<std::string> labels;
  for (Scene::InstanceId id = 0; id < scene.instance_count(); ++id) {
    labels.insert(scene.label(id));
  }
  for (const Scene::Internals::Terrain& terrain : scene.internals().terrains) {
    if (terrain.cover) {
      labels.insert(terrain.cover->labels.begin(), terrain.cover->labels.end());
    }
  }
  return {labels.begin(), labels.end()};
}

}  // namespace rigwire::sim
