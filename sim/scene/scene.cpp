#include "sim/scene/scene.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "fields/check.h"
#include "fields/visitor.h"
#include "sim/scene/painted_surface.h"
#include "sim/scene/reflectance_grain.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {

using fields::plain;

namespace {

void remember_error(void* user, RTCError /*code*/, const char* text) {
  auto& error = *static_cast<RayCasterError*>(user);
  const std::scoped_lock lock(error.mutex);
  if (error.text.empty()) {
    error.text = text != nullptr ? text : "unknown error";
  }
}

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

constexpr float kForever = std::numeric_limits<float>::infinity();
/// A ray through an edge hits both of its triangles at the same place.
constexpr float kSameCrossing_m = 1e-4F;
constexpr std::size_t kMostCrossings = 256;

struct Crossing {
  float range_m = 0.0F;
  bool inwards = false;
};

/// Crossings of foliage on one ray; farther ones than the buffer holds are not counted.
struct CountingContext {
  RTCIntersectContext context;  // the first member: Embree hands it back to the filter
  std::array<Crossing, kMostCrossings> crossings;
  std::size_t count = 0;
};

/// Notes the crossing and lets the ray go on.
void note_crossing(const RTCFilterFunctionNArguments* arguments) {
  auto* counting = reinterpret_cast<CountingContext*>(arguments->context);
  const auto* ray = reinterpret_cast<const RTCRay*>(arguments->ray);
  const auto* hit = reinterpret_cast<const RTCHit*>(arguments->hit);
  if (counting->count < kMostCrossings) {
    // Normal and direction are both in the mesh's frame here.
    const float along = hit->Ng_x * ray->dir_x + hit->Ng_y * ray->dir_y + hit->Ng_z * ray->dir_z;
    counting->crossings[counting->count++] = {ray->tfar, along < 0.0F};
  }
  arguments->valid[0] = 0;
}

/// Length within surfaces that are crossed at these places, from 0 to `end_m`; the ray leaves all
/// of them in the end, so that what it does not enter it started in.
double length_within(std::span<Crossing> crossings, double end_m) {
  std::ranges::sort(crossings, {}, &Crossing::range_m);
  const auto twin = [](const Crossing& a, const Crossing& b) {
    return a.inwards == b.inwards && b.range_m - a.range_m < kSameCrossing_m;
  };
  const auto last = std::unique(crossings.begin(), crossings.end(), twin);
  int depth = 0;
  for (auto it = crossings.begin(); it != last; ++it) {
    depth += it->inwards ? -1 : 1;
  }
  double length_m = 0.0;
  double from_m = 0.0;
  for (auto it = crossings.begin(); it != last && from_m < end_m; ++it) {
    const double to_m = std::min(double{it->range_m}, end_m);
    length_m += depth > 0 ? to_m - from_m : 0.0;
    depth += it->inwards ? 1 : -1;
    from_m = to_m;
  }
  return length_m;
}

}  // namespace

