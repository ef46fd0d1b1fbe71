// What the casters of sim/ share with the scene: Embree's handles. Not for other folders.
#pragma once

#include <embree3/rtcore.h>
#include <pmmintrin.h>
#include <xmmintrin.h>

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim/scene/alpha_mask.h"
#include "sim/scene/scene.h"

namespace rigwire::sim {

/// Flushes denormal floats to zero on this thread while it lives, as Embree asks of every thread
/// that traces, and restores the thread's setting afterwards.
class FlushDenormals {
 public:
  FlushDenormals() : saved_(_mm_getcsr()) {
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
  }
  ~FlushDenormals() { _mm_setcsr(saved_); }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  unsigned saved_;
};

/// Owners of Embree's reference-counted objects.
struct ReleaseDevice {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct ReleaseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
struct ReleaseGeometry {
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
/// Twins share it, and what is fixed.
using DeviceHandle = std::shared_ptr<RTCDeviceTy>;
using SceneHandle = std::unique_ptr<RTCSceneTy, ReleaseScene>;
using GeometryHandle = std::unique_ptr<RTCGeometryTy, ReleaseGeometry>;

/// Embree's first error message, on whichever thread.
struct RayCasterError {
  std::mutex mutex;
  std::string text;
};

/// `p` in Embree's coordinates; `time` as share of the slice.
inline RTCRay make_ray(const Eigen::Vector3d& p, const Eigen::Vector3d& direction, double near_m,
                       double far_m, float time, std::uint32_t mask) {
  RTCRay ray{};
  ray.org_x = static_cast<float>(p.x());
  ray.org_y = static_cast<float>(p.y());
  ray.org_z = static_cast<float>(p.z());
  ray.tnear = static_cast<float>(near_m);
  ray.dir_x = static_cast<float>(direction.x());
  ray.dir_y = static_cast<float>(direction.y());
  ray.dir_z = static_cast<float>(direction.z());
  ray.time = time;
  ray.tfar = static_cast<float>(far_m);
  ray.mask = mask;
  return ray;
}

/// Column-major 3x4, the form that Embree takes.
using Transform = std::array<float, 12>;

inline Transform to_transform(const Eigen::Isometry3d& X_WM, double scale,
                              const Eigen::Vector3d& origin_W) {
  const Eigen::Matrix3d linear = scale * X_WM.linear();
  const Eigen::Vector3d translation = X_WM.translation() - origin_W;
  Transform transform{};
  for (std::size_t column = 0; column < 3; ++column) {
    for (std::size_t row = 0; row < 3; ++row) {
      transform[column * 3 + row] = static_cast<float>(
          linear(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)));
    }
  }
  for (std::size_t row = 0; row < 3; ++row) {
    transform[9 + row] = static_cast<float>(translation(static_cast<Eigen::Index>(row)));
  }
  return transform;
}

inline void set_transform(RTCGeometry geometry, const Transform& transform) {
  rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, transform.data());
  rtcCommitGeometry(geometry);
}

/// Converts Embree's numbers of a hit to an index into Scene::Internals::shading and instance_of;
/// RTC_INVALID_GEOMETRY_ID: no hit. A model is one instance for Embree: its parts' indices are
/// consecutive.
inline std::uint32_t surface_number(std::uint32_t instance, std::uint32_t part) {
  return part == RTC_INVALID_GEOMETRY_ID ? RTC_INVALID_GEOMETRY_ID : instance + part;
}

/// Bits of ray masks of a surface; `body` may be Internals::kFixed.
[[nodiscard]] std::uint32_t surface_mask(const Material& material, std::uint32_t body);

/// A piece that has left its place: Embree has it among what moves (a canopy's: among canopies),
/// without a part in what is fixed.
struct DisplacedPiece {
  ScenePiece piece;
  std::shared_ptr<RTCSceneTy> shape;  ///< Twins share it.
  Eigen::Isometry3d X_WM_still = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
  double scale = 1.0;
  std::uint32_t mask = 0;
  std::uint32_t number = 0;  ///< Embree's number of its first part.
  std::uint32_t parts = 1;
};

/// A mesh with a colour of its own (painted_surface.h).
struct PaintedSurface;

struct Scene::Internals {
  static constexpr std::uint32_t kFixed = 0xFFFFFFFFU;
  /// Embree's numbers from 0 on are reserved for moving things: in every slice its commit iterates
  /// over all numbers up to the maximum in `moving`. More moving things than these only make it
  /// slower.
  static constexpr std::uint32_t kLowNumbers = 1024;

