// What is seen: light, shadow, air, grain.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "camera_site.h"
#include "sim/camera/camera_renderer.h"

namespace rigwire::sim {
namespace {

using namespace camera_test;

/// Straight down from `height_m`; the picture's top is north, its right east.
Eigen::Isometry3d picture_light_looking_down(double height_m) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() << 0.0, 0.0, height_m;
  X.linear() << 0.0, -1.0, 0.0, 0.0, 0.0, 1.0, -1.0, 0.0, 0.0;
  return X;
}

TEST(PictureLight, LevelGroundSendsBackItsAlbedo) {
  Scene scene;
  scene.add_terrain(level_ground(), surface("sheet", 0.3));
  ready(scene);
  const Daylight light({}, sun_at(50.0, 200.0));
  CameraParameters parameters = small_camera();
  CameraRenderer camera(parameters, 1, "camera");
  RenderedPicture picture;
  // From high up, where grain of less than a pixel is even.
  camera.render(scene, job_for(parameters, picture_light_looking_down(60.0), light), picture);
  const double seen = mean_luminance(picture, 40, 30, 120, 90);
  // Paint is blended from two tints, 1 and 0.89 of it, and has a coat.
  const double lambert = 0.945 * 0.3 / std::numbers::pi * static_cast<double>(light.total_lx().y());
  EXPECT_NEAR(seen / lambert, 1.0, 0.12);
}

TEST(PictureLight, ShadowsLieWhereTheSunPutsThem) {
  Scene scene;
  scene.add_terrain(level_ground(), surface("building"));
  const auto mesh = scene.add_mesh(make_box("post", {1.0, 1.0, 8.0}));
  const auto post = scene.add_object(mesh, at(0.0, 0.0, 4.0), 1.0, surface("machine"));
  ready(scene);
  // From the south west, 45 degrees high: the shadow of 8 m goes to the north east.
  const Daylight light({}, sun_at(45.0, 225.0));
  CameraParameters parameters = small_camera(160.0);
  CameraRenderer camera(parameters, 1, "camera");
  RenderedPicture picture;
  const double height = 60.0;
  camera.render(scene, job_for(parameters, picture_light_looking_down(height), light), picture);
  const double per_m = 160.0 / height;
  const auto at_ground = [&](double east, double north) {
    return luminance_at(picture, static_cast<int>(std::lround(79.5 + per_m * east)),
                        static_cast<int>(std::lround(59.5 - per_m * north)));
  };
  const double open = at_ground(-8.0, 8.0);
  const double along = std::sqrt(0.5);
  const double sky_share = static_cast<double>(light.sky_lx().y() / light.total_lx().y());
  for (const double way : {2.0, 4.0, 6.0, 7.5}) {
    EXPECT_NEAR(at_ground(way * along, way * along) / open, sky_share, 0.35 * sky_share) << way;
  }
  // Beyond its tip, beside it, and on the sunny side there is none.
  EXPECT_GT(at_ground(9.5 * along, 9.5 * along), 0.85 * open);
  EXPECT_GT(at_ground(4.0 * along + 2.0, 4.0 * along - 2.0), 0.85 * open);
  EXPECT_GT(at_ground(-3.0 * along, -3.0 * along), 0.85 * open);
  EXPECT_EQ(instance_at(picture, 80, 60), post);
}

TEST(PictureLight, LeavesLetTheSunThroughTheirGaps) {
  auto mask = std::make_shared<AlphaMask>();
  mask->name = "checks";
  mask->columns = mask->rows = 2;
  mask->opacity = {255, 0, 0, 0};  // a quarter
  TriangleMesh card;
  card.name = "leaves";
  card.vertices = {{-10, -10, 0}, {10, -10, 0}, {10, 10, 0}, {-10, 10, 0}};
  card.triangles = {{0, 1, 2}, {0, 2, 3}};
  card.texture_coordinates = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};
  card.alpha = mask;
  Scene scene;
  scene.add_terrain(level_ground(), surface("building"));
  Material leaves = surface("crown");
  leaves.loose_leaves = true;
  scene.add_object(scene.add_mesh(card), at(0.0, 0.0, 5.0), 1.0, leaves);
  ready(scene);
  const Daylight light({}, sun_at(60.0, 180.0));
  CameraParameters parameters = small_camera(160.0);
  CameraRenderer camera(parameters, 1, "camera");
  RenderedPicture picture;
  // From below the leaves.
  camera.render(scene, job_for(parameters, picture_light_looking_down(4.0), light), picture);
  const float most = *std::ranges::max_element(picture.luminance);
  int lit = 0;
  int all = 0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x, ++all) {
      lit += luminance_at(picture, x, y, 0) > 0.5 * static_cast<double>(most) ? 1 : 0;
    }
  }
  EXPECT_NEAR(static_cast<double>(lit) / all, 0.75, 0.06);
}

