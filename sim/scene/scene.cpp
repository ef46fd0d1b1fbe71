#include "sim/scene/scene.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <stdexcept>

#include "sim/scene/scene_internals.h"

namespace rigwire::sim {
namespace {

void remember_error(void* user, RTCError /*code*/, const char* text) {
  auto& first_error = *static_cast<std::string*>(user);
  if (first_error.empty()) {
    first_error = text != nullptr ? text : "unknown error";
  }
}

/// Column-major 3x4, the form that Embree takes.
using Transform = std::array<float, 12>;

Transform to_transform(const Eigen::Isometry3d& X_WM, double scale,
                       const Eigen::Vector3d& origin_W) {
  const Eigen::Matrix3d linear = scale * X_WM.linear();
  const Eigen::Vector3d translation = X_WM.translation() - origin_W;
  Transform transform{};
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      transform[static_cast<std::size_t>(column * 3 + row)] =
          static_cast<float>(linear(row, column));
    }
  }
  for (int row = 0; row < 3; ++row) {
    transform[static_cast<std::size_t>(9 + row)] = static_cast<float>(translation(row));
  }
  return transform;
}

bool finite(const Eigen::Isometry3d& X) {
  return X.matrix().allFinite();
}

void validate_instance(const Eigen::Isometry3d& X, double scale, const Material& material) {
  const std::string who = "object with label '" + material.label + "': ";
  if (!finite(X)) {
    throw std::invalid_argument(who + "its pose is not finite");
  }
  if (!(scale > 0.0) || !std::isfinite(scale)) {
    throw std::invalid_argument(who + "scale is " + std::to_string(scale) + ", must be positive");
  }
  if (!(material.reflectance >= 0.0 && material.reflectance <= 1.0)) {
    throw std::invalid_argument(who + "reflectance is " + std::to_string(material.reflectance) +
                                ", allowed: 0 to 1");
  }
  if (!(material.retro_gain >= 0.0 && material.retro_gain <= 1.0)) {
    throw std::invalid_argument(who + "retro_gain is " + std::to_string(material.retro_gain) +
                                ", allowed: 0 to 1");
  }
}

}  // namespace

void Scene::Internals::check(const char* doing) {
  if (!first_error.empty()) {
    const std::string text = "scene: " + std::string(doing) + ": " + first_error;
    first_error.clear();
    throw std::runtime_error(text);
  }
}

Scene::InstanceId Scene::Internals::add_instance(RTCScene inner, std::uint32_t body,
                                                 const Eigen::Isometry3d& X_PM, double scale,
                                                 const Material& material) {
  validate_instance(X_PM, scale, material);
  const auto id = static_cast<InstanceId>(instances.size());
  GeometryHandle geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
  rtcSetGeometryInstancedScene(geometry.get(), inner);
  rtcSetGeometryMask(geometry.get(),
                     material.foliage ? foliage_mask() : (body == kFixed ? 1U : body_mask(body)));
  if (body != kFixed) {
    rtcSetGeometryTimeStepCount(geometry.get(), 2);
  }
  const std::uint32_t geometry_id =
      new_geometry_id(id, {X_PM.linear().cast<float>(), static_cast<float>(material.reflectance),
                           static_cast<float>(material.retro_gain)});
  rtcAttachGeometryByID(top.get(), geometry.get(), geometry_id);
  check("adding an object");
  instances.push_back({std::move(geometry), X_PM, scale, body, material, geometry_id});
  fixed_placed = false;
  has_foliage = has_foliage || material.foliage;
  return id;
}

void Scene::Internals::place_fixed() {
  for (const Instance& instance : instances) {
    if (instance.body != kFixed) {
      continue;
    }
    const Transform transform = to_transform(instance.X_PM, instance.scale, origin_W);
    rtcSetGeometryTransform(instance.geometry.get(), 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR,
                            transform.data());
    rtcCommitGeometry(instance.geometry.get());
  }
  for (const Terrain& terrain : terrains) {
    const Instance& instance = instances[terrain.instance];
    const Transform transform = to_transform(instance.X_PM, instance.scale, origin_W);
    for (const Tile& tile : terrain.tiles) {
      rtcSetGeometryTransform(tile.placed.get(), 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR,
                              transform.data());
      rtcCommitGeometry(tile.placed.get());
    }
  }
  fixed_placed = true;
}