  /// What Embree knows as one instance: a mesh, or a model with all its parts.
  struct Placed {
    GeometryHandle geometry;
    Eigen::Isometry3d X_PM = Eigen::Isometry3d::Identity();  ///< In the world, or in its body.
    double scale = 1.0;
    std::uint32_t body = kFixed;
    std::uint32_t geometry_id = 0;  ///< Embree's number of it: its first part's in `shading`.
    std::string name;
    MeshId mesh = 0;
    std::uint32_t mask = 0;        ///< 0: rays do not hit it in `fixed` nor on a body.
    Eigen::AlignedBox3f bounds_M;  ///< Bounds of the mesh; empty for a canopy.
    bool gone = false;             ///< Displaced as a whole.
    bool reshaped = false;         ///< Its mesh is another one since it was placed.
  };
  struct Instance {
    std::uint32_t placed = 0;
    std::uint32_t material = 0;
    std::uint32_t painted = 0;  ///< 0: as its material's label; else its place in `painted` plus 1.
  };
  /// A mesh, or a model: then with its parts' surfaces.
  struct Mesh {
    SceneHandle scene;
    std::string name;
    std::vector<Material> materials;
    std::size_t triangles = 0;  ///< Number of triangles of a plain mesh.
    /// What was taken out: first triangle and number, as the mesh was; in order.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> taken_out{};
    std::vector<std::uint32_t> painted{};       ///< Instance::painted of each part; empty: none.
    std::vector<std::size_t> part_triangles{};  ///< Number of triangles of each part of a model.
  };
  /// A masked mesh, for Embree's filter: where the corners of each triangle lie in the mask.
  struct MaskedSurface {
    std::shared_ptr<const AlphaMask> mask;
    /// u and v of the first corner, and on the way to the second and to the third.
    std::vector<std::array<float, 6>> triangles;
  };
  /// A square part of a changing terrain, so that a dug hole changes little: an instance of its own
  /// for Embree, part of the terrain's instance elsewhere. It consists of triangles: Embree
  /// intersects them in three quarters of the time of a grid, coherent packets with the same ranges
  /// and normals to the bit, for 300 bytes a cell more.
  struct Tile {
    std::size_t first_column = 0;
    std::size_t first_row = 0;
    std::size_t columns = 0;  ///< Nodes; neighbours share those of one cell.
    std::size_t rows = 0;
    std::uint32_t number = 0;   ///< Embree's number of it.
    float* vertices = nullptr;  ///< Row by row, x y z each.
    GeometryHandle ground;
    SceneHandle inner;
    GeometryHandle placed;
    bool reshaped = false;  ///< Its vertices have changed since the last commit to Embree.
  };
  /// What lies on a terrain's cells, row by row.
  struct Cover {
    Cover(std::vector<std::string> of_labels, std::vector<std::uint8_t> of_cells,
          std::vector<std::uint8_t> edges)
        : labels(std::move(of_labels)), cells(std::move(of_cells)), near_edge(std::move(edges)) {}

