// Depth images against rays: what each way of mapping and reading them costs, and how far its
// ranges are off, on the very same shots.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/lidar_cases.h"
#include "sim/lidar/depth_image_parameters.h"

namespace rigwire::bench {

/// One way of mapping, to be measured at one size.
struct DepthImageVariant {
  std::string name;
  sim::DepthImageParameters parameters;
  std::vector<sim::DepthSampling> samplings;
};

/// The mappings of the paper and the exact one at this width, with the samplings worth reading.
[[nodiscard]] std::vector<DepthImageVariant> depth_image_variants(int width_px);

/// Shots whose true range is below `to_m` and not below that of the class before.
struct RangeClassError {
  double to_m = 0.0;
  std::size_t shots = 0;
  double rms_m = 0.0;
  double p99_m = 0.0;   ///< 99 % of the absolute errors are below this,
  double p999_m = 0.0;  ///< and 99.9 %.
};

inline constexpr std::array kRangeClasses_m{10.0, 20.0, 30.0, 50.0, 80.0};

struct DepthImageError {
  std::string scene;
  std::string variant;
  sim::DepthImageParameters parameters;
  std::uint64_t pixels = 0;
  double render_s = 0.0;      ///< CPU time for the images of one revolution.
  double look_up_s = 0.0;     ///< CPU time of its shots.
  double rays_s = 0.0;        ///< CPU time of SpinningLidar::cast for the same shots.
  std::size_t shots = 0;      ///< Shots that have a range by both methods.
  std::size_t one_sided = 0;  ///< Shots that have a range by one method only.
  /// Shots in mid-air: more than 0.3 m off, and from every surface within a pixel and a half around
  /// the beam.
  std::size_t ghosts = 0;
  std::array<RangeClassError, kRangeClasses_m.size()> classes;
};

/// Returns one entry per sampling of the variant. The sensor is at rest; noise is off.
[[nodiscard]] std::vector<DepthImageError> measure_depth_images(const LidarCase& scene,
                                                                const DepthImageVariant& variant);

/// What motion costs: the sensor drives at 5 m/s and turns at 60 deg/s, truth is at each shot's own
/// instant.
struct DepthImageMotionError {
  int images_per_revolution = 0;
  std::uint64_t pixels = 0;
  double cast_s = 0.0;  ///< CPU time of one revolution.
  double rms_m = 0.0;
  double p99_m = 0.0;
};
[[nodiscard]] DepthImageMotionError measure_depth_image_motion(const LidarCase& scene,
                                                               int images_per_revolution);

/// Points of one laser on level ground, after figure 5 of Wolf et al. 2020: where what the pixels
/// show really is.
struct DepthImageRing {
  double elevation_deg = 0.0;
  std::vector<double> azimuth_deg;
  std::vector<double> radius_m;
};
[[nodiscard]] std::vector<DepthImageRing> depth_image_rings(
    const sim::DepthImageParameters& parameters);

}  // namespace rigwire::bench