void visit(fields::Visitor& v, Material& p) {
  v.number("reflectance", p.reflectance, plain().between(0, 1), "Diffuse reflectance at 905 nm.");
  v.text("label", p.label, "What the surface is, for recordings.");
  v.number("retro_gain", p.retro_gain, plain().between(0, 1),
           "Gain of a retro-reflector; 1 is an ideal one, 0 is none.");
  v.number("variation", p.variation, plain().between(0, 1),
           "Spread of the reflectance over the surface, of things that do not move.");
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
  const std::scoped_lock lock(error->mutex);
  if (!error->text.empty()) {
    throw std::runtime_error("scene: " + std::string(doing) + ": " +
                             std::exchange(error->text, {}));
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

GeometryHandle Scene::Internals::place_instance(RTCScene scene, const Placed& thing,
                                                const Mesh& mesh) const {
  GeometryHandle geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
  rtcSetGeometryInstancedScene(geometry.get(), mesh.scene.get());
  rtcSetGeometryMask(geometry.get(), thing.mask);
  if (thing.body != kFixed) {
    rtcSetGeometryTimeStepCount(geometry.get(), 2);
  }
  rtcAttachGeometryByID(scene, geometry.get(), thing.geometry_id);
  return geometry;
}

Scene::InstanceId Scene::Internals::add_instance(MeshId mesh, std::uint32_t body,
                                                 const Eigen::Isometry3d& X_PM, double scale,
                                                 std::span<const Material> surfaces,
                                                 std::string_view name, bool terrain) {
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
    mask |= surface_mask(surface, body != kFixed && loose[body] ? kFixed : body);
  }
  const auto first = static_cast<InstanceId>(instances.size());
  std::uint32_t geometry_id = RTC_INVALID_GEOMETRY_ID;  // of the first part
  for (const Material& surface : surfaces) {
    const auto id = static_cast<InstanceId>(instances.size());
    Shading shown{X_PM.linear().cast<float>(), static_cast<float>(surface.reflectance),
                  static_cast<float>(surface.retro_gain)};
    if (body == kFixed && surface.variation > 0.0) {
      shown.variation = static_cast<float>(surface.variation);
      if (!terrain) {
        // From object to object: evenly within half the variation.
        const auto bits = static_cast<double>(grain_bits(id, 0U, 0U));
        shown.reflectance *= static_cast<float>(1.0 + surface.variation * (bits * 0x1.0p-32 - 0.5));
      }
      varies = true;
    }
    geometry_id =
        std::min(geometry_id, body == kFixed ? new_fixed_id(id, shown) : new_moving_id(id, shown));
    const auto& paints = meshes[mesh].painted;
    instances.push_back({static_cast<std::uint32_t>(placed.size()), material_index(surface),
                         paints.empty() ? 0U : paints[id - first]});
    has_foliage = has_foliage || surface.foliage;
  }
  RTCBounds bounds{};
  rtcGetSceneBounds(meshes[mesh].scene.get(), &bounds);
  Placed thing{nullptr,
               X_PM,
               scale,
               body,
               geometry_id,
               std::string(name),
               mesh,
               mask,
               {Eigen::Vector3f(bounds.lower_x, bounds.lower_y, bounds.lower_z),
                Eigen::Vector3f(bounds.upper_x, bounds.upper_y, bounds.upper_z)}};
  thing.geometry = place_instance(body == kFixed ? fixed.get() : moving.get(), thing, meshes[mesh]);
  check("adding an object");
  if (body != kFixed) {
    on_bodies.push_back(static_cast<std::uint32_t>(placed.size()));
  } else {
    fixed_placed = false;
  }
  placed.push_back(std::move(thing));
  return first;
}

Scene::Scene() : internals_(std::make_unique<Internals>()) {
  // Embree builds on the calling thread alone: the scene is small, and the executive owns the
  // machine's other cores. With more threads permitted, TBB's worker would be woken by each slice's
  // commit and spend a tenth of a core looking for work.
  internals_->error = std::make_shared<RayCasterError>();
  internals_->device.reset(rtcNewDevice("threads=1,user_threads=1"), ReleaseDevice{});
  if (!internals_->device) {
    throw std::runtime_error("scene: the ray caster (Embree) cannot start on this machine");
  }
  rtcSetDeviceErrorFunction(internals_->device.get(), remember_error, internals_->error.get());
  if (rtcGetDeviceProperty(internals_->device.get(), RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED) == 0) {
    throw std::runtime_error("scene: this build of Embree has no ray masks");
  }
  internals_->moving.reset(rtcNewScene(internals_->device.get()));
  rtcSetSceneFlags(internals_->moving.get(),
                   static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC));
  internals_->fixed.reset(rtcNewScene(internals_->device.get()), ReleaseScene{});
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

/// Gives Embree the terrain as one grid geometry, whose vertices are floats relative to the field's
/// centre, and adds one fixed instance of it there.
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
      in.add_instance(static_cast<MeshId>(in.meshes.size() - 1), Internals::kFixed, X_WM, 1.0,
                      {&material, 1}, "terrain", true);
  Internals::Terrain terrain;
  terrain.instance = id;
  terrain.field = field;
  terrain.centre_W = centre;
  in.terrains.push_back(std::move(terrain));
  return id;
}

