// The scene that rays are cast into: terrain, fixed objects, and the moving links of machines.
//
// Built on Embree 3 (Wald et al., "Embree: a kernel framework for efficient CPU ray tracing", ACM
// TOG 33(4), 2014). Embree works in floats; so the scene keeps every pose in double in the world
// (east-north-up at the map origin), gives Embree poses relative to a local origin near the
// machine, and moves that origin when the machine has left it by more than kRebaseDistance_m. Range
// error against closed forms in double: below 0.1 mm within 100 m, wherever the map origin is
// (measured by `rigwire bench lidar`).
//
// Moving bodies are given by their poses at both ends of a slice of time; a ray at a time within
// the slice hits them at their poses at that time, blended linearly: the error of the blend is at
// most (w h)^2 / 8 times the distance from the body's origin (w rad/s turned over h seconds), 0.01
// mm at 8 m for 1 rad/s and slices of 3 ms.
//
// A terrain may change while the scene is used (digging): update_terrain() stages new heights,
// begin_slice() shows them.
//
// Fixed objects and moving ones are two of Embree's scenes, and a ray is cast into both: thousands
// of trees cost nothing in a slice of time, in which only bodies and dug terrain change. The fixed
// scene is rebuilt when the local origin moves.
//
// A fixed object may leave its place: a tree that is pushed over. displace() removes it from the
// fixed scene, which is rebuilt that one time, and adds it to the moving one.
//
// Thread use: casting is const and may run on many threads; building and begin_slice() may not run
// beside it. For rays of another thread, at other instants, there is twin(): a scene that shares
// meshes and everything fixed with this one, and has bodies and dug terrain of its own. Embree
// builds what moves in both at the same time, and what is fixed is never changed while a twin casts
// into it. A twin costs the memory of its terrain's tiles and some 100 bytes for each instance.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "fields/rules.h"
#include "sim/samples/time.h"
#include "sim/scene/height_field.h"
#include "sim/scene/node_rectangle.h"
#include "sim/scene/triangle_mesh.h"
#include "sim/visibility.h"

struct RTCSceneTy;  // Embree's

namespace rigwire::sim {

struct Material {
  double reflectance = 0.3;  ///< Diffuse, at the lidar's wavelength, 0 .. 1.
  std::string label = "ground";
  /// Above 0 a retro-reflector; 1 is an ideal one. Seen far beyond what diffuse surfaces are.
  double retro_gain = 0.0;
  /// Leaves and twigs in a closed surface: opaque to light, but radio signals pass, weakened by the
  /// metre.
  bool foliage = false;
  /// Single leaves, seen as they are: radio signals pass, and what weakens them is a canopy
  /// (Scene::add_canopy).
  bool loose_leaves = false;
  /// How far the reflectance differs over the surface and from object to object, 0 .. 1
  /// (reflectance_grain.h). For fixed things; bodies have one reflectance.
  double variation = 0.0;

  friend bool operator==(const Material&, const Material&) = default;
};
void visit(fields::Visitor& v, Material& p);

/// Throws std::invalid_argument naming the key, the value found and what is allowed.
void validate(const Material& material);

/// A part of a model: a mesh with its surface, the same in all instances of the model.
struct MeshPart {
  TriangleMesh mesh;
  Material material;
};

/// Where a moving body is at both ends of a slice.
struct BodyMotion {
  Eigen::Isometry3d X_WB_start = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d X_WB_end = Eigen::Isometry3d::Identity();
};

/// Something fixed that may leave its place: an object, or some triangles of its mesh.
struct ScenePiece {
  std::uint32_t thing = 0;  ///< Its (first) instance; of a canopy, its number.
  bool canopy = false;
  std::uint32_t first_triangle = 0;
  std::uint32_t triangles = 0;  ///< 0: the whole object.

