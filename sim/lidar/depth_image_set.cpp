#include "sim/lidar/depth_image_set.h"

#include <algorithm>
#include <cmath>

#include "fields/constants.h"
#include "sim/lidar/depth_image_lookup.h"
#include "sim/lidar/hit_surface.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {
namespace {

/// Columns rendered beyond those that the beams point at.
constexpr double kColumnMargin_px = 4.0;

}  // namespace

BeamLine beam_line(const LaserGeometry& laser, double azimuth_rad) {
  const double cosine = std::cos(azimuth_rad);
  const double sine = std::sin(azimuth_rad);
  const double horizontal = std::cos(laser.elevation_rad);
  return {.start_S = {-laser.horizontal_offset_m * sine, -laser.horizontal_offset_m * cosine,
                      laser.vertical_offset_m},
          .direction_S = {horizontal * cosine, -horizontal * sine, std::sin(laser.elevation_rad)}};
}

DepthImageSet::DepthImageSet(const DepthImageParameters& parameters, const LidarPattern& pattern,
                             double far_m, int threads)
    : lasers_(pattern.lasers),
      sampling_(parameters.sampling),
      parallax_steps_(parameters.parallax_steps),
      geometry_(parameters, pattern),
      workers_(threads) {
  for (std::size_t camera = 0; camera < geometry_.cameras(); ++camera) {
    images_.emplace_back(geometry_, camera, parameters, far_m);
  }
}

ColumnRange DepthImageSet::columns(std::size_t camera, double start_rad, double width_rad) const {
  const double half = 0.5 * geometry_.sector_rad();
  if (width_rad >= kTurn - 2.0 * half) {
    return {0, geometry_.width_px()};
  }
  const double middle =
      std::remainder(start_rad + 0.5 * width_rad - geometry_.camera_azimuth_rad(camera), kTurn);
  const double first = std::max(middle - 0.5 * width_rad, -half);
  const double last = std::min(middle + 0.5 * width_rad, half);
  if (first > last) {
    return {};
  }
  const auto width = static_cast<double>(geometry_.width_px());
  const auto edge = [&](double column_px) {
    return static_cast<std::size_t>(std::clamp(column_px + 0.5 * width, 0.0, width));
  };
  return {edge(std::floor(geometry_.column_px(first) - kColumnMargin_px)),
          edge(std::ceil(geometry_.column_px(last) + kColumnMargin_px))};
}

std::uint64_t DepthImageSet::render(const Scene& scene, const DepthImageView& view,
                                    double start_rad, double width_rad) {
  X_WS_ = view.X_WS;
  std::uint64_t pixels = 0;
  for (std::size_t camera = 0; camera < images_.size(); ++camera) {
    const ColumnRange range = columns(camera, start_rad, width_rad);
    if (range.first >= range.last) {
      continue;
    }
    DepthImage& image = images_[camera];
    workers_.run(image.height_px(),
                 [&](std::size_t row) { image.render_row(scene, view, row, range); });
    pixels += image.height_px() * (range.last - range.first);
  }
  return pixels;
}

SeenSurface DepthImageSet::see(const Scene& scene, std::size_t laser, double azimuth_rad) const {
  ImagePoint at = geometry_.beam(laser, azimuth_rad);
  DepthLookup found = look_up(images_[at.camera], geometry_, at, sampling_);
  if (found.inverse_depth <= 0.0) {
    return {};
  }
  const double u = at.u_px / geometry_.focal_px();
  const double v = at.v_px / geometry_.focal_px();
  // Planar depth z to range: z |forward + (u / f) right + (v / f) up|.
  double range_m = std::sqrt(1.0 + u * u + v * v) / found.inverse_depth;
  const BeamLine beam = beam_line(lasers_[laser], azimuth_rad);
  // The surface is not where the beam passes the camera's line of sight, but near it.
  for (int step = 0; step < parallax_steps_; ++step) {
    at = geometry_.project(beam.start_S + range_m * beam.direction_S, at.camera);
    found = look_up(images_[at.camera], geometry_, at, sampling_);
    if (found.inverse_depth <= 0.0) {
      return {};
    }
    const Eigen::Vector3d seen_S = geometry_.direction_S(at) / found.inverse_depth;
    range_m = beam.direction_S.dot(seen_S - beam.start_S);
  }
  const DepthImage& image = images_[at.camera];
  const std::uint32_t surface = image.surface(found.pixel);
  if (surface == DepthImage::kNothing || range_m <= 0.0) {
    return {};
  }
  const float cosine = std::abs(image.normal_S(found.pixel).dot(beam.direction_S.cast<float>()));
  const Scene::Internals::Shading& shading = scene.internals().shading[surface];
  float reflectance = shading.reflectance;
  if (scene.internals().varies) {
    const Eigen::Vector3d& origin_W = scene.internals().origin_W;
    const Eigen::Vector3d met_W = X_WS_ * (beam.start_S + range_m * beam.direction_S);
    reflectance = varied_reflectance(scene.internals(), GrainLattice(origin_W), surface,
                                     (met_W - origin_W).cast<float>());
  }
  return {range_m, reflectance, shading.retro_gain, cosine};
}

}  // namespace rigwire::sim
