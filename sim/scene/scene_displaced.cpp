// The part of Scene and its internals that lets what is fixed leave its place.

#include <algorithm>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>

#include "sim/scene/scene.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {
namespace {

std::shared_ptr<RTCSceneTy> shared(RTCScene scene) {
  rtcRetainScene(scene);
  return {scene, ReleaseScene{}};
}

}  // namespace

std::uint32_t Scene::Internals::new_moving_ids(std::uint32_t instance, std::uint32_t parts) {
  const Shading surface;
  const bool low = low_numbers_used + parts <= kLowNumbers;
  std::uint32_t first = 0;
  for (std::uint32_t k = 0; k < parts; ++k) {
    const std::uint32_t id =
        low ? new_moving_id(instance + k, surface) : new_fixed_id(instance + k, surface);
    first = k == 0 ? id : first;
  }
  return first;
}

std::shared_ptr<RTCSceneTy> Scene::Internals::cut(const Mesh& mesh, std::uint32_t first,
                                                  std::uint32_t count, bool others) const {
  RTCGeometry whole = rtcGetGeometry(mesh.scene.get(), 0);
  const auto* vertices =
      static_cast<const float*>(rtcGetGeometryBufferData(whole, RTC_BUFFER_TYPE_VERTEX, 0));
  const auto* indices =
      static_cast<const std::uint32_t*>(rtcGetGeometryBufferData(whole, RTC_BUFFER_TYPE_INDEX, 0));
  TriangleMesh part;
  part.name = mesh.name;
  std::unordered_map<std::uint32_t, std::uint32_t> renumbered;
  for (std::size_t t = 0; t < mesh.triangles; ++t) {
    if ((t >= first && t < std::size_t{first} + count) == others) {
      continue;
    }
    auto& triangle = part.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = indices[3 * t + k];
      const auto [place, fresh] =
          renumbered.emplace(vertex, static_cast<std::uint32_t>(part.vertices.size()));
      if (fresh) {
        const float* const p = vertices + 3 * std::size_t{vertex};
        part.vertices.emplace_back(p[0], p[1], p[2]);
      }
      triangle[k] = place->second;
    }
  }
  std::shared_ptr<RTCSceneTy> scene(rtcNewScene(device.get()), ReleaseScene{});
  rtcSetSceneFlags(scene.get(), static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST |
                                                           RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
  if (!part.triangles.empty()) {
    const GeometryHandle geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
    auto* to = static_cast<float*>(rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX,
                                                           0, RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                           part.vertices.size()));
    auto* corners = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t), part.triangles.size()));
    for (const auto& vertex : part.vertices) {
      to = std::copy_n(vertex.data(), 3, to);
    }
    for (const auto& triangle : part.triangles) {
      corners = std::ranges::copy(triangle, corners).out;
    }
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(scene.get(), geometry.get(), 0);
  }
  rtcCommitScene(scene.get());
  return scene;
}