void Scene::cover_terrain(InstanceId terrain, std::vector<std::string> labels,
                          std::vector<std::uint8_t> cells, std::vector<double> reflectances) {
  Internals::Terrain& covered = internals_->terrain_of(terrain);
  const auto columns = static_cast<int>(covered.field.columns) - 1;
  const auto rows = static_cast<int>(covered.field.rows) - 1;
  const auto count = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  if (cells.size() != count ||
      std::ranges::any_of(cells, [&](std::uint8_t cell) { return cell >= labels.size(); })) {
    throw std::invalid_argument("scene: the cover of a terrain has " +
                                std::to_string(cells.size()) + " cells and " +
                                std::to_string(labels.size()) + " labels, allowed are " +
                                std::to_string(count) + " cells that name one of the labels each");
  }
  if ((!reflectances.empty() && reflectances.size() != labels.size()) ||
      std::ranges::any_of(reflectances, [](double rho) { return !(rho >= 0.0 && rho <= 1.0); })) {
    throw std::invalid_argument("scene: the cover of a terrain has " +
                                std::to_string(reflectances.size()) + " reflectances for " +
                                std::to_string(labels.size()) +
                                " labels, allowed are none, or one of 0 to 1 for each");
  }
  const auto at = [&](int column, int row) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  };
  // Along the rows, then along the columns of what differs there.
  constexpr int kReach = Internals::kCoverReach;
  std::vector<std::uint8_t> in_row(count, 0);
  std::vector<std::uint8_t> near_edge(count, 0);
  const auto mark = [](std::vector<std::uint8_t>& marks, const auto& index, int place, int end) {
    for (int k = std::max(0, place - kReach + 1); k <= std::min(end - 1, place + kReach); ++k) {
      marks[index(k)] = 1;
    }
  };
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column + 1 < columns; ++column) {
      if (cells[at(column, row)] != cells[at(column + 1, row)]) {
        mark(
            in_row, [&](int k) { return at(k, row); }, column, columns);
      }
    }
  }
  for (int column = 0; column < columns; ++column) {
    for (int row = 0; row < rows; ++row) {
      const bool differs = row + 1 < rows && cells[at(column, row)] != cells[at(column, row + 1)];
      if (differs || in_row[at(column, row)] != 0) {
        mark(
            near_edge, [&](int k) { return at(column, k); }, row, rows);
        near_edge[at(column, row)] = 1;
      }
    }
  }
  auto cover =
      std::make_shared<Internals::Cover>(std::move(labels), std::move(cells), std::move(near_edge));
  cover->origin_m = covered.field.origin_m;
  cover->cell_m = covered.field.cell_m;
  cover->columns = columns;
  cover->rows = rows;
  const bool own = std::ranges::any_of(reflectances, [](double rho) { return rho > 0.0; });
  if (own) {
    cover->reflectances.assign(reflectances.begin(), reflectances.end());
    internals_->varies = true;
  }
  covered.cover = std::move(cover);
  for (std::size_t i = 0; i < internals_->shading.size(); ++i) {
    if (internals_->instance_of[i] == terrain) {
      internals_->shading[i].cover = own ? covered.cover.get() : nullptr;
    }
  }
}

Scene::InstanceId Scene::add_object(MeshId mesh, const Eigen::Isometry3d& X_WM, double scale,
                                    const Material& material, std::string_view name) {
  const Internals::Mesh& plain = internals_->meshes.at(mesh);
  if (!plain.materials.empty()) {
    throw std::invalid_argument("scene: '" + plain.name + "' is a model, with its own materials");
  }
  return internals_->add_instance(mesh, Internals::kFixed, X_WM, scale, {&material, 1},
                                  name.empty() ? plain.name : name);
}

Scene::InstanceId Scene::add_model_object(MeshId model, const Eigen::Isometry3d& X_WM, double scale,
                                          std::string_view name) {
  const Internals::Mesh& parts = internals_->meshes.at(model);
  if (parts.materials.empty()) {
    throw std::invalid_argument("scene: '" + parts.name + "' is a plain mesh, no model");
  }
  return internals_->add_instance(model, Internals::kFixed, X_WM, scale, parts.materials,
                                  name.empty() ? parts.name : name);
}