void Scene::Internals::place_bodies(std::span<const BodyMotion> motions) {
  for (const Instance& instance : instances) {
    if (instance.body == kFixed) {
      continue;
    }
    const BodyMotion& motion = motions[instance.body];
    const Transform start =
        to_transform(motion.X_WB_start * instance.X_PM, instance.scale, origin_W);
    const Transform end = to_transform(motion.X_WB_end * instance.X_PM, instance.scale, origin_W);
    RTCGeometry geometry = instance.geometry.get();
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, start.data());
    rtcSetGeometryTransform(geometry, 1, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, end.data());
    rtcCommitGeometry(geometry);
    shading[instance.geometry_id].R_WM =
        (motion.X_WB_end.linear() * instance.X_PM.linear()).cast<float>();
  }
}

Scene::Scene() : internals_(std::make_unique<Internals>()) {
  // One thread builds: the scene is small, and the executive owns the machine's other cores.
  internals_->device.reset(rtcNewDevice("threads=1"));
  if (!internals_->device) {
    throw std::runtime_error("scene: the ray caster (Embree) cannot start on this machine");
  }
  rtcSetDeviceErrorFunction(internals_->device.get(), remember_error, &internals_->first_error);
  if (rtcGetDeviceProperty(internals_->device.get(), RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED) == 0) {
    throw std::runtime_error("scene: this build of Embree has no ray masks");
  }
  internals_->top.reset(rtcNewScene(internals_->device.get()));
  rtcSetSceneFlags(internals_->top.get(),
                   static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC));
  internals_->check("setting up");
}

Scene::~Scene() = default;

Scene::MeshId Scene::add_mesh(const TriangleMesh& mesh) {
  validate(mesh);
  Internals& in = *internals_;
  GeometryHandle geometry(rtcNewGeometry(in.device.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
  auto* vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                              3 * sizeof(float), mesh.vertices.size()));
  auto* indices = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(std::uint32_t), mesh.triangles.size()));
  in.check(("mesh '" + mesh.name + "'").c_str());
  for (const auto& vertex : mesh.vertices) {
    vertices = std::copy_n(vertex.data(), 3, vertices);
  }
  for (const auto& triangle : mesh.triangles) {
    indices = std::ranges::copy(triangle, indices).out;
  }
  rtcCommitGeometry(geometry.get());
  SceneHandle inner(rtcNewScene(in.device.get()));
  // The filter is for rays that count the crossings of foliage (scene_sky.cpp).
  rtcSetSceneFlags(inner.get(), static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST |
                                                           RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
  rtcAttachGeometry(inner.get(), geometry.get());
  rtcCommitScene(inner.get());
  in.check(("mesh '" + mesh.name + "'").c_str());
  in.meshes.push_back(std::move(inner));
  return static_cast<MeshId>(in.meshes.size() - 1);
}

Scene::InstanceId Scene::add_terrain(const HeightField& field, const Material& material) {
  validate(field);
  Internals& in = *internals_;
  GeometryHandle geometry(rtcNewGeometry(in.device.get(), RTC_GEOMETRY_TYPE_GRID));
  auto* vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                              3 * sizeof(float), field.heights_m.size()));
  auto* grid = static_cast<RTCGrid*>(rtcSetNewGeometryBuffer(
      geometry.get(), RTC_BUFFER_TYPE_GRID, 0, RTC_FORMAT_GRID, sizeof(RTCGrid), 1));
  in.check("terrain");
  const Eigen::Vector3d centre = field.centre_m();
  for (std::size_t r = 0; r < field.rows; ++r) {
    for (std::size_t c = 0; c < field.columns; ++c) {
      *vertices++ = static_cast<float>(field.origin_m.x() - centre.x() +
                                       field.cell_m * static_cast<double>(c));
      *vertices++ = static_cast<float>(field.origin_m.y() - centre.y() +
                                       field.cell_m * static_cast<double>(r));
      *vertices++ = static_cast<float>(field.node(c, r) - centre.z());
    }
  }
  *grid = {.startVertexID = 0,
           .stride = static_cast<unsigned>(field.columns),
           .width = static_cast<unsigned short>(field.columns),
           .height = static_cast<unsigned short>(field.rows)};
  rtcCommitGeometry(geometry.get());
  SceneHandle inner(rtcNewScene(in.device.get()));
  rtcSetSceneFlags(inner.get(), RTC_SCENE_FLAG_ROBUST);
  rtcAttachGeometry(inner.get(), geometry.get());
  rtcCommitScene(inner.get());
  in.check("terrain");
  in.meshes.push_back(std::move(inner));
  Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
  X_WM.translation() = centre;
  const InstanceId id =
      in.add_instance(in.meshes.back().get(), Internals::kFixed, X_WM, 1.0, material);
  Internals::Terrain terrain;
  terrain.instance = id;
  terrain.field = field;
  terrain.centre_W = centre;
  in.terrains.push_back(std::move(terrain));
  return id;
}

