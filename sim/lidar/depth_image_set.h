// The images of all cameras around the spin axis, rendered together, and the hits of beams in them.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/lidar/depth_image.h"
#include "sim/lidar/depth_image_geometry.h"
#include "sim/lidar/depth_image_parameters.h"
#include "sim/lidar/worker_pool.h"
#include "sim/samples/lidar_sample.h"
#include "sim/scene/scene.h"

namespace rigwire::sim {

/// Where the middle of a beam starts and points, in the sensor frame.
struct BeamLine {
  Eigen::Vector3d start_S = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction_S = Eigen::Vector3d::UnitX();  ///< Unit.
};

/// Returns the beam of a laser that points along an azimuth (sim/samples/lidar_sample.h).
[[nodiscard]] BeamLine beam_line(const LaserGeometry& laser, double azimuth_rad);

/// A beam's hit.
struct SeenSurface {
  double range_m = 0.0;  ///< From the beam's start; 0: nothing.
  float reflectance = 0.0F;
  float retro_gain = 0.0F;
  float cosine = 0.0F;  ///< Cosine of the angle of incidence.
};

class DepthImageSet {
 public:
  /// Throws as DepthImageGeometry does.
  DepthImageSet(const DepthImageParameters& parameters, const LidarPattern& pattern, double far_m,
                int threads);

  /// Renders what beams with azimuths within [start, start + width] may need, on all the threads.
  /// Returns the pixels rendered.
  std::uint64_t render(const Scene& scene, const DepthImageView& view, double start_rad,
                       double width_rad);

  /// Returns the hit of the beam of a laser at this azimuth. May be called from many threads.
  [[nodiscard]] SeenSurface see(const Scene& scene, std::size_t laser, double azimuth_rad) const;

  /// Sets the sampling from now on; the images serve any.
  void set_sampling(DepthSampling sampling) { sampling_ = sampling; }

  /// Pose of the sensor when the images were rendered.
  [[nodiscard]] const Eigen::Isometry3d& X_WS() const { return X_WS_; }
  [[nodiscard]] const DepthImageGeometry& geometry() const { return geometry_; }
  [[nodiscard]] const DepthImage& image(std::size_t camera) const { return images_[camera]; }
  [[nodiscard]] WorkerPool& workers() { return workers_; }

 private:
  [[nodiscard]] ColumnRange columns(std::size_t camera, double start_rad, double width_rad) const;

  std::vector<LaserGeometry> lasers_;
  DepthSampling sampling_;
  int parallax_steps_;
  DepthImageGeometry geometry_;
  std::vector<DepthImage> images_;
  WorkerPool workers_;
  Eigen::Isometry3d X_WS_ = Eigen::Isometry3d::Identity();
};

}  // namespace rigwire::sim
