// What cameras of several kinds cost, and how far from the truth their pictures are: matching
// against the true disparity, all round by views against rays, ranges against their own figures.
#pragma once

#include <string>
#include <vector>

#include "bench/camera_bench.h"
#include "sim/camera/all_round_camera.h"
#include "sim/camera/depth_camera.h"
#include "sim/camera/stereo_camera.h"

namespace rigwire::bench {

/// Matching result in a band of true depths.
struct DepthBand {
  double from_m = 0.0;
  double to_m = 0.0;
  double density = 0.0;         ///< Share of its pixels with a disparity.
  double bad1 = 0.0;            ///< Share of those with an error of more than a pixel.
  double median_px = 0.0;       ///< Median error of the disparity.
  double median_m = 0.0;        ///< Median error of the depth.
  double median_depth_m = 0.0;  ///< Median of the true depths.
};

/// Value of the confidence: disparities with a confidence of at least half, and how often a right
/// one has a higher confidence than a wrong one.
struct ConfidenceWorth {
  double density = 0.0;
  double bad1 = 0.0;
  double median_px = 0.0;
  double told_apart = 0.0;  ///< Area under the ROC curve: 0.5 by chance, 1 always.
};

struct StereoCost {
  std::string scene;
  std::string matcher;
  double disparity_s = 0.0;   ///< CPU time of matching alone; one thread.
  double confidence_s = 0.0;  ///< CPU time that the confidence adds; one thread.
  double take_s = 0.0;  ///< CPU time of a whole shot, two pictures, matched; not a number: no shot.
  DepthBand all;
  ConfidenceWorth sure;
  std::vector<DepthBand> bands;
};

/// Measures the default stereo camera with `matching`; `name` names the matcher in the result.
/// Depths nearer than the search are left out.
[[nodiscard]] StereoCost measure_stereo(const CameraCase& scene, const std::string& name,
                                        const sim::StereoMatchingParameters& matching, int rounds);
/// Measures `matcher` alone, on what the heads of that camera see. It searches the disparities that
/// `searched` names.
[[nodiscard]] StereoCost measure_matcher(const CameraCase& scene, const std::string& name,
                                         sim::StereoMatcher& matcher,
                                         const sim::StereoMatchingParameters& searched, int rounds);

/// A method for an all-round picture compared with rays of many samples.
struct AllRoundCost {
  std::string scene;
  std::string way;
  int samples = 1;
  double picture_s = 0.0;  ///< CPU time; one thread.
  std::size_t rays = 0;    ///< Rays of the camera.
  double seen = 0.0;       ///< Share of the picture that is not black.
  /// Difference in the visible part, in grey levels of 255 with the mean at 100; includes the
  /// sensor's noise.
  double rms_levels = 0.0;
  double bias_levels = 0.0;
};

[[nodiscard]] std::vector<AllRoundCost> measure_all_round(const CameraCase& scene,
                                                          int reference_samples, int rounds);

/// Standard deviation of ranges to a wall, as the parameters say and as frames show it.
struct RangeNoise {
  std::string surface;
  double distance_m = 0.0;
  double set_m = 0.0;
  double found_m = 0.0;  ///< Not a number: no range.
  double valid = 0.0;    ///< Share of the pixels.
};

[[nodiscard]] std::vector<RangeNoise> measure_range_noise();
/// CPU time of a shot of the default depth camera, s; one thread.
[[nodiscard]] double measure_depth_shot(const CameraCase& scene, int rounds);

}  // namespace rigwire::bench
