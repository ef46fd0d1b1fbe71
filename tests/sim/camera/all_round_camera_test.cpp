#include "sim/camera/all_round_camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "shot_site.h"

namespace rigwire::sim {
namespace {

using namespace camera_test;

constexpr double kPi = std::numbers::pi;

/// The whole sphere, 2 degrees a pixel.
AllRoundCameraParameters sphere() {
  AllRoundCameraParameters p;
  p.width_px = 180;
  p.height_px = 90;
  p.elevation_upper_rad = 0.5 * kPi;
  return p;
}

/// 45 degrees up and down, joined from views.
AllRoundCameraParameters joined(int views) {
  AllRoundCameraParameters p;
  p.method = AllRoundMethod::views;
  p.views = views;
  p.width_px = 512;
  p.height_px = 128;
  p.camera.sensor.width_px = views == 3 ? 320 : 200;
  p.camera.sensor.height_px = views == 3 ? 372 : 320;
  return p;
}

/// In the mount frame, by the header's words.
Eigen::Vector3d direction_of(const AllRoundCameraParameters& p, int column, int row) {
  const double right = ((column + 0.5) / p.width_px - 0.5) * 2.0 * kPi;
  const double up = p.elevation_upper_rad - (row + 0.5) * 2.0 * kPi / p.width_px;
  return {std::cos(up) * std::cos(right), -std::cos(up) * std::sin(right), std::sin(up)};
}

CameraShot round_shot(const AllRoundCameraParameters& p, const Eigen::Isometry3d& X_WS,
                      const Daylight& light) {
  return shot_for(p.width_px, p.height_px, X_WS, light);
}

TEST(AllRoundCamera, EachPixelLooksInItsClosedFormDirection) {
  StonySite site;
  const Daylight light({}, sun_at(40.0, 200.0));
  const AllRoundCameraParameters parameters = sphere();
  const auto camera = make_all_round_camera(parameters, 1, "round");
  const Eigen::Isometry3d X_WS = at(1.0, 0.5, 1.7, 0.4, 0.1, 0.05);
  CameraTruth truth;
  (void)camera->take(site.scene, round_shot(parameters, X_WS, light), &truth);
  int met = 0;
  int wrong = 0;
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 180; ++x) {
      const Eigen::Vector3d direction = direction_of(parameters, x, y);
      const auto hit = site.scene.cast(X_WS.translation(), X_WS.linear() * direction, 0.05, 2000.0,
                                       kStart + 10ms + 500us);
      const double range_m = truth_at(truth.range_m, truth, x, y);
      // Rays that graze an edge may differ by their rounding.
      if (hit.has_value() != (range_m > 0.0) ||
          (hit && std::abs(hit->range_m - range_m) > 2e-3 * range_m)) {
        ++wrong;
        continue;
      }
      met += hit ? 1 : 0;
      if (hit) {
        ASSERT_NEAR(truth_at(truth.depth_m, truth, x, y), range_m * direction.x(), 1e-4 * range_m);
      }
    }
  }
  EXPECT_GT(met, 7000);
  EXPECT_LT(wrong, 8);
}

TEST(AllRoundCamera, PolesLookStraightUpAndDown) {
  Scene scene;
  scene.add_terrain(level_ground(), surface("ground"));
  ready(scene);
  const Daylight light({}, sun_at(40.0, 200.0));
  const AllRoundCameraParameters parameters = sphere();
  const auto camera = make_all_round_camera(parameters, 1, "round");
  CameraTruth truth;
  (void)camera->take(scene, round_shot(parameters, at(0.0, 0.0, 3.0), light), &truth);
  for (int x = 0; x < 180; ++x) {
    // The last row is 1 degree off the pole.
    EXPECT_NEAR(truth_at(truth.range_m, truth, x, 89), 3.0 / std::cos(1.0 * kDegree), 1e-4);
    EXPECT_EQ(truth_at(truth.range_m, truth, x, 0), 0.0);
  }
}