Scene::InstanceId Scene::add_object(MeshId mesh, const Eigen::Isometry3d& X_WM, double scale,
                                    const Material& material) {
  return internals_->add_instance(internals_->meshes.at(mesh).get(), Internals::kFixed, X_WM, scale,
                                  material);
}

Scene::BodyId Scene::add_body(std::string_view name) {
  internals_->bodies.emplace_back(name);
  return static_cast<BodyId>(internals_->bodies.size() - 1);
}

Scene::InstanceId Scene::add_body_part(BodyId body, MeshId mesh, const Eigen::Isometry3d& X_BM,
                                       const Material& material) {
  if (body >= internals_->bodies.size()) {
    throw std::invalid_argument("scene: there is no body " + std::to_string(body));
  }
  return internals_->add_instance(internals_->meshes.at(mesh).get(), body, X_BM, 1.0, material);
}

void Scene::begin_slice(SimTime t0, SimTime t1, const Eigen::Vector3d& focus_W,
                        std::span<const BodyMotion> motions) {
  Internals& in = *internals_;
  if (motions.size() != in.bodies.size()) {
    throw std::invalid_argument("scene: " + std::to_string(motions.size()) + " motions for " +
                                std::to_string(in.bodies.size()) + " bodies");
  }
  for (std::size_t i = 0; i < motions.size(); ++i) {
    if (!finite(motions[i].X_WB_start) || !finite(motions[i].X_WB_end)) {
      throw std::invalid_argument("scene: the pose of body '" + in.bodies[i] + "' is not finite");
    }
  }
  if (t1 <= t0 || !focus_W.allFinite()) {
    throw std::invalid_argument("scene: a slice needs t0 < t1 and a finite focus");
  }
  in.t0 = t0;
  in.t1 = t1;
  if ((focus_W - in.origin_W).norm() > kRebaseDistance_m) {
    in.origin_W = focus_W.array().round();
    in.fixed_placed = false;
  }
  if (!in.fixed_placed) {
    in.place_fixed();
  }
  in.refresh_terrains();
  in.place_bodies(motions);
  rtcCommitScene(in.top.get());
  in.check("placing the bodies");
}

std::size_t Scene::instance_count() const {
  return internals_->instances.size();
}
std::optional<SimTime> Scene::slice_end() const {
  return internals_->t1 > internals_->t0 ? std::optional(internals_->t1) : std::nullopt;
}

std::size_t Scene::body_count() const {
  return internals_->bodies.size();
}
const Material& Scene::material(InstanceId instance) const {
  return internals_->instances.at(instance).material;
}

std::uint32_t Scene::body_mask(BodyId body) {
  return 1U << (2U + body % 30U);
}
std::uint32_t Scene::foliage_mask() {
  return 1U << 1U;
}

std::optional<SceneHit> Scene::cast(const Eigen::Vector3d& p_W, const Eigen::Vector3d& direction_W,
                                    double near_m, double far_m, SimTime time,
                                    std::uint32_t mask) const {
  const Internals& in = *internals_;
  const FlushDenormals flush;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query{};
  query.ray =
      make_ray(p_W - in.origin_W, direction_W, near_m, far_m, in.slice_fraction(time), mask);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(in.top.get(), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
    return std::nullopt;
  }
  SceneHit hit;
  hit.range_m = query.ray.tfar;
  hit.instance = in.instance_of[query.hit.instID[0]];
  const Eigen::Vector3f normal_M(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z);
  hit.normal_W = (in.shading[query.hit.instID[0]].R_WM * normal_M).cast<double>().normalized();
  if (hit.normal_W.dot(direction_W) > 0.0) {
    hit.normal_W = -hit.normal_W;
  }
  return hit;
}

}  // namespace rigwire::sim
