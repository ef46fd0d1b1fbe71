#include "sim/lidar/depth_image_geometry.h"
#include "fields/constants.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "depth_image_head.h"

namespace rigwire::sim {
namespace {

/// Elevation of what is seen where the pipeline looks for a laser.
double elevation_rad(const DepthImageGeometry& geometry, std::size_t laser, double azimuth_rad) {
  const Eigen::Vector3d d = geometry.direction_S(geometry.beam(laser, azimuth_rad));
  return std::atan2(d.z(), d.head<2>().norm());
}

/// Greatest error of elevation of any laser out to the edge of a field of view, degrees.
double worst_elevation_deg(double field_of_view_deg, RowRule rows) {
  DepthImageParameters parameters;
  parameters.cameras = 6;
  parameters.field_of_view_deg = field_of_view_deg;
  parameters.rows = rows;
  parameters.parallax_steps = 0;
  const LidarPattern head = ideal_head();
  double worst = 0.0;
  // Sectors are narrower than the wider views, so the rule is evaluated from the columns.
  const DepthImageGeometry geometry(parameters, head);
  const double edge_px = 0.5 * static_cast<double>(geometry.width_px());
  const double b_px = rows == RowRule::hyperbola_half_width ? edge_px : geometry.focal_px();
  for (const LaserGeometry& laser : head.lasers) {
    const double a_px = geometry.focal_px() * std::tan(laser.elevation_rad);
    for (int i = 0; i <= 100; ++i) {
      const double u_px = edge_px * i / 100.0;
      const double v_px = rows == RowRule::straight ? a_px : a_px * std::hypot(1.0, u_px / b_px);
      const Eigen::Vector3d d = geometry.direction_S({0, u_px, v_px});
      const double found = std::atan2(d.z(), d.head<2>().norm());
      worst = std::max(worst, std::abs(found - laser.elevation_rad) / kDegree);
    }
  }
  return worst;
}

TEST(DepthImageGeometry, TheHyperbolaAsPrintedIsExactForNinetyDegreesOnly) {
  EXPECT_NEAR(worst_elevation_deg(60.0, RowRule::hyperbola_half_width), 5.3, 0.05);
  EXPECT_NEAR(worst_elevation_deg(90.0, RowRule::hyperbola_half_width), 0.0, 1e-9);
  EXPECT_NEAR(worst_elevation_deg(120.0, RowRule::hyperbola_half_width), 7.92, 0.01);
  EXPECT_NEAR(worst_elevation_deg(150.0, RowRule::hyperbola_half_width), 18.4, 0.05);
  EXPECT_NEAR(worst_elevation_deg(60.0, RowRule::straight), 3.5, 0.05);
  EXPECT_NEAR(worst_elevation_deg(90.0, RowRule::straight), 7.9, 0.05);
  EXPECT_NEAR(worst_elevation_deg(120.0, RowRule::straight), 14.2, 0.05);
  EXPECT_NEAR(worst_elevation_deg(150.0, RowRule::straight), 21.9, 0.05);
  for (const double view_deg : {60.0, 90.0, 120.0, 150.0}) {
    EXPECT_NEAR(worst_elevation_deg(view_deg, RowRule::hyperbola_focal), 0.0, 1e-9);
  }
}

TEST(DepthImageGeometry, ExactRulesLookWhereTheBeamPoints) {
  const LidarPattern head = ideal_head();
  for (const int cameras : {3, 4, 7}) {
    DepthImageParameters parameters;
    parameters.cameras = cameras;
    const DepthImageGeometry geometry(parameters, head);
    for (int i = -10; i < 400; ++i) {
      const double azimuth = i * kTurn / 360.0 + 1e-3;
      for (std::size_t j = 0; j < head.lasers.size(); ++j) {
        const double w = head.lasers[j].elevation_rad;
        const Eigen::Vector3d beam(std::cos(w) * std::cos(azimuth),
                                   -std::cos(w) * std::sin(azimuth), std::sin(w));
        const ImagePoint at = geometry.beam(j, azimuth);
        EXPECT_NEAR((geometry.direction_S(at).normalized() - beam).norm(), 0.0, 1e-12);
        const ImagePoint projected = geometry.project(7.0 * beam);
        EXPECT_EQ(projected.camera, at.camera);
        EXPECT_NEAR(projected.u_px, at.u_px, 1e-8);
        EXPECT_NEAR(projected.v_px, at.v_px, 1e-8);
        EXPECT_LE(std::abs(at.u_px), 0.5 * static_cast<double>(geometry.width_px()) + 1e-9);
        EXPECT_LT(at.v_px, geometry.top_px());
        EXPECT_GT(at.v_px, geometry.top_px() - static_cast<double>(geometry.height_px()));
      }
    }
  }
}

TEST(DepthImageGeometry, UniformColumnsAndPixelsPerBeamMissTheBeam) {
  const LidarPattern head = ideal_head();
  DepthImageParameters parameters;
  parameters.parallax_steps = 0;
  parameters.columns = ColumnRule::uniform;
  const DepthImageGeometry uniform(parameters, head);
  // 30 degrees off the axis of 120: half way in angle is half way in columns, tan 60 / 2 in truth.
  const Eigen::Vector3d d = uniform.direction_S(uniform.beam(0, kTurn / 12.0));
  EXPECT_NEAR(std::atan2(-d.y(), d.x()), std::atan(std::tan(kTurn / 6.0) / 2.0), 1e-12);

  parameters.columns = ColumnRule::resampled;
  parameters.elevations = ElevationRule::pixels_per_beam;
  const DepthImageGeometry spaced(parameters, head);
  EXPECT_NEAR(elevation_rad(spaced, 0, 0.0), head.lasers[0].elevation_rad, 1e-12);
  EXPECT_NEAR(elevation_rad(spaced, 31, 0.0), head.lasers[31].elevation_rad, 1e-12);
  const double low = std::tan(head.lasers[0].elevation_rad);
  const double high = std::tan(head.lasers[31].elevation_rad);
  EXPECT_NEAR(std::tan(elevation_rad(spaced, 10, 0.0)), low + 10.0 / 31.0 * (high - low), 1e-12);
}

TEST(DepthImageGeometry, RefusesWhatNoImageCanShow) {
  const LidarPattern head = ideal_head();
  const auto refused = [&](auto change) {
    DepthImageParameters parameters;
    change(parameters);
    EXPECT_THROW(DepthImageGeometry(parameters, head), std::invalid_argument);
  };
  refused([](DepthImageParameters& p) { p.cameras = 2; });
  refused([](DepthImageParameters& p) { p.field_of_view_deg = 171.0; });
  refused([](DepthImageParameters& p) { p.field_of_view_deg = 119.0; });
  refused([](DepthImageParameters& p) { p.width_px = 4; });
  refused([](DepthImageParameters& p) { p.images_per_revolution = 0; });
  refused([](DepthImageParameters& p) { p.near_plane_m = 0.0; });
  refused([](DepthImageParameters& p) { p.rows = RowRule::straight; });  // with parallax steps
  LidarPattern steep = head;
  steep.lasers[3].elevation_rad = 1.5;
  EXPECT_THROW(DepthImageGeometry({}, steep), std::invalid_argument);
  EXPECT_THROW(DepthImageGeometry({}, LidarPattern{}), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