Scene::CanopyId Scene::add_canopy(const TriangleMesh& closed, const Eigen::Isometry3d& X_WM) {
  Internals& in = *internals_;
  const MeshId mesh = add_mesh(closed);
  GeometryHandle geometry(rtcNewGeometry(in.device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
  rtcSetGeometryInstancedScene(geometry.get(), in.meshes[mesh].scene.get());
  const unsigned id = rtcAttachGeometry(in.canopy.get(), geometry.get());
  in.check("adding a canopy");
  in.placed.push_back(
      {std::move(geometry), X_WM, 1.0, Internals::kFixed, id, closed.name, mesh, 0, {}});
  in.has_canopy = true;
  in.fixed_placed = false;
  return static_cast<CanopyId>(in.placed.size() - 1);
}

Scene::BodyId Scene::add_loose_body(std::string_view name) {
  const BodyId body = add_body(name);
  internals_->loose[body] = true;
  return body;
}

Scene::BodyId Scene::add_body(std::string_view name) {
  internals_->bodies.emplace_back(name);
  internals_->loose.push_back(false);
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
  return internals_->add_instance(mesh, body, X_BM, 1.0, {&material, 1},
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

bool Scene::fixed_within(const Eigen::Vector3d& p_W, const Eigen::Vector3d& direction_W,
                         double far_m) const {
  const Internals& in = *internals_;
  if (!in.fixed_placed) {
    return false;
  }
  const FlushDenormals flush;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray = make_ray(p_W - in.origin_W, direction_W, 0.0, far_m, 0.0F, kSeeEverything);
  rtcOccluded1(in.fixed.get(), &context, &ray);
  return ray.tfar < 0.0F;
}

// Meshes as Embree takes them, with holes.

/// A mask becomes an Embree filter function, which lets rays pass through clear texels
/// (pass_holes()); for it each triangle's texture coordinates are stored as a corner and two edges.
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
    auto surface = std::make_shared<MaskedSurface>();
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
  // The context's filter is for rays that count the crossings of foliage.
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
  std::vector<std::uint32_t> paints;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i]->colour) {
      paints.resize(parts.size());
      painted.push_back(painted_surface(*parts[i]));
      paints[i] = static_cast<std::uint32_t>(painted.size());
    }
  }
  std::vector<std::size_t> part_triangles;
  for (std::size_t i = 0; !surfaces.empty() && i < parts.size(); ++i) {
    part_triangles.push_back(parts[i]->triangles.size());
  }
  meshes.push_back({std::move(inner),
                    std::move(name),
                    std::move(surfaces),
                    parts.front()->triangles.size(),
                    {},
                    std::move(paints),
                    std::move(part_triangles)});
  return static_cast<MeshId>(meshes.size() - 1);
}

// The part of Scene and its internals that lets a terrain change.

Scene::Internals::Terrain& Scene::Internals::terrain_of(std::uint32_t instance) {
  const auto found = std::ranges::find(terrains, instance, &Terrain::instance);
  if (found == terrains.end()) {
    throw std::invalid_argument("scene: instance " + std::to_string(instance) + " is no terrain");
  }
  return *found;
}

