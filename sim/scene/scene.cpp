#include "sim/scene/scene.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>

#include "fields/check.h"
#include "fields/visitor.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {

using fields::plain;

namespace {

void remember_error(void* user, RTCError /*code*/, const char* text) {
  auto& first_error = *static_cast<std::string*>(user);
  if (first_error.empty()) {
    first_error = text != nullptr ? text : "unknown error";
  }
}

}  // namespace

void visit(fields::Visitor& v, Material& p) {
  v.number("reflectance", p.reflectance, plain().between(0, 1), "Diffuse reflectance at 905 nm.");
  v.text("label", p.label, "What the surface is, for recordings.");
  v.number("retro_gain", p.retro_gain, plain().between(0, 1),
           "Of a retro-reflector; 1 is an ideal one, 0 is none.");
  v.boolean("foliage", p.foliage, "Leaves in a closed surface: radio signals pass, weakened.");
  v.boolean("loose_leaves", p.loose_leaves, "Single leaves: radio signals pass.");
}

void validate(const Material& material) {
  fields::check(material);
}

std::uint32_t surface_mask(const Material& material, std::uint32_t body) {
  if (material.foliage) {
    return Scene::foliage_mask();
  }
  if (material.loose_leaves) {
    return Scene::loose_leaves_mask();
  }
  return body == Scene::Internals::kFixed ? 1U : Scene::body_mask(body);
}

void Scene::Internals::check(const char* doing) {
  if (!first_error.empty()) {
    const std::string text = "scene: " + std::string(doing) + ": " + first_error;
    first_error.clear();
    throw std::runtime_error(text);
  }
}

std::uint32_t Scene::Internals::material_index(const Material& material) {
  const auto found = std::ranges::find(materials, material);
  if (found == materials.end()) {
    materials.push_back(material);
    return static_cast<std::uint32_t>(materials.size() - 1);
  }
  return static_cast<std::uint32_t>(found - materials.begin());
}

std::uint32_t Scene::Internals::new_fixed_id(std::uint32_t instance, const Shading& surface) {
  const auto id = static_cast<std::uint32_t>(shading.size());
  shading.push_back(surface);
  instance_of.push_back(instance);
  return id;
}

std::uint32_t Scene::Internals::new_moving_id(std::uint32_t instance, const Shading& surface) {
  if (low_numbers_used == kLowNumbers) {
    return new_fixed_id(instance, surface);
  }
  shading[low_numbers_used] = surface;
  instance_of[low_numbers_used] = instance;
  return low_numbers_used++;
}

Scene::InstanceId Scene::Internals::add_instance(const Mesh& mesh, std::uint32_t body,
                                                 const Eigen::Isometry3d& X_PM, double scale,
                                                 std::span<const Material> surfaces,
                                                 std::string_view name) {
  const std::string who =
      "object '" + std::string(name) + "' with label '" + surfaces.front().label + "': ";
  if (!X_PM.matrix().allFinite()) {
    throw std::invalid_argument(who + "its pose is not finite");
  }
  if (!(scale > 0.0) || !std::isfinite(scale)) {
    throw std::invalid_argument(who + "scale is " + std::to_string(scale) + ", must be positive");
  }
  if (instances.size() + surfaces.size() > kMostInstances) {
    throw std::invalid_argument(who + "the scene would have more than " +
                                std::to_string(kMostInstances) + " instances");
  }
  std::uint32_t mask = 0;
  for (const Material& surface : surfaces) {
    validate(surface);
    mask |= surface_mask(surface, body);
  }
  GeometryHandle geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
  rtcSetGeometryInstancedScene(geometry.get(), mesh.scene.get());
  rtcSetGeometryMask(geometry.get(), mask);
  if (body != kFixed) {
    rtcSetGeometryTimeStepCount(geometry.get(), 2);
  }
  const auto first = static_cast<InstanceId>(instances.size());
  std::uint32_t geometry_id = RTC_INVALID_GEOMETRY_ID;  // of the first part
  for (const Material& surface : surfaces) {
    const auto id = static_cast<InstanceId>(instances.size());
    const Shading shown{X_PM.linear().cast<float>(), static_cast<float>(surface.reflectance),
                        static_cast<float>(surface.retro_gain)};
    geometry_id =
        std::min(geometry_id, body == kFixed ? new_fixed_id(id, shown) : new_moving_id(id, shown));
    instances.push_back({static_cast<std::uint32_t>(placed.size()), material_index(surface)});
    has_foliage = has_foliage || surface.foliage;
  }
  rtcAttachGeometryByID(body == kFixed ? fixed.get() : moving.get(), geometry.get(), geometry_id);
  check("adding an object");
  if (body != kFixed) {
    on_bodies.push_back(static_cast<std::uint32_t>(placed.size()));
  } else {
    fixed_placed = false;
  }
  placed.push_back({std::move(geometry), X_PM, scale, body, geometry_id, std::string(name)});
  return first;
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
  internals_->moving.reset(rtcNewScene(internals_->device.get()));
  rtcSetSceneFlags(internals_->moving.get(),
                   static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC));
  internals_->fixed.reset(rtcNewScene(internals_->device.get()));
  rtcSetSceneFlags(internals_->fixed.get(), RTC_SCENE_FLAG_ROBUST);
  internals_->canopy.reset(rtcNewScene(internals_->device.get()));
  rtcSetSceneFlags(internals_->canopy.get(), RTC_SCENE_FLAG_ROBUST);
  internals_->shading.resize(Internals::kLowNumbers);
  internals_->instance_of.resize(Internals::kLowNumbers);
  internals_->check("setting up");
}