DisplacedPiece Scene::Internals::take_out(const ScenePiece& piece) {
  const std::string who = "scene: piece of thing " + std::to_string(piece.thing) + ": ";
  if (piece.thing >= (piece.canopy ? placed.size() : instances.size())) {
    throw std::invalid_argument(who + "there is no such thing");
  }
  const std::size_t at = piece.canopy ? piece.thing : instances[piece.thing].placed;
  Placed& thing = placed[at];
  const bool ground = std::ranges::any_of(terrains, [&](const Terrain& terrain) {
    return !piece.canopy && terrain.instance == piece.thing;
  });
  if (thing.body != kFixed || thing.gone || ground || (piece.canopy && thing.mask != 0)) {
    throw std::invalid_argument(who + "it is not fixed, or gone already");
  }
  const Mesh& mesh = meshes[thing.mesh];
  DisplacedPiece out;
  out.piece = piece;
  out.X_WM_still = thing.X_PM;
  out.scale = thing.scale;
  out.mask = thing.mask;
  out.parts = static_cast<std::uint32_t>(std::max<std::size_t>(1, mesh.materials.size()));
  if (piece.triangles == 0) {
    out.shape = shared(mesh.scene.get());
    thing.gone = true;
    if (piece.canopy) {
      rtcDetachGeometry(canopy.get(), thing.geometry_id);
      thing.geometry.reset();
    }
  } else {
    // Triangles keep the numbers that they had when the mesh was whole.
    std::uint32_t before = 0;
    std::uint32_t taken = 0;
    for (const auto& [first, count] : mesh.taken_out) {
      before += first < piece.first_triangle ? count : 0;
      taken += count;
      if (first < piece.first_triangle + piece.triangles && piece.first_triangle < first + count) {
        throw std::invalid_argument(who + "some of its triangles are gone already");
      }
    }
    if (!mesh.materials.empty() || !mesh.painted.empty() ||
        std::size_t{piece.first_triangle} + piece.triangles > mesh.triangles + taken) {
      throw std::invalid_argument(
          who + "its mesh has " + std::to_string(mesh.triangles + taken) +
          " triangles, and must be of one surface and no colours of its own");
    }
    const std::uint32_t first = piece.first_triangle - before;
    out.shape = cut(mesh, first, piece.triangles, false);
    const std::shared_ptr<RTCSceneTy> rest = cut(mesh, first, piece.triangles, true);
    rtcRetainScene(rest.get());
    Mesh left{
        SceneHandle(rest.get()), mesh.name, {}, mesh.triangles - piece.triangles, mesh.taken_out};
    left.taken_out.emplace_back(piece.first_triangle, piece.triangles);
    const bool alone = std::ranges::count(placed, thing.mesh, &Placed::mesh) == 1;
    if (alone) {
      meshes[thing.mesh] = std::move(left);
    } else {
      meshes.push_back(std::move(left));
      thing.mesh = static_cast<MeshId>(meshes.size() - 1);
    }
    if (piece.canopy) {
      rtcSetGeometryInstancedScene(thing.geometry.get(), meshes[thing.mesh].scene.get());
      rtcCommitGeometry(thing.geometry.get());
    } else {
      thing.reshaped = true;
    }
  }
  out.number = piece.canopy ? 0 : new_moving_ids(piece.thing, out.parts);
  fixed_placed = false;
  check("taking a piece out of its place");
  return out;
}

void Scene::Internals::place_displaced() {
  if (!displaced || (displaced == displaced_shown && displaced_origin_W == origin_W)) {
    return;
  }
  bool canopies = false;
  for (std::size_t i = 0; i < displaced->size(); ++i) {
    const DisplacedPiece& piece = (*displaced)[i];
    if (displaced_geometry.size() == i) {
      displaced_geometry.emplace_back();
    }
    if (piece.piece.canopy && !canopies_kept) {
      continue;
    }
    GeometryHandle& geometry = displaced_geometry[i];
    if (!geometry) {
      geometry.reset(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
      rtcSetGeometryInstancedScene(geometry.get(), piece.shape.get());
      if (piece.piece.canopy) {
        rtcAttachGeometry(canopy.get(), geometry.get());
      } else {
        rtcSetGeometryMask(geometry.get(), piece.mask);
        rtcAttachGeometryByID(moving.get(), geometry.get(), piece.number);
      }
    }
    set_transform(geometry.get(), to_transform(piece.X_WM, piece.scale, origin_W));
    canopies = canopies || piece.piece.canopy;
    const std::uint32_t end = piece.piece.canopy ? 0 : piece.number + piece.parts;
    if (end > shading.size()) {
      shading.resize(end);
      instance_of.resize(end);
    }
    for (std::uint32_t k = 0; k < piece.parts && !piece.piece.canopy; ++k) {
      shading[piece.number + k] = shading[placed_of(piece.piece.thing).geometry_id + k];
      shading[piece.number + k].R_WM = piece.X_WM.linear().cast<float>();
      shading[piece.number + k].variation = 0.0F;  // its cells are those of places
      instance_of[piece.number + k] = piece.piece.thing + k;
    }
  }
  if (canopies) {
    rtcCommitScene(canopy.get());
  }
  displaced_shown = displaced;
  displaced_origin_W = origin_W;
}

void Scene::displace(const ScenePiece& piece, const Eigen::Isometry3d& motion_W) {
  Internals& in = *internals_;
  if (!motion_W.matrix().allFinite()) {
    throw std::invalid_argument("scene: the motion of a piece of thing " +
                                std::to_string(piece.thing) + " is not finite");
  }
  auto next = in.displaced ? std::make_shared<std::vector<DisplacedPiece>>(*in.displaced)
                           : std::make_shared<std::vector<DisplacedPiece>>();
  auto found = std::ranges::find(*next, piece, &DisplacedPiece::piece);
  if (found == next->end()) {
    found = next->insert(next->end(), in.take_out(piece));
  }
  found->X_WM = motion_W * found->X_WM_still;
  in.displaced = std::move(next);
}

}  // namespace rigwire::sim