    std::vector<std::string> labels;
    std::vector<std::uint8_t> cells;
    /// 1 where another label lies within kCoverReach cells.
    std::vector<std::uint8_t> near_edge;
    /// Reflectance of each label; 0: the terrain's own. Empty: the terrain's own for all.
    std::vector<float> reflectances;
    Eigen::Vector2d origin_m =
        Eigen::Vector2d::Zero();  ///< World place of the first cell's corner.
    double cell_m = 1.0;
    int columns = 0;  ///< Columns of cells.
    int rows = 0;
  };
  static constexpr int kCoverReach = 2;
  struct Terrain {
    std::uint32_t instance = 0;
    std::shared_ptr<const Cover> cover;  ///< Null: the material everywhere. Twins share it.
    HeightField field;                   ///< Shape and staged heights.
    std::uint64_t updates = 0;           ///< Number of updates of its heights.
    Eigen::Vector3d centre_W;            ///< Origin of the vertices.
    std::size_t tile_cells = 0;
    std::vector<Tile> tiles;  ///< Empty: cannot change.
    std::optional<NodeRectangle> staged;
    std::optional<SimTime> shown;  ///< Time of the last change that rays see.
  };
  /// What a hit needs to know of the instance, side by side in memory.
  struct Shading {
    Eigen::Matrix3f R_WM = Eigen::Matrix3f::Identity();  ///< Turns normals into the world.
    float reflectance = 0.0F;
    float retro_gain = 0.0F;
    float variation = 0.0F;  ///< reflectance_grain.h
    /// For terrain whose cells have reflectances of their own, else null.
    const Cover* cover = nullptr;
  };

  /// Lives as long as the scene: a weak_ptr to it identifies this scene.
  std::shared_ptr<const char> identity = std::make_shared<const char>('\0');
  std::shared_ptr<RayCasterError> error;  ///< Written by Embree's error callback.
  DeviceHandle device;
  /// What changes from slice to slice: bodies, and terrain that is dug.
  SceneHandle moving;
  /// Everything else that rays hit. Twins cast into the same scene; if it is placed anew while one
  /// does, a new scene is created.
  std::shared_ptr<RTCSceneTy> fixed;
  SceneHandle canopy;  ///< Surfaces that only radio signals hit.
  std::vector<std::shared_ptr<MaskedSurface>> masked;
  std::vector<std::shared_ptr<const PaintedSurface>> painted;
  std::vector<Mesh> meshes;
  std::vector<Placed> placed;
  std::vector<std::uint32_t> on_bodies;  ///< Indices in `placed` of what bodies carry.
  std::vector<Instance> instances;
  std::vector<Material> materials;
  std::vector<Shading> shading;            ///< By surface_number().
  std::vector<std::uint32_t> instance_of;  ///< Instance, by surface_number().
  std::uint32_t low_numbers_used = 0;
  std::vector<Terrain> terrains;
  Duration terrain_period{0};
  std::vector<std::string> bodies;
  std::vector<bool> loose;               ///< Whether each body is loose.
  std::vector<BodyMotion> body_motions;  ///< In the present slice.
  /// Null: everything is in its place. Never changed, only replaced: placements hold it.
  std::shared_ptr<const std::vector<DisplacedPiece>> displaced;
  std::vector<GeometryHandle> displaced_geometry;  ///< Geometries that Embree has for them.
  std::shared_ptr<const std::vector<DisplacedPiece>> displaced_shown;
  Eigen::Vector3d displaced_origin_W = Eigen::Vector3d::Zero();
  bool canopies_kept = true;                           ///< False for a twin.
  Eigen::Vector3d origin_W = Eigen::Vector3d::Zero();  ///< Origin of Embree's float coordinates.
  bool fixed_placed = false;
  bool ground_moves = false;  ///< Tiles of terrain are in `moving`.
  bool has_foliage = false;
  bool varies = false;  ///< Some surface has a variation, or a cover with reflectances.
  bool has_canopy = false;
  SimTime t0{};
  SimTime t1{};

