// Meshes as Embree takes them, with holes.
#include <algorithm>

#include "sim/scene/scene_internals.h"

namespace rigwire::sim {
namespace {

/// Lets the rays of a packet pass where the surface has a hole.
void pass_holes(const RTCFilterFunctionNArguments* arguments) {
  const auto& surface =
      *static_cast<const Scene::Internals::MaskedSurface*>(arguments->geometryUserPtr);
  const unsigned n = arguments->N;
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] != -1) {
      continue;
    }
    const auto& corner = surface.triangles[RTCHitN_primID(arguments->hit, n, i)];
    const float a = RTCHitN_u(arguments->hit, n, i);
    const float b = RTCHitN_v(arguments->hit, n, i);
    if (!surface.mask->opaque_at(corner[0] + a * corner[2] + b * corner[4],
                                 corner[1] + a * corner[3] + b * corner[5])) {
      arguments->valid[i] = 0;
    }
  }
}

}  // namespace

GeometryHandle Scene::Internals::make_geometry(const TriangleMesh& mesh) {
  validate(mesh);
  const std::string doing = "mesh '" + mesh.name + "'";
  GeometryHandle geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
  auto* vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                              3 * sizeof(float), mesh.vertices.size()));
  auto* indices = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(std::uint32_t), mesh.triangles.size()));
  check(doing.c_str());
  for (const auto& vertex : mesh.vertices) {
    vertices = std::copy_n(vertex.data(), 3, vertices);
  }
  for (const auto& triangle : mesh.triangles) {
    indices = std::ranges::copy(triangle, indices).out;
  }
  if (mesh.alpha) {
    auto surface = std::make_unique<MaskedSurface>();
    surface->mask = mesh.alpha;
    surface->triangles.reserve(mesh.triangles.size());
    for (const auto& [i, j, k] : mesh.triangles) {
      const Eigen::Vector2f at = mesh.texture_coordinates[i];
      const Eigen::Vector2f to_j = mesh.texture_coordinates[j] - at;
      const Eigen::Vector2f to_k = mesh.texture_coordinates[k] - at;
      surface->triangles.push_back({at.x(), at.y(), to_j.x(), to_j.y(), to_k.x(), to_k.y()});
    }
    rtcSetGeometryUserData(geometry.get(), surface.get());
    rtcSetGeometryIntersectFilterFunction(geometry.get(), pass_holes);
    rtcSetGeometryOccludedFilterFunction(geometry.get(), pass_holes);
    masked.push_back(std::move(surface));
  }
  rtcCommitGeometry(geometry.get());
  check(doing.c_str());
  return geometry;
}

Scene::MeshId Scene::Internals::add_meshes(std::string name,
                                           std::span<const TriangleMesh* const> parts,
                                           std::vector<Material> surfaces) {
  SceneHandle inner(rtcNewScene(device.get()));
  // The context's filter is for rays that count the crossings of foliage (scene_sky.cpp).
  rtcSetSceneFlags(inner.get(), static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST |
                                                           RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const GeometryHandle geometry = make_geometry(*parts[i]);
    if (!surfaces.empty()) {
      rtcSetGeometryMask(geometry.get(), surface_mask(surfaces[i], kFixed));
      rtcCommitGeometry(geometry.get());
    }
    rtcAttachGeometryByID(inner.get(), geometry.get(), static_cast<unsigned>(i));
  }
  rtcCommitScene(inner.get());
  check(("mesh '" + name + "'").c_str());
  meshes.push_back({std::move(inner), std::move(name), std::move(surfaces)});
  return static_cast<MeshId>(meshes.size() - 1);
}

}  // namespace rigwire::sim