TEST(PictureLight, FogTakesContrastByItsLaw) {
  Scene scene;
  const auto mesh = scene.add_mesh(make_box("board", {0.1, 10.0, 40.0}));
  scene.add_object(mesh, at(30.05, 5.0, 0.0), 1.0, surface("dark", 0.03));
  scene.add_object(mesh, at(30.05, -5.0, 0.0), 1.0, surface("light", 0.7));
  ready(scene);
  const Daylight light({.cloud_cover = 1.0}, sun_at(40.0, 180.0));
  WeatherParameters weather;
  weather.course = {{.fog_visibility_m = 100.0}};
  const CameraAir fog(weather, kStart, nullptr);
  CameraParameters parameters = small_camera(600.0);
  CameraRenderer camera(parameters, 1, "camera");
  PictureJob job = job_for(parameters, at(0.0, 0.0, 0.0), light);
  RenderedPicture picture;
  const auto contrast = [&] {
    camera.render(scene, job, picture);
    return mean_luminance(picture, 90, 50, 150, 70) - mean_luminance(picture, 10, 50, 70, 70);
  };
  const double clear = contrast();
  job.air = &fog;
  const double foggy = contrast();
  EXPECT_NEAR(foggy / clear, std::exp(-std::log(20.0) / 100.0 * 30.0), 0.005);
  // Nothing but fog far away.
  EXPECT_GT(mean_luminance(picture, 10, 50, 70, 70), 0.0);
}

TEST(PictureLight, DustIsSeenInItsColour) {
  DustCloud cloud({});
  const std::vector<DustEmitter> emitters{{.position_W = {15.0, 0.0, 1.0}, .mass_rate_kgps = 2.0}};
  for (int i = 0; i < 20; ++i) {
    cloud.advance(0.02, Eigen::Vector2d::Zero(), 1.0, emitters);
  }
  ASSERT_FALSE(cloud.puffs().empty());
  const CameraAir air({}, kStart, &cloud);
  EXPECT_FALSE(air.clear());
  const CameraAir::Depth depth = air.depth({0.0, 0.0, 1.0}, {1.0, 0.0, 0.0}, 40.0);
  EXPECT_GT(depth.dust, 0.5);
  EXPECT_EQ(depth.even, 0.0);
  EXPECT_NEAR(air.depth({0.0, 0.0, 1.0}, {-1.0, 0.0, 0.0}, 40.0).dust, 0.0, 1e-3);

  Scene scene;
  scene.add_terrain(level_ground(), surface("road"));
  ready(scene);
  const Daylight light({}, sun_at(40.0, 180.0));
  CameraParameters parameters = small_camera();
  CameraRenderer camera(parameters, 1, "camera");
  PictureJob job = job_for(parameters, at(0.0, 0.0, 1.0), light);
  RenderedPicture clear;
  camera.render(scene, job, clear);
  job.air = &air;
  RenderedPicture dusty;
  camera.render(scene, job, dusty);
  // Red over blue rises before the blue sky; the picture's other side is as it was.
  EXPECT_GT(luminance_at(dusty, 80, 57, 0) / luminance_at(dusty, 80, 57, 2),
            1.2 * luminance_at(clear, 80, 57, 0) / luminance_at(clear, 80, 57, 2));
  EXPECT_NEAR(luminance_at(dusty, 2, 110), luminance_at(clear, 2, 110),
              0.02 * luminance_at(clear, 2, 110));
}

TEST(PictureLight, RainDarkensGround) {
  Scene scene;
  scene.add_terrain(level_ground(), surface("ground"));
  ready(scene);
  const Daylight light({.cloud_cover = 1.0}, sun_at(40.0, 180.0));
  CameraParameters parameters = small_camera();
  CameraRenderer camera(parameters, 1, "camera");
  PictureJob job = job_for(parameters, picture_light_looking_down(5.0), light);
  RenderedPicture picture;
  camera.render(scene, job, picture);
  const double dry = mean_luminance(picture, 0, 0, 160, 120);
  job.wetness = wetness_of(8.0);
  camera.render(scene, job, picture);
  const double wet = mean_luminance(picture, 0, 0, 160, 120);
  EXPECT_LT(wet, 0.75 * dry);
  EXPECT_GT(wet, 0.45 * dry);
  EXPECT_EQ(wetness_of(0.0), 0.0);
  WeatherParameters weather;
  weather.course = {{.rain_mmph = 8.0}};
  EXPECT_EQ(CameraAir(weather, kStart, nullptr).rain_mmph(), 8.0);
}

/// Rms difference of neighbours over the mean: contrast at the pixel.
double pixel_contrast(const char* label, double height_m) {
  Scene scene;
  scene.add_terrain(level_ground(), surface(label));
  ready(scene);
  const Daylight light({}, sun_at(45.0, 200.0));
  CameraParameters parameters = small_camera(160.0);
  CameraRenderer camera(parameters, 1, "camera");
  RenderedPicture picture;
  camera.render(scene, job_for(parameters, picture_light_looking_down(height_m), light), picture);
  double squares = 0.0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x + 1 < picture.width; ++x) {
      squares += std::pow(luminance_at(picture, x + 1, y) - luminance_at(picture, x, y), 2);
    }
  }
  return std::sqrt(0.5 * squares / (picture.height * (picture.width - 1))) /
         mean_luminance(picture, 0, 0, picture.width, picture.height);
}