  /// Throws std::runtime_error with Embree's message when it has reported an error since.
  void check(const char* doing);
  /// Triangles as Embree takes them, committed, with the filter for their holes.
  GeometryHandle make_geometry(const TriangleMesh& mesh);
  /// Makes an instance of the mesh, with the mask of `thing`, and attaches it to `scene` by its
  /// number.
  GeometryHandle place_instance(RTCScene scene, const Placed& thing, const Mesh& mesh) const;
  /// Surfaces: one for each part, or none.
  MeshId add_meshes(std::string name, std::span<const TriangleMesh* const> parts,
                    std::vector<Material> surfaces);
  /// The first hit on anything, moving or fixed; read by surface_number(). What the first scene
  /// stops is short in the second one; ground in tiles comes last, which is measured to be quicker.
  void intersect(const int* valid, RTCIntersectContext& context, RTCRayHit8& packet) const {
    rtcIntersect8(valid, ground_moves ? fixed.get() : moving.get(), &context, &packet);
    rtcIntersect8(valid, ground_moves ? moving.get() : fixed.get(), &context, &packet);
  }
  void intersect(RTCIntersectContext& context, RTCRayHit& ray) const {
    rtcIntersect1(moving.get(), &context, &ray);
    rtcIntersect1(fixed.get(), &context, &ray);
  }

  /// An instance with a part for each of the materials, in `fixed` or on a body.
  InstanceId add_instance(MeshId mesh, std::uint32_t body, const Eigen::Isometry3d& X_PM,
                          double scale, std::span<const Material> surfaces, std::string_view name,
                          bool terrain = false);
  std::uint32_t material_index(const Material& material);
  const Placed& placed_of(std::uint32_t instance) const {
    return placed[instances[instance].placed];
  }
  /// The next of Embree's numbers, for a part of this instance in `fixed` or in `moving`.
  std::uint32_t new_fixed_id(std::uint32_t instance, const Shading& surface);
  std::uint32_t new_moving_id(std::uint32_t instance, const Shading& surface);
  /// `number`: Embree's, in `moving`.
  Tile make_tile(const Terrain& terrain, std::size_t first_column, std::size_t first_row,
                 std::uint32_t number);
  Terrain& terrain_of(std::uint32_t instance);
  /// Takes staged heights into the tiles' vertices when they are due at `begin` of a slice.
  void refresh_terrains(SimTime begin);
  /// Commits to Embree the tiles whose vertices have changed.
  void commit_tiles();
  /// Places what is fixed when it is not, or when `focus_W` is far from the origin of the rays.
  void follow(const Eigen::Vector3d& focus_W);
  /// Places what is fixed at the present origin: in `fixed` itself if nothing else holds it, in a
  /// new scene if a placement() of it is held, which then stays as its holder has it.
  ///
  /// `fixed.use_count()` decides, which shared_ptr does not order by itself. It is right here: only
  /// the thread that calls this function takes placements of `fixed`. Another thread can copy only
  /// what it holds, so that a count of 1 stays 1, and a count that is just falling costs a scene
  /// that was not needed. The casts of the other thread before its release are complete by then:
  /// dropping the pointer releases, and the fence behind the count acquires.
  void place_fixed();
  /// Places the tiles of changeable terrains at the present origin.
  void place_tiles();
  /// The piece's shape of its own, when it is taken out of its object.
  DisplacedPiece take_out(const ScenePiece& piece);
  /// These triangles of a plain mesh, or all others, as a mesh of their own in Embree.
  std::shared_ptr<RTCSceneTy> cut(const Mesh& mesh, std::uint32_t first, std::uint32_t count,
                                  bool others) const;
  /// Returns the first of `parts` consecutive numbers for parts that will move.
  std::uint32_t new_moving_ids(std::uint32_t instance, std::uint32_t parts);
  /// Updates the displaced pieces' poses in Embree if they have changed.
  void place_displaced();
  /// Beginning and placing of what moves, when the rest is placed.
  void place_moving(SimTime begin, SimTime end, std::span<const BodyMotion> motions);
  void check_slice(SimTime begin, SimTime end, std::span<const BodyMotion> motions) const;
  void place_bodies(std::span<const BodyMotion> motions);

  /// Share of the slice that has passed at `time`, 0 .. 1.
  [[nodiscard]] float slice_fraction(SimTime time) const {
    const double fraction = to_seconds(time - t0) / to_seconds(t1 - t0);
    return static_cast<float>(fraction < 0.0 ? 0.0 : (fraction > 1.0 ? 1.0 : fraction));
  }
};

}  // namespace rigwire::sim
