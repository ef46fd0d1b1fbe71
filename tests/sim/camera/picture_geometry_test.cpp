// Where things are seen: edges, ranges, shutters.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "camera_site.h"
#include "sim/camera/camera_renderer.h"

namespace rigwire::sim {
namespace {

using namespace camera_test;

/// An upright wall whose left edge (towards +y) is the line x, y of all heights.
Scene::InstanceId add_wall(Scene& scene, double x, double y) {
  const auto mesh = scene.add_mesh(make_box("wall", {0.2, 20.0, 60.0}));
  return scene.add_object(mesh, at(x + 0.1, y - 10.0, 0.0), 1.0, surface("dark", 0.02));
}

/// Column where the upright line x, y is seen in a row, by the lens alone.
std::optional<double> column_of_line(const Lens& lens, const Eigen::Isometry3d& X_WS, double x,
                                     double y, double row) {
  double low = -25.0;
  double high = 25.0;
  std::optional<Eigen::Vector2d> pixel;
  for (int i = 0; i < 80; ++i) {
    const double z = 0.5 * (low + high);
    pixel = lens.project(mount_to_lens(X_WS.inverse() * Eigen::Vector3d(x, y, z)));
    if (!pixel) {
      return std::nullopt;
    }
    (pixel->y() > row ? low : high) = z;
  }
  return std::abs(pixel->y() - row) < 1e-6 ? std::optional(pixel->x()) : std::nullopt;
}

/// Every row's first pixel of the wall is the first one whose middle lies right of the edge.
void expect_edge_in_place(const CameraParameters& parameters, const Eigen::Isometry3d& X_WS) {
  Scene scene;
  const auto wall = add_wall(scene, 8.0, 1.3);
  ready(scene);
  const Daylight light({}, sun_at(50.0, 200.0));
  CameraRenderer camera(parameters, 1, "camera");
  RenderedPicture picture;
  camera.render(scene, job_for(parameters, X_WS, light), picture);
  int rows = 0;
  for (int row = 0; row < picture.height; ++row) {
    const auto edge = column_of_line(camera.lens(), X_WS, 8.0, 1.3, row);
    if (!edge || *edge < 1.0 || *edge > picture.width - 2.0 ||
        std::abs(*edge - std::round(*edge)) < 2e-3) {
      continue;
    }
    const int first = static_cast<int>(std::ceil(*edge));
    EXPECT_EQ(instance_at(picture, first, row), wall) << row << " edge at " << *edge;
    EXPECT_NE(instance_at(picture, first - 1, row), wall) << row << " edge at " << *edge;
    ++rows;
  }
  EXPECT_GT(rows, 60);
}

TEST(PictureGeometry, EdgesLieWhereTheLensPutsThem) {
  const Eigen::Isometry3d X_WS = at(0.3, 0.1, 1.0, 0.05, 0.12, 0.2);
  expect_edge_in_place(small_camera(), X_WS);
  CameraParameters barrel = small_camera();
  barrel.lens.k1 = -0.2;
  barrel.lens.k2 = 0.05;
  barrel.lens.p1 = 0.002;
  barrel.lens.principal_offset_px = {3.3, -2.1};
  expect_edge_in_place(barrel, X_WS);
  CameraParameters fisheye = small_camera(55.0);
  fisheye.lens.model = LensModel::kannala_brandt;
  fisheye.lens.k1 = -0.01;
  expect_edge_in_place(fisheye, X_WS);
}

TEST(PictureGeometry, SamplesCoverTheirPixels) {
  // The share of sky in the pixels of a slanted edge, against the dark wall.
  Scene scene;
  add_wall(scene, 8.0, 1.3);
  ready(scene);
  const Daylight light({.cloud_cover = 1.0}, sun_at(50.0, 100.0));  // an even sky
  CameraParameters parameters = small_camera();
  parameters.samples = 256;
  CameraRenderer camera(parameters, 1, "camera");
  const Eigen::Isometry3d X_WS = at(0.0, 0.0, 1.0, 0.0, -0.1, 0.15);
  RenderedPicture picture;
  camera.render(scene, job_for(parameters, X_WS, light), picture);
  int pixels = 0;
  for (int row = 5; row < 55; ++row) {
    const auto edge = column_of_line(camera.lens(), X_WS, 8.0, 1.3, row);
    ASSERT_TRUE(edge);
    const int column = static_cast<int>(std::floor(*edge + 0.5));
    const double sky = luminance_at(picture, column - 3, row);
    const double wall = luminance_at(picture, column + 3, row);
    // Two pixels beside it, too: the edge is slanted.
    double covered = 0.0;
    for (int c = column - 2; c <= column + 2; ++c) {
      covered += (luminance_at(picture, c, row) - wall) / (sky - wall);
    }
    EXPECT_NEAR(covered, *edge + 0.5 - (column - 2), 0.05) << row;
    ++pixels;
  }
  EXPECT_EQ(pixels, 50);
}

/// Rms over the pixels beside a slanted edge, of what they have of the sky against their area in it
/// after the lens.
double edge_error(const CameraParameters& parameters) {
  Scene scene;
  add_wall(scene, 8.0, 1.3);
  ready(scene);
  const Daylight light({.cloud_cover = 1.0}, sun_at(50.0, 100.0));
  const Eigen::Isometry3d X_WS = at(0.0, 0.0, 1.0, 0.0, -0.1, 0.15);
  CameraParameters exact = small_camera();
  exact.samples = 256;
  RenderedPicture truth;
  CameraRenderer(exact, 1, "exact").render(scene, job_for(exact, X_WS, light), truth);
  CameraRenderer camera(parameters, 1, "camera");
  RenderedPicture picture;
  camera.render(scene, job_for(parameters, X_WS, light), picture);
  double squares = 0.0;
  int pixels = 0;
  for (int row = 5; row < 55; ++row) {
    const auto edge = column_of_line(camera.lens(), X_WS, 8.0, 1.3, row);
    const int column = static_cast<int>(std::floor(*edge + 0.5));
    const double contrast =
        luminance_at(truth, column - 4, row) - luminance_at(truth, column + 4, row);
    for (int c = column - 2; c <= column + 2; ++c, ++pixels) {
      squares +=
          std::pow((luminance_at(picture, c, row) - luminance_at(truth, c, row)) / contrast, 2);
    }
  }
  return std::sqrt(squares / pixels);
}

TEST(PictureGeometry, OneRayPerPixelAndFourAtEdgesAverageThePixelsArea) {
  CameraParameters sharp = small_camera();
  sharp.lens.mtf = 1.0;
  sharp.edge_ratio = 0.0;
  CameraParameters blurred = small_camera();
  blurred.edge_ratio = 0.0;
  const double without = edge_error(sharp);
  const double with_blur = edge_error(blurred);
  const double with_parts = edge_error(small_camera());
  EXPECT_GT(without, 0.14);
  EXPECT_LT(with_blur, 0.6 * without);
  EXPECT_LT(with_parts, 0.035);
}

TEST(PictureGeometry, EdgeRatioIsRefusedWhereItHasNoEffect) {
  CameraParameters parameters = small_camera();
  for (const double ratio : {0.5, 1.0, -1.0, std::nan("")}) {
    parameters.edge_ratio = ratio;
    EXPECT_THROW(validate(parameters), std::invalid_argument) << ratio;
  }
  parameters.edge_ratio = 0.0;
  EXPECT_NO_THROW(validate(parameters));
}

TEST(PictureGeometry, RangesOnLevelGroundAreThoseOfThePlane) {
  for (const Eigen::Vector3d& place :
       {Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(1e6, -3e5, 400.0)}) {
    Scene scene;
    const auto ground = scene.add_terrain(level_ground(place), surface("ground"));
    ready(scene, place);
    const Daylight light({}, sun_at(50.0, 200.0));
    const CameraParameters parameters = small_camera();
    CameraRenderer camera(parameters, 1, "camera");
    Eigen::Isometry3d X_WS = at(0.4, 0.2, 2.5, 0.7, 0.5);
    X_WS.translation() += place;
    RenderedPicture picture;
    camera.render(scene, job_for(parameters, X_WS, light), picture);
    int seen = 0;
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 0; x < picture.width; ++x) {
        const auto direction = camera.lens().direction(Eigen::Vector2d(x, y));
        ASSERT_TRUE(direction);
        const Eigen::Vector3d d = X_WS.linear() * lens_to_mount(*direction);
        const double range = -2.5 / d.z();
        if (d.z() < -0.05) {
          const std::size_t at = static_cast<std::size_t>(y * picture.width + x);
          ASSERT_EQ(picture.instance[at], ground);
          ASSERT_NEAR(static_cast<double>(picture.range_m[at]), range, 2e-4 + 2e-5 * range);
          ASSERT_NEAR(static_cast<double>(picture.depth_m[at]), range * direction->z(),
                      2e-4 + 2e-5 * range);
          ++seen;
        } else if (d.z() > 0.0) {
          ASSERT_EQ(instance_at(picture, x, y), ~0U);
        }
      }
    }
    EXPECT_GT(seen, 8000);
    for (const float l : picture.luminance) {
      ASSERT_TRUE(std::isfinite(l));
      ASSERT_GE(l, 0.0F);
    }
  }
}

