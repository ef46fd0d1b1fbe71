// The image of one virtual camera: depth, surface and normal of each pixel. Rendered by rays
// through the pixel centres, which is what a graphics processor's depth buffer holds without
// multisampling.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/lidar/depth_image_geometry.h"
#include "sim/lidar/depth_image_parameters.h"
#include "sim/scene/scene.h"

namespace rigwire::sim {

/// Columns [first, last).
struct ColumnRange {
  std::size_t first = 0;
  std::size_t last = 0;
};

/// What one rendering has in common for all pixels.
struct DepthImageView {
  Eigen::Isometry3d X_WS = Eigen::Isometry3d::Identity();  ///< Pose of the sensor.
  float time = 0.0F;                                       ///< Share of the scene's slice.
  std::uint32_t mask = Scene::kSeeEverything;
};

class DepthImage {
 public:
  /// No pixel: where the camera sees nothing.
  static constexpr std::uint32_t kNothing = ~0U;

  /// `far_m` is the far plane, in planar depth; what is farther is not seen.
  DepthImage(const DepthImageGeometry& geometry, std::size_t camera,
             const DepthImageParameters& parameters, double far_m);

  /// Renders one row; rows are independent of each other. Returns the pixels rendered.
  std::size_t render_row(const Scene& scene, const DepthImageView& view, std::size_t row,
                         ColumnRange columns);

  [[nodiscard]] std::size_t width_px() const { return width_px_; }
  [[nodiscard]] std::size_t height_px() const { return height_px_; }
  [[nodiscard]] std::size_t index(std::size_t column, std::size_t row) const {
    return row * width_px_ + column;
  }
  /// 1/z of the planar depth as the depth buffer keeps it, 1/m; 0: nothing.
  [[nodiscard]] float inverse_depth(std::size_t pixel) const { return inverse_depth_[pixel]; }
  /// Number of the surface in Scene::Internals::shading, or kNothing.
  [[nodiscard]] std::uint32_t surface(std::size_t pixel) const { return surface_[pixel]; }
  /// Unit, in the sensor frame that the image was rendered from.
  [[nodiscard]] Eigen::Vector3f normal_S(std::size_t pixel) const {
    return {normal_S_[0][pixel], normal_S_[1][pixel], normal_S_[2][pixel]};
  }
  [[nodiscard]] double far_m() const { return far_m_; }

  /// Sets one pixel.
  void set(std::size_t pixel, float inverse_depth, std::uint32_t surface,
           const Eigen::Vector3f& normal_S);

 private:
  /// What the depth buffer makes of a planar depth.
  [[nodiscard]] float stored(float depth_m) const;

  std::size_t width_px_;
  std::size_t height_px_;
  CameraAxes axes_;
  double focal_px_;
  double top_px_;
  double near_m_;
  double far_m_;
  DepthFormat format_;
  std::vector<float> inverse_depth_;
  std::vector<std::uint32_t> surface_;
  std::array<std::vector<float>, 3> normal_S_;
};

}  // namespace rigwire::sim
