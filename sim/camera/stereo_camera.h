// A stereo camera: two heads side by side, their pictures rectified and matched.
//
// Mount frame S is the left head's; the right head is at (0, -baseline, 0) in it and is turned by
// `misalignment`. The heads differ only in noise, fixed pattern and dirt. Each picture is rectified
// to the pinhole camera that stereo_geometry() reports (no distortion, the left lens's own focal
// length and principal point) by interpolating its numbers between pixels, as such devices do, then
// matched (stereo_matcher.h) by the upper eight bits. A head without distortion or misalignment is
// rectified already, and its picture stays as it is, bit by bit.
//
// `misalignment` is what the calibration does not know: heads that have moved in their housing
// since. 0.1 degree of pitch at a focal length of 533 pixels puts the rows 0.9 pixels apart.
//
// Parts: the left picture, the right one, disparity in sixteenths of a pixel, confidence. The whole
// sensor is exposed and matched whatever the region, which is cut out at the end.
//
// Defaults after Roboception rc_visard 160 (1280 x 960 pixels of 3.75 um, 4 mm, 160 mm apart, its
// depth quality High: 640 x 480, 128 disparities, factor 0.0625 with 0 for none), read out as
// pixels of twice the size. The sensor's noise is that of image_sensor.h.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "sim/camera/camera_sensor.h"
#include "sim/camera/reported_geometry.h"
#include "sim/camera/stereo_matcher.h"

namespace rigwire::sim {

struct StereoCameraParameters {
  static constexpr fields::Named kNamed{"stereo", "Two images, disparity and its confidence."};

  CameraParameters camera = heads();  ///< Both heads; the lens must be brown_conrady.
  double baseline_m = 0.16;           ///< Between the heads.
  /// Rotation of the right head about its roll, pitch and yaw axes, unknown to the calibration.
  Eigen::Vector3d misalignment_rad = Eigen::Vector3d::Zero();
  StereoMatchingParameters matching;

 private:
  [[nodiscard]] static CameraParameters heads();
};
void visit(fields::Visitor& v, StereoCameraParameters& p);
/// Throws std::invalid_argument naming the key, the value found and what is allowed.
void validate(const StereoCameraParameters& parameters);

[[nodiscard]] ReportedGeometry stereo_geometry(const StereoCameraParameters& parameters);

/// Throws std::invalid_argument as validate() and CameraRenderer do.
[[nodiscard]] std::unique_ptr<CameraSensor> make_stereo_camera(
    const StereoCameraParameters& parameters, std::uint64_t seed, std::string_view name);

}  // namespace rigwire::sim
