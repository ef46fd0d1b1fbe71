// Level ground, a camera above it, and daylight, for tests of pictures.
#pragma once

#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include "fields/constants.h"
#include "sim/camera/camera_renderer.h"

namespace rigwire::sim::camera_test {

using namespace std::chrono_literals;

inline Eigen::Vector3d sun_at(double elevation_deg, double azimuth_deg) {
  const double e = elevation_deg * kDegree;
  const double a = azimuth_deg * kDegree;
  return {std::cos(e) * std::sin(a), std::cos(e) * std::cos(a), std::sin(e)};
}

inline Material surface(const char* label, double reflectance = 0.3) {
  Material material;
  material.reflectance = reflectance;
  material.label = label;
  return material;
}

inline HeightField level_ground(const Eigen::Vector3d& centre_W = Eigen::Vector3d::Zero(),
                                double half_m = 100.0) {
  HeightField field;
  field.cell_m = 2.0;
  field.columns = field.rows = static_cast<std::size_t>(half_m) + 1;
  field.origin_m = centre_W.head<2>().array() - half_m;
  field.heights_m.assign(field.columns * field.rows, centre_W.z());
  return field;
}

inline Eigen::Isometry3d at(double x, double y, double z, double yaw_rad = 0.0,
                            double pitch_rad = 0.0, double roll_rad = 0.0) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() << x, y, z;
  X.linear() = (Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()) *
                Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY()) *
                Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitX()))
                   .toRotationMatrix();
  return X;
}

/// 160 x 120 pixels, 90 degrees across unless the focal length is changed; every number of 12 bits.
inline CameraParameters small_camera(double focal_px = 80.0) {
  CameraParameters p;
  p.sensor.width_px = 160;
  p.sensor.height_px = 120;
  p.lens.focal_length_m = focal_px * p.sensor.pixel_pitch_m;
  return p;
}

/// A camera that stands or turns at constant rates.
inline std::vector<CameraPose> poses(const Eigen::Isometry3d& X_WS, SimTime from, SimTime to,
                                     const Eigen::Vector3d& w_W = Eigen::Vector3d::Zero(),
                                     const Eigen::Vector3d& v_W = Eigen::Vector3d::Zero()) {
  std::vector<CameraPose> result;
  const SimTime middle = from + (to - from) / 2;
  for (int i = 0; i <= 8; ++i) {
    const SimTime time = from + (to - from) * i / 8;
    const double dt = to_seconds(time - middle);
    CameraPose pose;
    pose.time = time;
    pose.mount.X_WL = X_WS;
    const double angle = w_W.norm() * dt;
    if (angle != 0.0) {
      pose.mount.X_WL.linear() =
          Eigen::AngleAxisd(angle, w_W.normalized()).toRotationMatrix() * X_WS.linear();
    }
    pose.mount.X_WL.translation() += v_W * dt;
    pose.mount.v_WL_W = v_W;
    pose.mount.w_WL_W = w_W;
    result.push_back(pose);
  }
  return result;
}

/// A job for the whole sensor, in the slice from 0 to 100 ms.
inline PictureJob job_for(const CameraParameters& p, const Eigen::Isometry3d& X_WS,
                          const Daylight& light) {
  PictureJob job;
  job.read_out.region = {0, 0, p.sensor.width_px, p.sensor.height_px};
  job.read_out.exposure = 1ms;
  job.read_out.bits = 12;
  job.exposure_start = kStart + 10ms;
  job.poses = poses(X_WS, kStart, kStart + 100ms);
  job.light = &light;
  job.truth = true;
  return job;
}

inline void ready(Scene& scene, const Eigen::Vector3d& focus_W = Eigen::Vector3d::Zero()) {
  scene.begin_slice(kStart, kStart + 100ms, focus_W, {});
}

/// Mean of a band over a rectangle of pixels, cd/m2.
inline double mean_luminance(const RenderedPicture& picture, int x0, int y0, int x1, int y1,
                             std::size_t band = 1) {
  double sum = 0.0;
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      sum +=
          static_cast<double>(picture.luminance[3 * (static_cast<std::size_t>(y) *
                                                         static_cast<std::size_t>(picture.width) +
                                                     static_cast<std::size_t>(x)) +
                                                band]);
    }
  }
  return sum / ((x1 - x0) * (y1 - y0));
}

inline double luminance_at(const RenderedPicture& picture, int x, int y, std::size_t band = 1) {
  return mean_luminance(picture, x, y, x + 1, y + 1, band);
}

inline std::uint32_t instance_at(const RenderedPicture& picture, int x, int y) {
  return picture.instance[static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                          static_cast<std::size_t>(x)];
}

}  // namespace rigwire::sim::camera_test