TEST(PictureGeometry, RollingShutterSkewsByFocalLengthTimesRateTimesRowTime) {
  Scene scene;
  const auto wall = add_wall(scene, 8.0, 0.4);
  ready(scene);
  const Daylight light({}, sun_at(50.0, 200.0));
  CameraParameters parameters = small_camera(300.0);
  parameters.lens.vignetting = 0.0;
  parameters.sensor.row_time = 100us;
  CameraRenderer camera(parameters, 1, "camera");
  const double rate_radps = 1.5;
  PictureJob job = job_for(parameters, at(0.0, 0.0, 0.0), light);
  job.poses = poses(at(0.0, 0.0, 0.0), kStart, kStart + 100ms, {0.0, 0.0, rate_radps});
  job.exposure_start = kStart + 44ms;  // its middle row is taken near the middle of the turn
  RenderedPicture picture;
  camera.render(scene, job, picture);
  // A line through the edge's columns, by least squares.
  double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (int row = 0; row < picture.height; ++row) {
    int column = 0;
    while (column < picture.width && instance_at(picture, column, row) != wall) {
      ++column;
    }
    ASSERT_GT(column, 0);
    ASSERT_LT(column, picture.width);
    n += 1.0;
    sx += row;
    sy += column;
    sxx += static_cast<double>(row) * row;
    sxy += static_cast<double>(row) * column;
  }
  const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
  // Turning left moves the picture right.
  EXPECT_NEAR(slope, 300.0 * rate_radps * 100e-6, 0.02 * 300.0 * rate_radps * 100e-6);
}