Scene::Internals::Tile Scene::Internals::make_tile(const Terrain& terrain, std::size_t first_column,
                                                   std::size_t first_row, std::uint32_t number) {
  const HeightField& field = terrain.field;
  Tile tile;
  tile.first_column = first_column;
  tile.first_row = first_row;
  // One cell over the next tile: no ray along the border may pass between the two.
  tile.columns = std::min(terrain.tile_cells + 2, field.columns - first_column);
  tile.rows = std::min(terrain.tile_cells + 2, field.rows - first_row);
  tile.ground.reset(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
  tile.vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(tile.ground.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                              3 * sizeof(float), tile.columns * tile.rows));
  auto* corner = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(tile.ground.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(unsigned), 2 * (tile.columns - 1) * (tile.rows - 1)));
  check("terrain tile");
  float* vertex = tile.vertices;
  // The floats must equal those of the undivided terrain.
  for (std::size_t r = first_row; r < first_row + tile.rows; ++r) {
    for (std::size_t c = first_column; c < first_column + tile.columns; ++c) {
      *vertex++ = static_cast<float>(field.origin_m.x() - terrain.centre_W.x() +
                                     field.cell_m * static_cast<double>(c));
      *vertex++ = static_cast<float>(field.origin_m.y() - terrain.centre_W.y() +
                                     field.cell_m * static_cast<double>(r));
      *vertex++ = static_cast<float>(field.node(c, r) - terrain.centre_W.z());
    }
  }
  // The two triangles, and their corners' order, into which Embree splits a cell of a grid.
  const auto across = static_cast<unsigned>(tile.columns);
  for (unsigned r = 0; r + 1 < tile.rows; ++r) {
    for (unsigned c = 0; c + 1 < across; ++c) {
      const unsigned here = r * across + c;
      const unsigned north = here + across;
      for (const unsigned node : {here, here + 1, north, north + 1, north, here + 1}) {
        *corner++ = node;
      }
    }
  }
  // Digging moves nodes up and down, so that boxes of the first build, fitted anew, stay good ones;
  // building anew takes 20 times as long. Embree fits only in scenes of low quality.
  rtcSetGeometryBuildQuality(tile.ground.get(), RTC_BUILD_QUALITY_REFIT);
  rtcCommitGeometry(tile.ground.get());
  tile.inner.reset(rtcNewScene(device.get()));
  rtcSetSceneFlags(tile.inner.get(),
                   static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC));
  rtcSetSceneBuildQuality(tile.inner.get(), RTC_BUILD_QUALITY_LOW);
  rtcAttachGeometry(tile.inner.get(), tile.ground.get());
  rtcCommitScene(tile.inner.get());
  tile.placed.reset(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
  rtcSetGeometryInstancedScene(tile.placed.get(), tile.inner.get());
  rtcSetGeometryMask(tile.placed.get(), 1U);
  tile.number = number;
  rtcAttachGeometryByID(moving.get(), tile.placed.get(), number);
  check("terrain tile");
  return tile;
}

void Scene::Internals::refresh_terrains(SimTime begin) {
  for (Terrain& terrain : terrains) {
    if (!terrain.staged || (terrain.shown && begin - *terrain.shown < terrain_period)) {
      continue;
    }
    const NodeRectangle changed = *terrain.staged;
    for (Tile& tile : terrain.tiles) {
      const std::size_t first_column = std::max(changed.first_column, tile.first_column);
      const std::size_t first_row = std::max(changed.first_row, tile.first_row);
      const std::size_t end_column =
          std::min(changed.last_column + 1, tile.first_column + tile.columns);
      const std::size_t end_row = std::min(changed.last_row + 1, tile.first_row + tile.rows);
      if (first_column >= end_column || first_row >= end_row) {
        continue;
      }
      for (std::size_t r = first_row; r < end_row; ++r) {
        for (std::size_t c = first_column; c < end_column; ++c) {
          const std::size_t vertex = (r - tile.first_row) * tile.columns + (c - tile.first_column);
          tile.vertices[3 * vertex + 2] =
              static_cast<float>(terrain.field.node(c, r) - terrain.centre_W.z());
        }
      }
      tile.reshaped = true;
    }
    terrain.staged.reset();
    terrain.shown = begin;
  }
}

void Scene::Internals::commit_tiles() {
  for (Terrain& terrain : terrains) {
    for (Tile& tile : terrain.tiles) {
      if (!std::exchange(tile.reshaped, false)) {
        continue;
      }
      rtcUpdateGeometryBuffer(tile.ground.get(), RTC_BUFFER_TYPE_VERTEX, 0);
      rtcCommitGeometry(tile.ground.get());
      rtcCommitScene(tile.inner.get());
      rtcCommitGeometry(tile.placed.get());
    }
  }
}

