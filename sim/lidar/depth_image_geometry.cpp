#include "sim/lidar/depth_image_geometry.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "fields/constants.h"

namespace rigwire::sim {
namespace {

constexpr double kSteepest_rad = 80.0 * kTurn / 360.0;
/// Rows beyond the outermost look-ups, for what is read between pixels.
constexpr double kRowMargin_px = 2.0;
/// The nearest range at which beams beside the origin are still inside the image.
constexpr double kNearestParallax_m = 0.5;

/// Equal steps from the lowest laser's row to the highest's, in order of elevation.
void space_equally(std::array<double, kMaxLasers>& rows_px, std::size_t count) {
  std::array<std::size_t, kMaxLasers> order{};
  for (std::size_t i = 0; i < count; ++i) {
    order[i] = i;
  }
  std::sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count),
            [&](std::size_t a, std::size_t b) { return rows_px[a] < rows_px[b]; });
  const double lowest = rows_px[order[0]];
  const double highest = rows_px[order[count - 1]];
  const double pixels_per_beam =
      count > 1 ? (highest - lowest) / static_cast<double>(count - 1) : 0.0;
  for (std::size_t rank = 0; rank < count; ++rank) {
    rows_px[order[rank]] = lowest + static_cast<double>(rank) * pixels_per_beam;
  }
}

}  // namespace

DepthImageGeometry::DepthImageGeometry(const DepthImageParameters& parameters,
                                       const LidarPattern& pattern) {
  validate(parameters);
  const std::size_t count = pattern.lasers.size();
  if (count == 0 || count > kMaxLasers) {
    throw std::invalid_argument("depth images: the pattern has " + std::to_string(count) +
                                " lasers, allowed: 1 to " + std::to_string(kMaxLasers));
  }
  cameras_ = static_cast<std::size_t>(parameters.cameras);
  width_px_ = static_cast<std::size_t>(parameters.width_px);
  sector_rad_ = kTurn / parameters.cameras;
  field_of_view_rad_ = field_of_view_rad(parameters);
  // f = (W / 2) / tan(field of view / 2).
  focal_px_ = 0.5 * parameters.width_px / std::tan(0.5 * field_of_view_rad_);
  sector_edge_px_ = focal_px_ * std::tan(0.5 * sector_rad_);
  for (std::size_t camera = 0; camera < cameras_; ++camera) {
    const double cosine = std::cos(camera_azimuth_rad(camera));
    const double sine = std::sin(camera_azimuth_rad(camera));
    axes_.push_back({.forward_S = {cosine, -sine, 0.0},
                     .right_S = {-sine, -cosine, 0.0},
                     .up_S = Eigen::Vector3d::UnitZ()});
  }
  row_rule_ = parameters.rows;
  column_rule_ = parameters.columns;
  for (std::size_t i = 0; i < count; ++i) {
    const LaserGeometry& laser = pattern.lasers[i];
    if (!(std::abs(laser.elevation_rad) <= kSteepest_rad)) {
      throw std::invalid_argument("depth images: laser " + std::to_string(i) + " has elevation " +
                                  std::to_string(laser.elevation_rad) +
                                  " rad, allowed: within 80 degrees of the horizontal");
    }
    axis_row_px_[i] = focal_px_ * std::tan(laser.elevation_rad);
  }
  if (parameters.elevations == ElevationRule::pixels_per_beam) {
    space_equally(axis_row_px_, count);
  }
  double lowest_px = 0.0;
  double highest_px = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const LaserGeometry& laser = pattern.lasers[i];
    // Row's shift of a beam that leaves above the origin, at the nearest range looked up.
    const double parallax_px =
        parameters.parallax_steps > 0
            ? focal_px_ * std::abs(laser.vertical_offset_m) /
                  (std::max(pattern.minimum_range_m, kNearestParallax_m) *
                   std::cos(laser.elevation_rad) * std::cos(0.5 * sector_rad_))
            : 0.0;
    for (const double azimuth_rad : {0.0, 0.5 * sector_rad_}) {
      const double v_px = beam(i, azimuth_rad).v_px;
      lowest_px = i == 0 ? v_px - parallax_px : std::min(lowest_px, v_px - parallax_px);
      highest_px = i == 0 ? v_px + parallax_px : std::max(highest_px, v_px + parallax_px);
    }
  }
  if (parameters.height_px == 0) {
    top_px_ = std::ceil(highest_px + kRowMargin_px);
    height_px_ = static_cast<std::size_t>(top_px_ - std::floor(lowest_px - kRowMargin_px));
  } else {
    height_px_ = static_cast<std::size_t>(parameters.height_px);
    top_px_ = std::round(0.5 * (lowest_px + highest_px + parameters.height_px));
  }
}

double DepthImageGeometry::camera_azimuth_rad(std::size_t camera) const {
  return sector_rad_ * static_cast<double>(camera);
}

std::size_t DepthImageGeometry::camera_at(double azimuth_rad) const {
  const double turns = azimuth_rad / kTurn;
  const double sector =
      std::floor((turns - std::floor(turns)) * static_cast<double>(cameras_) + 0.5);
  return static_cast<std::size_t>(sector) % cameras_;
}

double DepthImageGeometry::column_px(double off_axis_rad) const {
  if (column_rule_ == ColumnRule::uniform) {
    return static_cast<double>(width_px_) * off_axis_rad / field_of_view_rad_;
  }
  return focal_px_ * std::tan(off_axis_rad);
}

ImagePoint DepthImageGeometry::beam(std::size_t laser, double azimuth_rad) const {
  ImagePoint at;
  at.camera = camera_at(azimuth_rad);
  at.u_px = column_px(std::remainder(azimuth_rad - camera_azimuth_rad(at.camera), kTurn));
  const double a_px = axis_row_px_[laser];
  if (row_rule_ == RowRule::straight) {
    at.v_px = a_px;
  } else {
    // Eq. 4 of Wolf et al. 2020: v = a sqrt(1 + (u / b)^2), exact for b = f.
    const double b_px =
        row_rule_ == RowRule::hyperbola_focal ? focal_px_ : 0.5 * static_cast<double>(width_px_);
    const double x = at.u_px / b_px;
    at.v_px = a_px * std::sqrt(1.0 + x * x);
  }
  return at;
}

ImagePoint DepthImageGeometry::project(const Eigen::Vector3d& p_S) const {
  return project(p_S, camera_at(std::atan2(-p_S.y(), p_S.x())));
}

ImagePoint DepthImageGeometry::project(const Eigen::Vector3d& p_S, std::size_t likely) const {
  const auto seen_by = [&](std::size_t camera) {
    // Pinhole: u = f right . p / forward . p, v = f up . p / forward . p.
    const double scale = focal_px_ / axes(camera).forward_S.dot(p_S);
    return ImagePoint{camera, scale * axes(camera).right_S.dot(p_S), scale * p_S.z()};
  };
  const ImagePoint at = seen_by(likely);
  if (axes(likely).forward_S.dot(p_S) > 0.0 && std::abs(at.u_px) <= sector_edge_px_) {
    return at;
  }
  return seen_by(camera_at(std::atan2(-p_S.y(), p_S.x())));
}

Eigen::Vector3d DepthImageGeometry::direction_S(const ImagePoint& at) const {
  const CameraAxes& camera = axes(at.camera);
  return camera.forward_S + (at.u_px / focal_px_) * camera.right_S +
         (at.v_px / focal_px_) * camera.up_S;
}

}  // namespace rigwire::sim