TEST(PictureGeometry, MotionBlurIsAsWideAsTheWayOfTheExposure) {
  Scene scene;
  add_wall(scene, 8.0, 0.0);
  ready(scene);
  const Daylight light({.cloud_cover = 1.0}, sun_at(50.0, 100.0));
  CameraParameters parameters = small_camera(300.0);
  parameters.samples = 64;
  CameraRenderer camera(parameters, 1, "camera");
  const double rate_radps = 2.0;
  PictureJob job = job_for(parameters, at(0.0, 0.0, 5.0), light);
  job.poses = poses(at(0.0, 0.0, 5.0), kStart, kStart + 100ms, {0.0, 0.0, rate_radps});
  job.read_out.exposure = 30ms;
  job.exposure_start = kStart + 35ms;
  job.truth = false;
  RenderedPicture picture;
  camera.render(scene, job, picture);
  const double sky = mean_luminance(picture, 20, 20, 40, 30);
  const double wall = mean_luminance(picture, 120, 20, 140, 30);
  double ramp = 0.0;
  double centre = 0.0;
  for (int x = 0; x + 1 < picture.width; ++x) {
    const double here = (mean_luminance(picture, x, 20, x + 1, 30) - wall) / (sky - wall);
    ramp += here * (1.0 - here);
    centre += here;
  }
  // A ramp of width w has the integral w / 6 of s (1 - s), and its middle on the edge.
  const double width = 300.0 * rate_radps * 0.030;
  EXPECT_NEAR(6.0 * ramp, width, 0.1 * width);
  EXPECT_NEAR(centre, 80.0, 0.6);
  // One sample sees the middle of the exposure, sharp.
  CameraParameters sharp = parameters;
  sharp.samples = 1;
  CameraRenderer one(sharp, 1, "camera");
  one.render(scene, job, picture);
  EXPECT_GT(luminance_at(picture, 77, 20), 0.5 * sky);
  EXPECT_LT(luminance_at(picture, 82, 20), 0.5 * (sky + wall));
}

