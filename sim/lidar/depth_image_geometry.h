// Where lasers are in the images of virtual cameras around the spin axis: Eq. 4 of Wolf et al. 2020
// and what it approximates.
//
// Camera k of n looks level along azimuth 2 pi k / n from the origin of the sensor frame S. Its
// image is a pinhole's with square pixels, focal length f: the direction
//   forward + (u / f) right + (v / f) up
// is at (u, v), pixels right of and above the optical axis. The planar depth z of a point is its
// part along `forward`. A beam of elevation w, azimuth p off the optical axis, is at
//   u = f tan p,  v = f tan w / cos p = f tan w sqrt(1 + (u / f)^2).
// So Eq. 4 with b = W / 2 is exact for a field of view of 90 degrees only; at the edges of 120
// degrees it errs by 7.9 degrees for the lowest beam of an HDL-32E, straight rows by 14.2.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "sim/lidar/depth_image_parameters.h"
#include "sim/samples/lidar_sample.h"

namespace rigwire::sim {

/// A place in one of the images, in pixels from the optical axis.
struct ImagePoint {
  std::size_t camera = 0;
  double u_px = 0.0;  ///< To the right.
  double v_px = 0.0;  ///< Up.
};

/// Unit vectors of a camera in the sensor frame.
struct CameraAxes {
  Eigen::Vector3d forward_S;
  Eigen::Vector3d right_S;
  Eigen::Vector3d up_S;
};

class DepthImageGeometry {
 public:
  /// Validates the parameters. Throws std::invalid_argument for them, and for a pattern without
  /// lasers, with more than kMaxLasers, or with one beyond 80 degrees of elevation.
  DepthImageGeometry(const DepthImageParameters& parameters, const LidarPattern& pattern);

  [[nodiscard]] std::size_t cameras() const { return cameras_; }
  [[nodiscard]] std::size_t width_px() const { return width_px_; }
  [[nodiscard]] std::size_t height_px() const { return height_px_; }
  [[nodiscard]] double focal_px() const { return focal_px_; }
  /// v of the image's upper edge; pixel (column c, row r) has its centre at
  /// (c + 0.5 - width / 2, top - r - 0.5).
  [[nodiscard]] double top_px() const { return top_px_; }
  [[nodiscard]] double sector_rad() const { return sector_rad_; }

  [[nodiscard]] double camera_azimuth_rad(std::size_t camera) const;
  [[nodiscard]] const CameraAxes& axes(std::size_t camera) const { return axes_[camera]; }
  /// The camera in whose sector an azimuth is.
  [[nodiscard]] std::size_t camera_at(double azimuth_rad) const;
  /// The column of an azimuth off the optical axis, within a quarter turn.
  [[nodiscard]] double column_px(double off_axis_rad) const;

  /// Where the pipeline looks for a laser that points along `azimuth_rad`.
  [[nodiscard]] ImagePoint beam(std::size_t laser, double azimuth_rad) const;
  /// Where a point really is, in the image of the camera in whose sector it lies.
  [[nodiscard]] ImagePoint project(const Eigen::Vector3d& p_S) const;
  /// Returns project(p_S), quicker if the point lies in the sector of `likely`.
  [[nodiscard]] ImagePoint project(const Eigen::Vector3d& p_S, std::size_t likely) const;
  /// The direction that is seen at (u, v), not of unit length: of planar depth 1.
  [[nodiscard]] Eigen::Vector3d direction_S(const ImagePoint& at) const;

 private:
  std::size_t cameras_;
  std::size_t width_px_;
  std::size_t height_px_ = 0;
  double sector_rad_;
  double field_of_view_rad_;
  double focal_px_;
  double top_px_ = 0.0;
  double sector_edge_px_;  ///< Maximum |u| within a sector.
  std::vector<CameraAxes> axes_;
  RowRule row_rule_;
  ColumnRule column_rule_;
  std::array<double, kMaxLasers> axis_row_px_{};  ///< v of each laser on the optical axis.
};

}  // namespace rigwire::sim