void Scene::make_changeable(InstanceId terrain) {
  Internals& in = *internals_;
  Internals::Terrain& changing = in.terrain_of(terrain);
  if (!changing.tiles.empty()) {
    return;
  }
  Internals::Placed& whole = in.placed[in.instances[terrain].placed];
  rtcDetachGeometry(in.fixed.get(), whole.geometry_id);
  whole.mask = 0;
  // Small tiles are quick to rebuild; every slice pays for their number.
  constexpr std::size_t kLeastCells = 32;
  constexpr std::size_t kTilesAlong = 16;
  const Internals::Shading surface = in.shading[whole.geometry_id];
  const std::size_t nodes = std::max(changing.field.columns, changing.field.rows);
  changing.tile_cells = std::max(kLeastCells, (nodes + kTilesAlong - 1) / kTilesAlong);
  for (std::size_t r = 0; r + 1 < changing.field.rows; r += changing.tile_cells) {
    for (std::size_t c = 0; c + 1 < changing.field.columns; c += changing.tile_cells) {
      changing.tiles.push_back(in.make_tile(changing, c, r, in.new_moving_id(terrain, surface)));
    }
  }
  in.ground_moves = true;
  in.fixed_placed = false;
}

void Scene::set_terrain_period(Duration period) {
  internals_->terrain_period = period;
}

void Scene::update_terrain(InstanceId terrain, const HeightField& field,
                           const NodeRectangle& changed) {
  const HeightField& staged = internals_->terrain_of(terrain).field;
  if (field.columns != staged.columns || field.rows != staged.rows ||
      field.heights_m.size() != staged.heights_m.size() ||
      changed.first_column > changed.last_column || changed.last_column >= field.columns ||
      changed.first_row > changed.last_row || changed.last_row >= field.rows) {
    throw std::invalid_argument("scene: the changed nodes do not lie in terrain " +
                                std::to_string(terrain));
  }
  update_terrain(terrain, changed, heights_in(field, changed));
}

void Scene::update_terrain(InstanceId terrain, const NodeRectangle& changed,
                           std::span<const double> heights_m) {
  Internals::Terrain& changing = internals_->terrain_of(terrain);
  HeightField& staged = changing.field;
  if (changing.tiles.empty()) {
    throw std::invalid_argument("scene: terrain " + std::to_string(terrain) +
                                " was not made changeable");
  }
  if (changed.first_column > changed.last_column || changed.first_row > changed.last_row ||
      changed.last_column >= staged.columns || changed.last_row >= staged.rows ||
      heights_m.size() != changed.nodes()) {
    throw std::invalid_argument("scene: the changed nodes do not lie in terrain " +
                                std::to_string(terrain));
  }
  const double* height = heights_m.data();
  for (std::size_t r = changed.first_row; r <= changed.last_row; ++r) {
    for (std::size_t c = changed.first_column; c <= changed.last_column; ++c, ++height) {
      if (!std::isfinite(*height)) {
        throw std::invalid_argument("scene: height at column " + std::to_string(c) + ", row " +
                                    std::to_string(r) + " is not a finite number");
      }
      staged.heights_m[r * staged.columns + c] = *height;
    }
  }
  ++changing.updates;
  changing.staged = changing.staged ? changing.staged->joined(changed) : changed;
}

// Placing things for a slice of time: the part of Scene that updates Embree.

void Scene::Internals::place_fixed() {
  // Others may be casting into the present one; it is theirs then.
  const bool shared = fixed.use_count() > 1;
  std::atomic_thread_fence(std::memory_order_acquire);
  if (shared) {
    fixed.reset(rtcNewScene(device.get()), ReleaseScene{});
    rtcSetSceneFlags(fixed.get(), RTC_SCENE_FLAG_ROBUST);
  }
  for (Placed& thing : placed) {
    if (thing.body != kFixed) {
      continue;
    }
    if (thing.gone) {
      if (!shared && thing.geometry) {
        rtcDetachGeometry(fixed.get(), thing.geometry_id);
      }
      thing.geometry.reset();
      continue;
    }
    if (thing.mask != 0 && (shared || thing.reshaped)) {
      if (!shared) {
        rtcDetachGeometry(fixed.get(), thing.geometry_id);
      }
      thing.geometry = place_instance(fixed.get(), thing, meshes[thing.mesh]);
    }
    thing.reshaped = false;
    set_transform(thing.geometry.get(), to_transform(thing.X_PM, thing.scale, origin_W));
  }
  place_tiles();
  rtcCommitScene(fixed.get());
  if (has_canopy) {
    rtcCommitScene(canopy.get());
  }
  fixed_placed = true;
}