TEST(PictureGeometry, BodiesAreSeenWhereTheyAreAtThePixelsInstant) {
  // A body that crosses the picture during the read-out of its rows.
  Scene scene;
  const auto body = scene.add_body("arm");
  const auto mesh = scene.add_mesh(make_box("arm", {0.1, 20.0, 60.0}));
  const auto arm = scene.add_body_part(body, mesh, at(0.0, -10.0, 0.0), surface("machine"));
  const double speed_mps = 10.0;
  const std::vector<BodyMotion> motions{{at(8.0, 0.5, 0.0), at(8.0, 0.5 - speed_mps * 0.1, 0.0)}};
  scene.begin_slice(kStart, kStart + 100ms, Eigen::Vector3d::Zero(), motions);
  const Daylight light({}, sun_at(50.0, 200.0));
  CameraParameters parameters = small_camera(300.0);
  parameters.sensor.row_time = 500us;
  CameraRenderer camera(parameters, 1, "camera");
  RenderedPicture picture;
  camera.render(scene, job_for(parameters, at(0.0, 0.0, 0.0), light), picture);
  for (const int row : {0, 60, 119}) {
    int column = 0;
    while (column < picture.width && instance_at(picture, column, row) != arm) {
      ++column;
    }
    const double t_s = 10e-3 + 0.5e-3 + row * 500e-6;
    const double y_m = 0.5 - speed_mps * t_s;
    EXPECT_NEAR(column, 79.5 - 300.0 * y_m / 7.95, 1.01) << row;
  }
}

TEST(PictureGeometry, BlackBeyondTheImageCircle) {
  Scene scene;
  scene.add_terrain(level_ground(), surface("ground"));
  ready(scene);
  const Daylight light({}, sun_at(50.0, 200.0));
  CameraParameters parameters = small_camera(30.0);
  parameters.lens.model = LensModel::kannala_brandt;
  parameters.lens.image_circle_rad = 95.0 * kDegree;
  parameters.lens.vignetting = 0.3;
  CameraRenderer camera(parameters, 1, "camera");
  RenderedPicture picture;
  camera.render(scene, job_for(parameters, at(0.0, 0.0, 2.0), light), picture);
  EXPECT_EQ(luminance_at(picture, 0, 0), 0.0);
  EXPECT_EQ(instance_at(picture, 0, 0), ~0U);
  EXPECT_GT(luminance_at(picture, 80, 20), 100.0);
  EXPECT_GT(luminance_at(picture, 80, 100), 100.0);
}

}  // namespace
}  // namespace rigwire::sim