  friend bool operator==(const ScenePiece&, const ScenePiece&) = default;
};
/// Geometry that rays hit for an obstacle (Ground::obstacles()).
struct ObstacleLook {
  std::size_t obstacle = 0;
  ScenePiece piece;
};
/// See scene_internals.h.
struct DisplacedPiece;

/// What is fixed in a scene, as it is placed around a local origin, and where the pieces are that
/// have left their places. A twin can cast into it as long as it is held.
struct ScenePlacement {
  std::shared_ptr<RTCSceneTy> fixed;
  Eigen::Vector3d origin_W = Eigen::Vector3d::Zero();
  std::shared_ptr<const std::vector<DisplacedPiece>> displaced;
};

/// Hit of a single ray.
struct SceneHit {
  double range_m = 0.0;
  Eigen::Vector3d normal_W = Eigen::Vector3d::UnitZ();  ///< Unit, towards the ray's start.
  std::uint32_t instance = 0;
};

class Scene final : public Visibility {
 public:
  using MeshId = std::uint32_t;
  using InstanceId = std::uint32_t;
  using BodyId = std::uint32_t;
  using CanopyId = std::uint32_t;

  /// Rays with this mask see everything.
  static constexpr std::uint32_t kSeeEverything = 0xFFFFFFFFU;
  static constexpr double kRebaseDistance_m = 64.0;
  /// Instances of a scene at most: about 1 kB of memory each.
  static constexpr std::size_t kMostInstances = 2'000'000;

  Scene();
  ~Scene() override;

  /// All of these throw std::invalid_argument for bad geometry or more than kMostInstances, and
  /// std::runtime_error for what the ray caster refuses. Instances are numbered in the order of the
  /// calls, from 0. `name` is for people and recordings; empty: the mesh's, or the body's.
  MeshId add_mesh(const TriangleMesh& mesh);
  InstanceId add_terrain(const HeightField& field, const Material& material);
  /// What lies on the cells of a terrain, for cameras: for each cell, row by row, the place of its
  /// label in `labels`. Lidars measure the reflectance of the label, where it has one above 0 (none
  /// has where `reflectances` is empty), and else that of the terrain's material. Throws
  /// std::invalid_argument when `terrain` is no terrain, there is not one cell for each of its own,
  /// a cell names no label, or there is not one reflectance of 0 .. 1 for each label.
  void cover_terrain(InstanceId terrain, std::vector<std::string> labels,
                     std::vector<std::uint8_t> cells, std::vector<double> reflectances = {});
  InstanceId add_object(MeshId mesh, const Eigen::Isometry3d& X_WM, double scale,
                        const Material& material, std::string_view name = {});
  BodyId add_body(std::string_view name);
  /// A moving body that no sensor sits on: all rays see it, and body_mask() does not know it.
  BodyId add_loose_body(std::string_view name);
  InstanceId add_body_part(BodyId body, MeshId mesh, const Eigen::Isometry3d& X_BM,
                           const Material& material, std::string_view name = {});

  /// A mesh of several surfaces (a tree of wood and leaves), to be placed by add_model_object().
  MeshId add_model(std::span<const MeshPart> parts);
  /// One instance for each part, numbered in their order from the returned one on, all of the same
  /// name. Throws std::invalid_argument when `model` is a plain mesh.
  InstanceId add_model_object(MeshId model, const Eigen::Isometry3d& X_WM, double scale,
                              std::string_view name);
  /// Adds closed surfaces that only sky_path() hits, as foliage: the crowns of trees whose leaves
  /// are modelled one by one.
  CanopyId add_canopy(const TriangleMesh& closed, const Eigen::Isometry3d& X_WM);

  /// Prepares a terrain for digging: it is kept in tiles from now on, so that a change costs only
  /// where it happened. Rays hit the same triangles as before. Throws std::invalid_argument when
  /// `terrain` is no terrain.
  void make_changeable(InstanceId terrain);
  /// Sets the minimum simulated time between two changes that the rays see; 0 at the start: every
  /// slice.
  void set_terrain_period(Duration period);
  /// Sets the heights of these nodes to those of `field`, a field of the terrain's own shape. Rays
  /// see them from the next begin_slice() that is a terrain period after the last change. Cheap by
  /// itself. Throws std::invalid_argument when the terrain is not changeable, the field's shape
  /// differs, the nodes are not in it, or a height is not a finite number.
  void update_terrain(InstanceId terrain, const HeightField& field, const NodeRectangle& changed);
  /// Sets the heights of these nodes, given row by row.
  void update_terrain(InstanceId terrain, const NodeRectangle& changed,
                      std::span<const double> heights_m);

  /// Moves the piece by `motion_W` from where it was added, from the next begin_slice() on; it
  /// keeps its instance, name and material. Cheap but for the first time of a piece: then
  /// everything fixed is placed anew, and the piece's mesh built without it. Throws
  /// std::invalid_argument when there is no such piece, it is terrain or on a body, or the motion
  /// is not finite.
  void displace(const ScenePiece& piece, const Eigen::Isometry3d& motion_W);