TEST(PictureLight, GroundHasContrastAtThePixelAndConcreteHasNot) {
  for (const double height_m : {1.5, 5.0, 20.0, 50.0}) {
    EXPECT_GT(pixel_contrast("ground", height_m), 0.06) << height_m;
    EXPECT_LT(pixel_contrast("ground", height_m), 0.35) << height_m;
    EXPECT_GT(pixel_contrast("rock", height_m), 0.05) << height_m;
    EXPECT_LT(pixel_contrast("kerb", height_m), 0.025) << height_m;
  }
}

TEST(PictureLight, PatternsLieInTheWorldAndOnBodies) {
  const Daylight light({}, sun_at(45.0, 200.0));
  const CameraParameters parameters = small_camera(160.0);
  CameraRenderer camera(parameters, 1, "camera");
  const auto view = [&](const Eigen::Vector3d& focus_W, const Eigen::Vector3d& shift) {
    Scene scene;
    scene.add_terrain(level_ground({0.0, 0.0, -1.0}), surface("ground"));
    const auto body = scene.add_body("link");
    const auto mesh = scene.add_mesh(make_box("plate", {8.0, 8.0, 0.1}));
    scene.add_body_part(body, mesh, at(0.0, 0.0, 0.0, 0.3), surface("rock"));
    Eigen::Isometry3d X_WB = at(4.0, 0.0, 1.0);
    X_WB.translation() += shift;
    const std::vector<BodyMotion> motions{{X_WB, X_WB}};
    scene.begin_slice(kStart, kStart + 100ms, focus_W, motions);
    Eigen::Isometry3d X_WS = picture_light_looking_down(6.0);
    X_WS.translation() += shift;
    RenderedPicture picture;
    camera.render(scene, job_for(parameters, X_WS, light), picture);
    return picture;
  };
  const auto difference = [](const RenderedPicture& a, const RenderedPicture& b, int x0, int x1) {
    double sum = 0.0;
    for (int y = 10; y < 110; ++y) {
      for (int x = x0; x < x1; ++x) {
        sum += std::abs(luminance_at(a, x, y) - luminance_at(b, x, y));
      }
    }
    return sum / (100 * (x1 - x0)) / mean_luminance(a, x0, 10, x1, 110);
  };
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  const RenderedPicture here = view(none, none);
  // The ray caster's own origin elsewhere: the same picture.
  const RenderedPicture from_afar = view({40.0, -50.0, 30.0}, none);
  EXPECT_LT(difference(here, from_afar, 0, 160), 0.01);
  // Body and camera moved together: the same body, other ground.
  const RenderedPicture moved = view(none, {0.37, 0.21, 0.0});
  EXPECT_LT(difference(here, moved, 100, 155), 0.01);
  EXPECT_GT(difference(here, moved, 5, 60), 0.05);
}

TEST(SkyVisibility, FallsAtTheFootOfWallsAndInTheWoods) {
  Scene scene;
  scene.add_terrain(level_ground(Eigen::Vector3d::Zero(), 40.0), surface("ground"));
  const auto mesh = scene.add_mesh(make_box("wall", {1.0, 70.0, 80.0}));
  scene.add_object(mesh, at(10.5, 0.0, 0.0), 1.0, surface("building"));
  ready(scene);
  const SkyVisibility sky(scene);
  const auto at_place = [&](double x, double y, double z) {
    return sky.at(static_cast<float>(x - sky.origin_m().x()),
                  static_cast<float>(y - sky.origin_m().y()), static_cast<float>(z));
  };
  // Half of the sky at the foot of an endless wall (a little less of it is as low as that one).
  EXPECT_NEAR(at_place(9.0, 0.0, 0.0), 0.55, 0.12);
  EXPECT_NEAR(at_place(-35.0, 0.0, 0.0), 0.9, 0.12);
  EXPECT_GT(at_place(9.0, 0.0, 39.0), at_place(9.0, 0.0, 0.0) - 0.02F);
  EXPECT_TRUE(SkyVisibility().everywhere());
  EXPECT_EQ(SkyVisibility().at(0.0F, 0.0F, 0.0F), 1.0F);
  // Rays of the picture's own agree.
  const Daylight light({.cloud_cover = 1.0}, sun_at(45.0, 200.0));
  CameraParameters parameters = small_camera(160.0);
  CameraRenderer lattice(parameters, 1, "camera");
  parameters.sky_rays = 32;
  CameraRenderer rays(parameters, 1, "camera");
  Eigen::Isometry3d X_WS = picture_light_looking_down(6.0);
  X_WS.translation() += Eigen::Vector3d(7.0, 0.0, 0.0);
  PictureJob job = job_for(parameters, X_WS, light);
  job.sky = &sky;
  RenderedPicture a;
  RenderedPicture b;
  lattice.render(scene, job, a);
  rays.render(scene, job, b);
  EXPECT_NEAR(mean_luminance(a, 20, 20, 120, 100) / mean_luminance(b, 20, 20, 120, 100), 1.0, 0.15);
}

}  // namespace
}  // namespace rigwire::sim