void Scene::Internals::place_tiles() {
  for (const Terrain& terrain : terrains) {
    const Placed& thing = placed_of(terrain.instance);
    for (const Tile& tile : terrain.tiles) {
      set_transform(tile.placed.get(), to_transform(thing.X_PM, thing.scale, origin_W));
    }
  }
}

void Scene::Internals::place_bodies(std::span<const BodyMotion> motions) {
  for (const std::uint32_t index : on_bodies) {
    const Placed& thing = placed[index];
    const BodyMotion& motion = motions[thing.body];
    const Transform start = to_transform(motion.X_WB_start * thing.X_PM, thing.scale, origin_W);
    const Transform end = to_transform(motion.X_WB_end * thing.X_PM, thing.scale, origin_W);
    RTCGeometry geometry = thing.geometry.get();
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, start.data());
    rtcSetGeometryTransform(geometry, 1, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, end.data());
    rtcCommitGeometry(geometry);
    shading[thing.geometry_id].R_WM =
        (motion.X_WB_end.linear() * thing.X_PM.linear()).cast<float>();
  }
}

void Scene::Internals::check_slice(SimTime begin, SimTime end,
                                   std::span<const BodyMotion> motions) const {
  if (motions.size() != bodies.size()) {
    throw std::invalid_argument("scene: " + std::to_string(motions.size()) + " motions for " +
                                std::to_string(bodies.size()) + " bodies");
  }
  for (std::size_t i = 0; i < motions.size(); ++i) {
    if (!motions[i].X_WB_start.matrix().allFinite() || !motions[i].X_WB_end.matrix().allFinite()) {
      throw std::invalid_argument("scene: the pose of body '" + bodies[i] + "' is not finite");
    }
  }
  if (end <= begin) {
    throw std::invalid_argument("scene: a slice needs t0 < t1");
  }
}

void Scene::Internals::place_moving(SimTime begin, SimTime end,
                                    std::span<const BodyMotion> motions) {
  t0 = begin;
  t1 = end;
  body_motions.assign(motions.begin(), motions.end());
  refresh_terrains(begin);
  commit_tiles();
  place_bodies(motions);
  place_displaced();
  rtcCommitScene(moving.get());
  check("placing the bodies");
}

void Scene::Internals::follow(const Eigen::Vector3d& focus_W) {
  if (!focus_W.allFinite()) {
    throw std::invalid_argument("scene: a slice needs a finite focus");
  }
  if ((focus_W - origin_W).norm() > kRebaseDistance_m) {
    origin_W = focus_W.array().round();
    fixed_placed = false;
  }
  if (!fixed_placed) {
    place_fixed();
  }
}

void Scene::begin_slice(SimTime t0, SimTime t1, const Eigen::Vector3d& focus_W,
                        std::span<const BodyMotion> motions) {
  Internals& in = *internals_;
  in.check_slice(t0, t1, motions);
  in.follow(focus_W);
  in.place_moving(t0, t1, motions);
}

void Scene::pass_slice(SimTime t0, SimTime t1, const Eigen::Vector3d& focus_W) {
  if (t1 <= t0) {
    throw std::invalid_argument("scene: a slice needs t0 < t1");
  }
  internals_->follow(focus_W);
  internals_->refresh_terrains(t0);
}

// A second scene of the same things.

Scene::Scene(Twin) : internals_(std::make_unique<Internals>()) {}