TEST(AllRoundCamera, BehindIsSeenWithoutASeam) {
  // A pole right behind shows half on the left edge of the picture, half on the right one.
  Scene scene;
  const auto pole = scene.add_mesh(make_box("pole", {0.2, 0.5, 20.0}));
  scene.add_object(pole, at(-5.0, 0.0, 0.0), 1.0, surface("pole"));
  ready(scene);
  const Daylight light({}, sun_at(40.0, 200.0));
  for (const AllRoundMethod method : {AllRoundMethod::rays, AllRoundMethod::views}) {
    AllRoundCameraParameters parameters = joined(3);
    parameters.method = method;
    const auto camera = make_all_round_camera(parameters, 1, "round");
    CameraTruth truth;
    (void)camera->take(scene, round_shot(parameters, at(0.0, 0.0, 0.0), light), &truth);
    int left = 0;
    int right = 0;
    int elsewhere = 0;
    for (int x = 0; x < 512; ++x) {
      const bool seen = truth_at(truth.range_m, truth, x, 64) > 0.0;
      (x < 10 ? left : x >= 502 ? right : elsewhere) += seen ? 1 : 0;
    }
    // Half of its width, 0.25 m at 4.9 m, in pixels of 360 / 512 degrees.
    const double half = std::atan(0.25 / 4.9) / (2.0 * kPi) * 512;
    EXPECT_NEAR(left, half, 1.0);
    EXPECT_NEAR(right, half, 1.0);
    EXPECT_EQ(elsewhere, 0);
  }
}

TEST(AllRoundCamera, ViewsShowWhatRaysShow) {
  StonySite site;
  const Daylight light({.cloud_cover = 1.0}, sun_at(40.0, 200.0));
  for (const int views : {3, 4}) {
    AllRoundCameraParameters parameters = joined(views);
    parameters.camera.samples = 16;
    parameters.camera.sensor.read_noise = 0.0;
    const auto by_views = make_all_round_camera(parameters, 1, "round");
    parameters.method = AllRoundMethod::rays;
    const auto by_rays = make_all_round_camera(parameters, 1, "round");
    CameraShot shot = round_shot(parameters, at(0.0, 0.0, 1.7, 0.3), light);
    shot.command.format = PixelFormat::mono12;
    shot.exposure = 1ms;
    CameraTruth of_views;
    CameraTruth of_rays;
    const auto a = by_views->take(site.scene, shot, &of_views);
    const auto b = by_rays->take(site.scene, shot, &of_rays);
    double sum = 0.0;
    double bias = 0.0;
    int pixels = 0;
    int same = 0;
    for (int y = 16; y < 112; ++y) {
      for (int x = 0; x < 512; ++x) {
        const double n = number_at(a.picture->parts[0], x, y);
        const double m = number_at(b.picture->parts[0], x, y);
        ASSERT_GT(m, 0.0);
        sum += (n - m) * (n - m);
        bias += n - m;
        ++pixels;
        const double range = truth_at(of_rays.range_m, of_rays, x, y);
        same +=
            std::abs(truth_at(of_views.range_m, of_views, x, y) - range) <= 0.05 * range ? 1 : 0;
      }
    }
    const double mean = b.mean * 4095.0;
    EXPECT_LT(std::sqrt(sum / pixels), 0.15 * mean) << views;
    EXPECT_LT(std::abs(bias / pixels), 0.01 * mean) << views;
    EXPECT_GT(same, 0.93 * pixels) << views;
  }
}

TEST(AllRoundCamera, BlackWhereNoViewLooks) {
  StonySite site;
  const Daylight light({}, sun_at(40.0, 200.0));
  AllRoundCameraParameters parameters = joined(3);
  parameters.camera.sensor.height_px = 200;
  const auto camera = make_all_round_camera(parameters, 1, "round");
  CameraTruth truth;
  const auto taken =
      camera->take(site.scene, round_shot(parameters, at(0.0, 0.0, 1.7), light), &truth);
  // A view of half height h reaches elevation e where tan(e) = h cos(azimuth) / f.
  const double focal_px = 0.5 * 319.0 / std::tan(kPi / 3.0);
  const double pixel_rad = 2.0 * kPi / 512.0;
  for (const int x : {256, 300, 330, 400, 426, 500}) {
    const double azimuth = (x + 0.5) * pixel_rad - kPi;
    const double from_axis = azimuth - std::round(azimuth * 3.0 / (2.0 * kPi)) * 2.0 * kPi / 3.0;
    const double edge = std::atan(99.5 * std::cos(from_axis) / focal_px);
    for (int y = 0; y < 128; ++y) {
      const double elevation = parameters.elevation_upper_rad - (y + 0.5) * pixel_rad;
      if (std::abs(std::abs(elevation) - edge) < 0.5 * pixel_rad) {
        continue;
      }
      const bool seen = std::abs(elevation) < edge;
      EXPECT_EQ(number_at(taken.picture->parts[0], x, y) > 0, seen) << x << ", " << y;
      if (!seen) {
        EXPECT_EQ(truth_at(truth.range_m, truth, x, y), 0.0);
      }
    }
  }
}