  /// Places the bodies for rays with times in [t0, t1] and makes the scene ready to cast.
  /// `motions[i]` is of body i; `focus_W` is where the sensors are (any point within some hundred
  /// metres of them). Must be called before the first cast, with t0 < t1. Throws
  /// std::invalid_argument when motions do not match the bodies or are not finite.
  void begin_slice(SimTime t0, SimTime t1, const Eigen::Vector3d& focus_W,
                   std::span<const BodyMotion> motions);

  /// In place of begin_slice(), for a slice in which no ray is cast: placement() and what later
  /// slices show are as after it, but nothing that moves is placed for rays. Costs next to nothing.
  /// Throws std::invalid_argument as begin_slice().
  void pass_slice(SimTime t0, SimTime t1, const Eigen::Vector3d& focus_W);

  /// A scene with the same instances and bodies, for rays of another thread. Nothing can be added
  /// to either from now on. Canopies are left out: sky_path() of a twin knows closed crowns only.
  [[nodiscard]] std::unique_ptr<Scene> twin() const;
  /// What is fixed as it is placed at present; after the first begin_slice().
  [[nodiscard]] ScenePlacement placement() const;
  /// For twins: begin_slice() with what is fixed as `placement` has it. Shows staged terrain at
  /// once.
  void begin_slice(SimTime t0, SimTime t1, const ScenePlacement& placement,
                   std::span<const BodyMotion> motions);

  [[nodiscard]] std::size_t instance_count() const;
  [[nodiscard]] std::size_t body_count() const;
  /// End of the slice that rays are cast in; nothing before the first begin_slice().
  [[nodiscard]] std::optional<SimTime> slice_end() const;
  [[nodiscard]] const Material& material(InstanceId instance) const;
  [[nodiscard]] const std::string& name(InstanceId instance) const;
  [[nodiscard]] const std::string& label(InstanceId instance) const;
  /// Returns the mask bit of a body; rays that must not see it leave the bit out of their mask.
  /// Bodies share bits from the 30th on.
  [[nodiscard]] static std::uint32_t body_mask(BodyId body);
  /// Returns the mask bits of all foliage, whatever body it is on.
  [[nodiscard]] static std::uint32_t foliage_mask();
  /// Returns the mask bits of all loose leaves.
  [[nodiscard]] static std::uint32_t loose_leaves_mask();

  /// First hit between `near_m` and `far_m` along the unit vector `direction_W`, at `time` (held at
  /// the slice's ends).
  [[nodiscard]] std::optional<SceneHit> cast(const Eigen::Vector3d& p_W,
                                             const Eigen::Vector3d& direction_W, double near_m,
                                             double far_m, SimTime time,
                                             std::uint32_t mask = kSeeEverything) const;
  /// Whether something fixed lies within `far_m` along the unit vector: neither bodies nor
  /// displaced pieces, nor terrain that was made changeable. After the first slice, begun or
  /// passed; before it nothing does.
  [[nodiscard]] bool fixed_within(const Eigen::Vector3d& p_W, const Eigen::Vector3d& direction_W,
                                  double far_m) const;
  /// At the end of the slice; the machine's own links count.
  [[nodiscard]] bool blocked(const Eigen::Vector3d& p_W, const Eigen::Vector3d& direction_W,
                             double clearance_m) const override;
  /// At the end of the slice. Foliage is what lies within the closed surfaces of foliage materials,
  /// counted once where they overlap; it is measured from the ray's very start, which may be
  /// inside.
  [[nodiscard]] SkyPath sky_path(const Eigen::Vector3d& p_W, const Eigen::Vector3d& direction_W,
                                 double clearance_m) const override;
  /// At the end of the slice.
  [[nodiscard]] std::optional<ReflectingSurface> surface(const Eigen::Vector3d& p_W,
                                                         const Eigen::Vector3d& direction_W,
                                                         double clearance_m,
                                                         double reach_m) const override;

  /// For casters within sim/ (sim/scene/scene_internals.h).
  struct Internals;
  [[nodiscard]] const Internals& internals() const { return *internals_; }

 private:
  struct Twin {};
  explicit Scene(Twin);

  std::unique_ptr<Internals> internals_;
};

}  // namespace rigwire::sim
