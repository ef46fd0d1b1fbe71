// Terrain materials and shading normals. The soil of a cell sets the material, with ragged edges
// between soils; slopes steeper than the soil holds are bare. Normals come from central differences
// at the terrain's nodes, blended in between.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "sim/camera/shading_lanes.h"
#include "sim/lidar/ray_lanes.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {

class GroundLooks {
 public:
  /// Prepares for the scene's terrain as it is staged. Computes slopes anew only if the terrain has
  /// changed since the last call.
  void prepare(const Scene::Internals& scene, const Scene::Internals::Terrain& terrain);

  /// What the points that hit it look like, and its normals there, on the side that the flat ones
  /// are on. `mine`: -1 in the lanes that are of this terrain; others stay as they are.
  void find(const std::array<int, kLanes>& mine, const RTCRay8& rays, const LaneArray& pixel_rad,
            const PreparedLook* looks, MetSurfaces& met, LookLanes& look) const;

  /// Looks of the next label of the terrain's cover; after prepare().
  void add_label(std::uint16_t look, const Shade& shade);

  /// Looks of the terrain's own material and of bare slopes.
  std::uint16_t own = 0;
  std::uint16_t face = 0;

 private:
  struct Slopes {
    float x = 0.0F, y = 0.0F;
  };
  /// Positions of points among the nodes, in cells, and which of them are near a boundary between
  /// soils: -1.
  struct Places {
    LaneArray x, y;
    alignas(32) std::array<int, kLanes> near_edge;
  };
  /// Numbers of the cover's labels.
  using LabelLanes = std::array<std::uint8_t, kLanes>;

  void cross_edges(const Places& at, const LaneArray& footprint_m, LabelLanes& label) const;
  void lay_bare(const Places& at, const LaneArray& footprint_m, const LaneArray& steep,
                const LaneArray& bare_from, std::array<int, kLanes>& bare) const;
  /// Whether a hard surface lies within kCoverReach of a place.
  [[nodiscard]] bool near_laid(float x, float y) const;
  void find_slopes(const HeightField& field);

  const Scene::Internals::Cover* cover_ = nullptr;      ///< Null: the material everywhere.
  Eigen::Vector2f offset_m_ = Eigen::Vector2f::Zero();  ///< From the first node to Embree's origin.
  float per_m_ = 1.0F;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::uint16_t> of_label_;  ///< Look of each label of the cover.
  std::vector<std::uint8_t> laid_;       ///< 1 for each label that is laid along lines, else 0.
  bool any_laid_ = false;                ///< Whether any label is laid along lines.
  std::vector<Slopes> nodes_;
  std::weak_ptr<const char> scene_;  ///< Scene of the slopes.
  std::uint32_t instance_ = 0;       ///< Its terrain.
  std::uint64_t updates_ = 0;        ///< Number of updates of the terrain at that time.
};

}  // namespace rigwire::sim