TEST(AllRoundCamera, ColoursAreThoseOfTheSurfaces) {
  // A red wall ahead, a blue one behind, in even light.
  Scene scene;
  const auto wall = scene.add_mesh(make_box("wall", {0.2, 40.0, 40.0}));
  scene.add_object(wall, at(5.0, 0.0, 0.0), 1.0, surface("red"));
  scene.add_object(wall, at(-5.0, 0.0, 0.0), 1.0, surface("blue"));
  ready(scene);
  const Daylight light({.cloud_cover = 1.0}, sun_at(40.0, 200.0));
  for (const AllRoundMethod method : {AllRoundMethod::rays, AllRoundMethod::views}) {
    AllRoundCameraParameters parameters = joined(3);
    parameters.method = method;
    parameters.camera.sensor.colour = true;
    parameters.camera.looks = {
        {.label = "red", .kind = SurfaceKind::plaster, .colour = {0.6, 0.06, 0.03}},
        {.label = "blue", .kind = SurfaceKind::plaster, .colour = {0.03, 0.06, 0.6}}};
    const auto camera = make_all_round_camera(parameters, 1, "round");
    CameraShot shot = round_shot(parameters, at(0.0, 0.0, 0.0), light);
    shot.command.format = PixelFormat::rgb8;
    shot.exposure = 1ms;
    const auto taken = camera->take(scene, shot, nullptr);
    const PicturePart& part = taken.picture->parts[0];
    ASSERT_EQ(part.bytes.size(), 3U * 512U * 128U);
    const auto band = [&](int x, int y, std::size_t which) {
      return static_cast<int>(part.bytes[3 * static_cast<std::size_t>(y * 512 + x) + which]);
    };
    for (int y = 50; y < 78; ++y) {
      for (int x : {250, 256, 262}) {
        EXPECT_GT(band(x, y, 0), 3 * band(x, y, 2)) << x << ", " << y;
      }
      for (int x : {0, 1, 5, 506, 510, 511}) {  // across the seam
        EXPECT_GT(band(x, y, 2), 3 * band(x, y, 0)) << x << ", " << y;
      }
    }
    EXPECT_GT(taken.mean, 0.0);
    shot.command.format = PixelFormat::mono8;
    EXPECT_EQ(refused(*camera, scene, shot), "all-round camera: format: found Mono8, allowed RGB8");
  }
}

TEST(AllRoundCamera, ThreadsAndRegionsDoNotChangeIt) {
  StonySite site;
  const Daylight light({}, sun_at(40.0, 200.0));
  for (const AllRoundMethod method : {AllRoundMethod::rays, AllRoundMethod::views}) {
    for (const bool colour : {false, true}) {
      AllRoundCameraParameters parameters = joined(3);
      parameters.method = method;
      parameters.camera.sensor.colour = colour;
      CameraShot shot = round_shot(parameters, at(0.0, 0.0, 1.7), light);
      shot.command.format = colour ? PixelFormat::rgb8 : PixelFormat::mono10;
      shot.exposure = 200us;
      std::shared_ptr<const Picture> first;
      for (const int threads : {1, 2, 3}) {
        parameters.camera.threads = threads;
        const auto camera = make_all_round_camera(parameters, 1, "round");
        const auto taken = camera->take(site.scene, shot, nullptr);
        if (first) {
          EXPECT_TRUE(same_bytes(*first, *taken.picture)) << threads;
        }
        first = taken.picture;
      }
      const auto camera = make_all_round_camera(parameters, 1, "round");
      shot.command.region = {120, 30, 64, 40};
      CameraTruth truth;
      const auto part = camera->take(site.scene, shot, &truth).picture;
      EXPECT_EQ(truth.width, 64);
      const std::size_t bytes = bytes_per_pixel(shot.command.format);
      for (std::size_t y = 0; y < 40; ++y) {
        for (std::size_t x = 0; x < 64 * bytes; ++x) {
          ASSERT_EQ(part->parts[0].bytes[y * 64 * bytes + x],
                    first->parts[0].bytes[((y + 30) * 512 + 120) * bytes + x]);
        }
      }
    }
  }
}

TEST(AllRoundCamera, RefusesShotsThatDoNotFit) {
  StonySite site;
  const Daylight light({}, sun_at(40.0, 200.0));
  const AllRoundCameraParameters parameters = sphere();
  const auto camera = make_all_round_camera(parameters, 1, "round");
  CameraShot shot = round_shot(parameters, at(0.0, 0.0, 1.7), light);
  EXPECT_EQ(refused(*camera, site.scene, shot), "");
  shot.command.range = true;
  EXPECT_EQ(refused(*camera, site.scene, shot),
            "all-round camera: parts: found range, allowed intensity");
  shot = round_shot(parameters, at(0.0, 0.0, 1.7), light);
  shot.command.binning_vertical = 2;
  EXPECT_NE(refused(*camera, site.scene, shot), "");
}

}  // namespace
}  // namespace rigwire::sim
