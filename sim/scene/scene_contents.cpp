#include "sim/scene/scene_contents.h"

#include <algorithm>

#include "sim/scene/painted_surface.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {
namespace {

SceneContents::Part part_of(RTCScene scene, unsigned number, std::size_t triangles) {
  SceneContents::Part part;
  if (triangles == 0) {
    return part;
  }
  RTCGeometry geometry = rtcGetGeometry(scene, number);
  const auto* corners = static_cast<const std::uint32_t*>(
      rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_INDEX, 0));
  const auto* vertices =
      static_cast<const float*>(rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, 0));
  part.corners.assign(corners, corners + 3 * triangles);
  const std::size_t count = std::size_t{*std::ranges::max_element(part.corners)} + 1;
  part.vertices_m.assign(vertices, vertices + 3 * count);
  return part;
}

}  // namespace

/// Successive instances with the same `placed` are the parts of one thing; each mesh is copied
/// once.
SceneContents contents_of(const Scene& scene) {
  using Internals = Scene::Internals;
  const Internals& in = scene.internals();
  SceneContents contents;
  for (std::size_t i = 0; i < in.bodies.size(); ++i) {
    contents.bodies.push_back({in.bodies[i], in.loose[i]});
  }
  for (const Internals::Terrain& terrain : in.terrains) {
    SceneContents::Terrain& told = contents.terrains.emplace_back();
    told.instance = terrain.instance;
    told.field = terrain.field;
    told.material = scene.material(terrain.instance);
    if (terrain.cover) {
      told.labels = terrain.cover->labels;
      told.cells = terrain.cover->cells;
    }
  }
  std::vector<std::optional<std::size_t>> places(in.meshes.size());
  for (Scene::InstanceId id = 0; id < in.instances.size(); ++id) {
    const std::uint32_t at = in.instances[id].placed;
    const Internals::Placed& placed = in.placed[at];
    if (std::ranges::find(in.terrains, id, &Internals::Terrain::instance) != in.terrains.end()) {
      continue;
    }
    const Internals::Mesh& mesh = in.meshes[placed.mesh];
    if (contents.things.empty() || id == 0 || in.instances[id - 1].placed != at) {
      SceneContents::Thing& thing = contents.things.emplace_back();
      thing.instance = id;
      thing.name = placed.name;
      thing.body = placed.body == Internals::kFixed ? std::nullopt : std::optional(placed.body);
      thing.X_PM = placed.X_PM;
      thing.scale = placed.scale;
      if (!places[placed.mesh]) {
        places[placed.mesh] = contents.meshes.size();
        SceneContents::Mesh& told = contents.meshes.emplace_back();
        told.name = mesh.name;
        const std::size_t parts = std::max<std::size_t>(1, mesh.part_triangles.size());
        for (std::size_t k = 0; k < parts; ++k) {
          told.parts.push_back(
              part_of(mesh.scene.get(), static_cast<unsigned>(k),
                      mesh.part_triangles.empty() ? mesh.triangles : mesh.part_triangles[k]));
        }
      }
      thing.mesh = *places[placed.mesh];
    }
    const std::uint32_t painted = in.instances[id].painted;
    contents.things.back().surfaces.push_back(
        {scene.material(id), painted == 0 ? nullptr : in.painted[painted - 1]->colour});
  }
  return contents;
}

std::vector<DisplacedThing> displaced_things(const ScenePlacement& placement) {
  std::vector<DisplacedThing> things;
  if (placement.displaced) {
    for (const DisplacedPiece& piece : *placement.displaced) {
      if (!piece.piece.canopy) {
        things.push_back({piece.piece, piece.X_WM});
      }
    }
  }
  return things;
}

}  // namespace rigwire::sim
