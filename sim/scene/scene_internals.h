// What the casters of sim/ share with the scene: Embree's handles. Not for other folders.
#pragma once

#include <embree3/rtcore.h>
#include <pmmintrin.h>
#include <xmmintrin.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

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
using DeviceHandle = std::unique_ptr<RTCDeviceTy, ReleaseDevice>;
using SceneHandle = std::unique_ptr<RTCSceneTy, ReleaseScene>;
using GeometryHandle = std::unique_ptr<RTCGeometryTy, ReleaseGeometry>;

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

struct Scene::Internals {
  static constexpr std::uint32_t kFixed = 0xFFFFFFFFU;

  struct Instance {
    GeometryHandle geometry;
    Eigen::Isometry3d X_PM = Eigen::Isometry3d::Identity();  ///< In the world, or in its body.
    double scale = 1.0;
    std::uint32_t body = kFixed;
    Material material;
    std::uint32_t geometry_id = 0;  ///< Embree's number of it, its place in `shading`.
  };
  /// A square part of a terrain that changes, so that a dug hole rebuilds little: an instance of
  /// its own for Embree, the terrain's for everybody else.
  struct Tile {
    std::size_t first_column = 0;
    std::size_t first_row = 0;
    std::size_t columns = 0;  ///< Nodes; neighbours share those of one cell.
    std::size_t rows = 0;
    float* vertices = nullptr;  ///< Of the grid, x y z each.
    GeometryHandle grid;
    SceneHandle inner;
    GeometryHandle placed;
  };
  struct Terrain {
    std::uint32_t instance = 0;
    HeightField field;         ///< Shape and staged heights.
    Eigen::Vector3d centre_W;  ///< Origin of the vertices.
    std::size_t tile_cells = 0;
    std::vector<Tile> tiles;  ///< Empty: cannot change.
    std::optional<NodeRectangle> staged;
    std::optional<SimTime> shown;  ///< When it changed last for the rays.
  };
  /// What a hit needs to know of the instance, side by side in memory.
  struct Shading {
    Eigen::Matrix3f R_WM = Eigen::Matrix3f::Identity();  ///< Turns normals into the world.
    float reflectance = 0.0F;
    float retro_gain = 0.0F;
  };

  std::string first_error;  ///< Written by Embree's error callback.
  DeviceHandle device;
  SceneHandle top;
  std::vector<SceneHandle> meshes;
  std::vector<Instance> instances;
  std::vector<Shading> shading;            ///< By Embree's number.
  std::vector<std::uint32_t> instance_of;  ///< By Embree's number.
  std::vector<Terrain> terrains;
  Duration terrain_period{0};
  std::vector<std::string> bodies;
  Eigen::Vector3d origin_W = Eigen::Vector3d::Zero();  ///< Of Embree's float coordinates.
  bool fixed_placed = false;
  bool has_foliage = false;
  SimTime t0{};
  SimTime t1{};

  /// Throws std::runtime_error with Embree's message when it has reported an error since.
  void check(const char* doing);
  InstanceId add_instance(RTCScene inner, std::uint32_t body, const Eigen::Isometry3d& X_PM,
                          double scale, const Material& material);
  /// The next of Embree's numbers, for a part of this instance.
  std::uint32_t new_geometry_id(std::uint32_t instance, const Shading& surface);
  Tile make_tile(const Terrain& terrain, std::size_t first_column, std::size_t first_row);
  Terrain& terrain_of(std::uint32_t instance);
  /// Shows staged heights to the rays when they are due.
  void refresh_terrains();
  void place_fixed();
  void place_bodies(std::span<const BodyMotion> motions);

  /// Share of the slice that has passed at `time`, 0 .. 1.
  [[nodiscard]] float slice_fraction(SimTime time) const {
    const double fraction = to_seconds(time - t0) / to_seconds(t1 - t0);
    return static_cast<float>(fraction < 0.0 ? 0.0 : (fraction > 1.0 ? 1.0 : fraction));
  }
};

}  // namespace rigwire::sim
