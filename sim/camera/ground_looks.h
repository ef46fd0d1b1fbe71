// How terrain looks, and how its surface leans: by the soil of a cell, in ragged edges where soils
// meet, and bare where it is steeper than its soil holds. Normals come from central differences at
// the terrain's nodes, blended in between.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "sim/camera/shading_lanes.h"
#include "sim/lidar/ray_lanes.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {

class GroundLooks {
 public:
  /// Of the scene's terrain as it is staged. Slopes are kept where its heights are those of the
  /// last call.
  void prepare(const Scene::Internals& scene, const Scene::Internals::Terrain& terrain);

  /// What the points that hit it look like, and its normals there, on the side that the flat ones
  /// are on. `mine`: -1 in the lanes that are of this terrain; others stay as they are.
  void find(const std::array<int, kLanes>& mine, const RTCRay8& rays, const LaneArray& pixel_rad,
            const PreparedLook* looks, MetSurfaces& met, LookLanes& look) const;

  /// Of the terrain's own material, of bare slopes, and of each label of its cover.
  std::uint16_t own = 0;
  std::uint16_t face = 0;
  std::vector<std::uint16_t> of_label;

 private:
  struct Slopes {
    float x = 0.0F, y = 0.0F;
  };
  /// A place among the nodes, in cells.
  [[nodiscard]] std::size_t cell(float x, float y) const;
  [[nodiscard]] std::size_t cell_beyond_edges(float x, float y, float footprint_m,
                                              const PreparedLook* looks) const;

  void find_slopes(const HeightField& field);

  const Scene::Internals::Cover* cover_ = nullptr;      ///< Null: the material everywhere.
  Eigen::Vector2f offset_m_ = Eigen::Vector2f::Zero();  ///< Of Embree's origin from the first node.
  float per_m_ = 1.0F;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<Slopes> nodes_;
  std::weak_ptr<const char> scene_;  ///< That the slopes are of,
  std::uint32_t instance_ = 0;       ///< the terrain in it,
  std::uint64_t updates_ = 0;        ///< and as it was after so many.
};

}  // namespace rigwire::sim
