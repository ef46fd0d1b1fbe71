// How much of the sky a point near the ground sees past the fixed parts of a scene: terrain, rocks,
// buildings, trees.
//
// It is a lattice over the terrain with three heights; at each node rays towards the sky, spread by
// the cosine of the zenith angle and turned differently from node to node, are cast at the fixed
// parts, leaves with their gaps. In between it is interpolated. Moving things and dug ground do not
// count: the camera's sky_rays (camera_parameters.h) sample the sky at every pixel instead.
// Standard error of a node: 0.5 / sqrt(kRays), 12 %, smoothed by neighbours; a ditch narrower than
// a cell is not seen, nor anything beyond 80 m. Built once: about 0.1 s for 120 m of pit, 1.5 s for
// a forest of single leaves; memory 150 kB at most.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/lidar/lane_array.h"
#include "sim/scene/scene.h"

namespace rigwire::sim {

class SkyVisibility {
 public:
  static constexpr int kRays = 16;
  static constexpr int kHeights = 3;

  SkyVisibility() = default;  ///< All of it, everywhere.
  /// Casts into the scene, which must be ready (Scene::begin_slice). A scene without terrain: all
  /// of the sky everywhere.
  explicit SkyVisibility(const Scene& scene);

  /// Share of the sky's light on level ground that comes through, 0 .. 1. Beyond the terrain's edge
  /// that of the nearest point.
  [[nodiscard]] float at(float x_m, float y_m, float z_m) const;
  /// Writes the share at eight points; `offset_m` is added to their coordinates.
  void at(const LaneArray& x_m, const LaneArray& y_m, const LaneArray& z_m,
          const Eigen::Vector3f& offset_m, LaneArray& share) const;
  [[nodiscard]] bool everywhere() const { return nodes_.empty(); }

 private:
  struct Node {
    float ground_m;
    float share[kHeights];
  };
  [[nodiscard]] const Node& node(int column, int row) const {
    return nodes_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(column)];
  }

  Eigen::Vector2d origin_m_ = Eigen::Vector2d::Zero();
  float per_m_ = 1.0F;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<Node> nodes_;

 public:
  /// Position of the lattice's first node: at() counts x and y from it, heights from the world's 0.
  [[nodiscard]] const Eigen::Vector2d& origin_m() const { return origin_m_; }
};

}  // namespace rigwire::sim