Scene::~Scene() = default;

Scene::MeshId Scene::add_mesh(const TriangleMesh& mesh) {
  const TriangleMesh* const part = &mesh;
  return internals_->add_meshes(mesh.name, {&part, 1}, {});
}

Scene::MeshId Scene::add_model(std::span<const MeshPart> parts) {
  if (parts.empty()) {
    throw std::invalid_argument("scene: a model has no part");
  }
  std::vector<const TriangleMesh*> meshes;
  std::vector<Material> surfaces;
  for (const MeshPart& part : parts) {
    validate(part.material);
    meshes.push_back(&part.mesh);
    surfaces.push_back(part.material);
  }
  return internals_->add_meshes(parts.front().mesh.name, meshes, std::move(surfaces));
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
  in.meshes.push_back({std::move(inner), "terrain", {}});
  Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
  X_WM.translation() = centre;
  const InstanceId id =
      in.add_instance(in.meshes.back(), Internals::kFixed, X_WM, 1.0, {&material, 1}, "terrain");
  Internals::Terrain terrain;
  terrain.instance = id;
  terrain.field = field;
  terrain.centre_W = centre;
  in.terrains.push_back(std::move(terrain));
  return id;
}

Scene::InstanceId Scene::add_object(MeshId mesh, const Eigen::Isometry3d& X_WM, double scale,
                                    const Material& material, std::string_view name) {
  const Internals::Mesh& plain = internals_->meshes.at(mesh);
  if (!plain.materials.empty()) {
    throw std::invalid_argument("scene: '" + plain.name + "' is a model, with its own materials");
  }
  return internals_->add_instance(plain, Internals::kFixed, X_WM, scale, {&material, 1},
                                  name.empty() ? plain.name : name);
}

Scene::InstanceId Scene::add_model_object(MeshId model, const Eigen::Isometry3d& X_WM, double scale,
                                          std::string_view name) {
  const Internals::Mesh& parts = internals_->meshes.at(model);
  if (parts.materials.empty()) {
    throw std::invalid_argument("scene: '" + parts.name + "' is a plain mesh, no model");
  }
  return internals_->add_instance(parts, Internals::kFixed, X_WM, scale, parts.materials,
                                  name.empty() ? parts.name : name);
}

void Scene::add_canopy(const TriangleMesh& closed, const Eigen::Isometry3d& X_WM) {
  Internals& in = *internals_;
  const MeshId mesh = add_mesh(closed);
  GeometryHandle geometry(rtcNewGeometry(in.device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
  rtcSetGeometryInstancedScene(geometry.get(), in.meshes[mesh].scene.get());
  rtcAttachGeometry(in.canopy.get(), geometry.get());
  in.check("adding a canopy");
  in.placed.push_back({std::move(geometry), X_WM, 1.0, Internals::kFixed, 0, closed.name});
  in.has_canopy = true;
  in.fixed_placed = false;
}

Scene::BodyId Scene::add_body(std::string_view name) {
  internals_->bodies.emplace_back(name);
  return static_cast<BodyId>(internals_->bodies.size() - 1);
}

Scene::InstanceId Scene::add_body_part(BodyId body, MeshId mesh, const Eigen::Isometry3d& X_BM,
                                       const Material& material, std::string_view name) {
  if (body >= internals_->bodies.size()) {
    throw std::invalid_argument("scene: there is no body " + std::to_string(body));
  }
  const Internals::Mesh& plain = internals_->meshes.at(mesh);
  if (!plain.materials.empty()) {
    throw std::invalid_argument("scene: '" + plain.name + "' is a model; bodies take meshes");
  }
  return internals_->add_instance(plain, body, X_BM, 1.0, {&material, 1},
                                  name.empty() ? internals_->bodies[body] : name);
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
  return internals_->materials[internals_->instances.at(instance).material];
}

const std::string& Scene::name(InstanceId instance) const {
  return internals_->placed[internals_->instances.at(instance).placed].name;
}
const std::string& Scene::label(InstanceId instance) const {
  return material(instance).label;
}

std::uint32_t Scene::body_mask(BodyId body) {
  return 1U << (2U + body % 29U);
}
std::uint32_t Scene::foliage_mask() {
  return 1U << 1U;
}
std::uint32_t Scene::loose_leaves_mask() {
  return 1U << 31U;
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
  in.intersect(context, query);
  const std::uint32_t surface = surface_number(query.hit.instID[0], query.hit.geomID);
  if (surface == RTC_INVALID_GEOMETRY_ID) {
    return std::nullopt;
  }
  SceneHit hit;
  hit.range_m = query.ray.tfar;
  hit.instance = in.instance_of[surface];
  const Eigen::Vector3f normal_M(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z);
  hit.normal_W = (in.shading[surface].R_WM * normal_M).cast<double>().normalized();
  if (hit.normal_W.dot(direction_W) > 0.0) {
    hit.normal_W = -hit.normal_W;
  }
  return hit;
}

}  // namespace rigwire::sim