std::unique_ptr<Scene> Scene::twin() const {
  const Internals& from = *internals_;
  std::unique_ptr<Scene> scene(new Scene(Twin{}));
  Internals& in = *scene->internals_;
  in.error = from.error;
  in.device = from.device;
  in.moving.reset(rtcNewScene(in.device.get()));
  rtcSetSceneFlags(in.moving.get(),
                   static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC));
  in.canopy.reset(rtcNewScene(in.device.get()));
  in.masked = from.masked;
  in.painted = from.painted;
  in.on_bodies = from.on_bodies;
  in.instances = from.instances;
  in.materials = from.materials;
  in.shading = from.shading;
  in.instance_of = from.instance_of;
  in.bodies = from.bodies;
  in.canopies_kept = false;
  in.ground_moves = from.ground_moves;
  in.has_foliage = from.has_foliage;
  in.varies = from.varies;
  in.placed.reserve(from.placed.size());
  for (const Internals::Placed& thing : from.placed) {
    in.placed.push_back({nullptr, thing.X_PM, thing.scale, thing.body, thing.geometry_id,
                         thing.name, thing.mesh, thing.mask, thing.bounds_M});
  }
  for (const std::uint32_t index : in.on_bodies) {
    Internals::Placed& thing = in.placed[index];
    thing.geometry = in.place_instance(in.moving.get(), thing, from.meshes[thing.mesh]);
  }
  for (const Internals::Terrain& terrain : from.terrains) {
    Internals::Terrain own;
    own.instance = terrain.instance;
    own.cover = terrain.cover;
    own.field = terrain.field;
    own.centre_W = terrain.centre_W;
    own.tile_cells = terrain.tile_cells;
    // Numbered as there: bodies' parts and tiles have the numbers of their surfaces.
    for (const Internals::Tile& tile : terrain.tiles) {
      own.tiles.push_back(in.make_tile(own, tile.first_column, tile.first_row, tile.number));
    }
    in.terrains.push_back(std::move(own));
  }
  in.low_numbers_used = from.low_numbers_used;
  in.check("making a twin");
  return scene;
}

ScenePlacement Scene::placement() const {
  return {internals_->fixed, internals_->origin_W, internals_->displaced};
}

void Scene::begin_slice(SimTime t0, SimTime t1, const ScenePlacement& placement,
                        std::span<const BodyMotion> motions) {
  Internals& in = *internals_;
  in.check_slice(t0, t1, motions);
  if (in.fixed != placement.fixed) {
    in.fixed = placement.fixed;
    in.origin_W = placement.origin_W;
    in.place_tiles();
  }
  in.displaced = placement.displaced;
  in.place_moving(t0, t1, motions);
}

// Rays of satellite signals: solid things block them, crowns let them pass.

bool Scene::blocked(const Eigen::Vector3d& p_W, const Eigen::Vector3d& direction_W,
                    double clearance_m) const {
  const Internals& in = *internals_;
  const FlushDenormals flush;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray =
      make_ray(p_W - in.origin_W, direction_W, clearance_m, kForever, 1.0F, kSeeEverything);
  rtcOccluded1(in.moving.get(), &context, &ray);
  if (ray.tfar >= 0.0F) {
    rtcOccluded1(in.fixed.get(), &context, &ray);
  }
  return ray.tfar < 0.0F;
}

SkyPath Scene::sky_path(const Eigen::Vector3d& p_W, const Eigen::Vector3d& direction_W,
                        double clearance_m) const {
  const Internals& in = *internals_;
  SkyPath path;
  double end_m = std::numeric_limits<double>::infinity();
  if (const auto solid = surface(p_W, direction_W, clearance_m, end_m)) {
    path.blocked = true;
    end_m = solid->range_m;
  }
  if (!in.has_foliage && !in.has_canopy) {
    return path;
  }
  const FlushDenormals flush;
  CountingContext counting;
  rtcInitIntersectContext(&counting.context);
  counting.context.filter = note_crossing;
  const auto count_in = [&](RTCScene scene, std::uint32_t mask) {
    RTCRayHit query{};
    query.ray = make_ray(p_W - in.origin_W, direction_W, 0.0, kForever, 1.0F, mask);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &counting.context, &query);
  };
  if (in.has_foliage) {
    count_in(in.moving.get(), foliage_mask());
    count_in(in.fixed.get(), foliage_mask());
  }
  if (in.has_canopy) {
    count_in(in.canopy.get(), kSeeEverything);
  }
  path.foliage_m = length_within({counting.crossings.data(), counting.count}, end_m);
  return path;
}

std::optional<ReflectingSurface> Scene::surface(const Eigen::Vector3d& p_W,
                                                const Eigen::Vector3d& direction_W,
                                                double clearance_m, double reach_m) const {
  const auto hit = cast(p_W, direction_W, clearance_m, reach_m, internals_->t1,
                        ~(foliage_mask() | loose_leaves_mask()));
  if (!hit) {
    return std::nullopt;
  }
  return ReflectingSurface{hit->range_m, hit->normal_W};
}

}  // namespace rigwire::sim
