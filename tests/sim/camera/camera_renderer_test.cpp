// What holds of every picture: repeatable, refused when it does not fit, and it comes back.
#include "sim/camera/camera_renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <future>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include "camera_site.h"

namespace rigwire::sim {
namespace {

using namespace camera_test;

/// Ground, rocks as instances, a machine that moves.
struct Site {
  Site() {
    scene.add_terrain(level_ground(), surface("ground"));
    RandomStream random(3, "rocks");
    const auto rock = scene.add_mesh(make_rock("rock", random));
    for (int i = 0; i < 120; ++i) {
      scene.add_object(rock,
                       at(random.uniform(2.0, 30.0), random.uniform(-15.0, 15.0),
                          random.uniform(0.0, 3.0), random.uniform(0.0, 6.0)),
                       random.uniform(0.2, 1.5), surface("rock"));
    }
    const auto body = scene.add_body("arm");
    const auto box = scene.add_mesh(make_box("arm", {4.0, 0.5, 0.5}));
    scene.add_body_part(body, box, at(0.0, 0.0, 0.0), surface("machine"));
    move(at(6.0, 1.0, 2.0, 0.0), at(6.0, 1.2, 2.1, 0.05));
  }
  void move(const Eigen::Isometry3d& start, const Eigen::Isometry3d& end) {
    const std::vector<BodyMotion> motions{{start, end}};
    scene.begin_slice(kStart, kStart + 100ms, Eigen::Vector3d::Zero(), motions);
  }
  Scene scene;
};

TEST(CameraRenderer, ThreadsAndTilesDoNotChangeThePicture) {
  Site site;
  const Daylight light({}, sun_at(35.0, 220.0));
  WeatherParameters weather;
  weather.course = {{.rain_mmph = 3.0, .haze_visibility_m = 2000.0}};
  const CameraAir air(weather, kStart, nullptr);
  const SkyVisibility sky(site.scene);
  CameraParameters parameters = small_camera();
  parameters.samples = 3;
  parameters.sensor.row_time = 20us;
  parameters.sensor.colour = true;
  CameraRenderer one(parameters, 1, "camera");
  parameters.threads = 3;
  CameraRenderer three(parameters, 1, "camera");
  PictureJob job = job_for(parameters, at(0.0, 0.0, 2.0, 0.0, 0.1), light);
  job.poses = poses(at(0.0, 0.0, 2.0, 0.0, 0.1), kStart, kStart + 100ms, {0.1, 0.2, 0.8});
  job.air = &air;
  job.sky = &sky;
  job.wetness = 0.5;
  RenderedPicture a;
  RenderedPicture b;
  one.render(site.scene, job, a);
  three.render(site.scene, job, b);
  EXPECT_EQ(a.numbers, b.numbers);
  EXPECT_EQ(a.luminance, b.luminance);
  EXPECT_EQ(a.range_m, b.range_m);
  EXPECT_EQ(a.instance, b.instance);
  EXPECT_EQ(a.mean, b.mean);
  // Other pictures in between do not matter.
  PictureJob other = job;
  other.read_out.frame = 9;
  other.read_out.region = {16, 8, 32, 32};
  three.render(site.scene, other, b);
  three.render(site.scene, job, b);
  EXPECT_EQ(a.numbers, b.numbers);
  // Another frame has other noise, on the same scene.
  other = job;
  other.read_out.frame = 1;
  one.render(site.scene, other, b);
  EXPECT_NE(a.numbers, b.numbers);
  EXPECT_EQ(a.instance, b.instance);
}

TEST(CameraRenderer, ARegionIsThatPartOfThePicture) {
  Site site;
  const Daylight light({}, sun_at(35.0, 220.0));
  const CameraParameters parameters = small_camera();
  CameraRenderer camera(parameters, 1, "camera");
  PictureJob job = job_for(parameters, at(0.0, 0.0, 2.0, 0.0, 0.1), light);
  RenderedPicture whole;
  camera.render(site.scene, job, whole);
  job.read_out.region = {37, 21, 51, 43};  // neither tiles nor packets
  RenderedPicture part;
  camera.render(site.scene, job, part);
  ASSERT_EQ(part.width, 51);
  ASSERT_EQ(part.height, 43);
  for (int y = 0; y < part.height; ++y) {
    for (int x = 0; x < part.width; ++x) {
      const auto in_whole = static_cast<std::size_t>((y + 21) * 160 + x + 37);
      const auto in_part = static_cast<std::size_t>(y * 51 + x);
      ASSERT_EQ(part.instance[in_part], whole.instance[in_whole]);
      ASSERT_EQ(part.numbers[in_part], whole.numbers[in_whole]) << x << ", " << y;
    }
  }
  // Binning halves it, and sees the same.
  job.read_out.region = {0, 0, 160, 120};
  job.read_out.binning_x = job.read_out.binning_y = 2;
  camera.render(site.scene, job, part);
  ASSERT_EQ(part.width, 80);
  ASSERT_EQ(part.height, 60);
  EXPECT_NEAR(mean_luminance(part, 0, 0, 80, 60) / mean_luminance(whole, 0, 0, 160, 120), 1.0,
              0.04);
}

TEST(CameraRenderer, ExposureGainAndMeanBelongTogether) {
  Site site;
  const Daylight light({}, sun_at(35.0, 220.0));
  const CameraParameters parameters = small_camera();
  CameraRenderer camera(parameters, 1, "camera");
  PictureJob job = job_for(parameters, at(0.0, 0.0, 2.0, 0.0, 0.3), light);
  job.read_out.exposure = 100us;
  RenderedPicture picture;
  camera.render(site.scene, job, picture);
  const double dark = picture.mean;
  EXPECT_GT(dark, 0.005);
  job.read_out.exposure = 200us;
  job.read_out.black_level = 4.0;
  camera.render(site.scene, job, picture);
  EXPECT_NEAR(picture.mean / dark, 2.0, 0.05);
}

TEST(CameraRenderer, SeesByNightAndFromWithinThings) {
  Site site;
  const Daylight night({}, sun_at(-30.0, 300.0));
  CameraParameters parameters = small_camera();
  CameraRenderer camera(parameters, 1, "camera");
  RenderedPicture picture;
  camera.render(site.scene, job_for(parameters, at(0.0, 0.0, 2.0), night), picture);
  for (const float l : picture.luminance) {
    ASSERT_TRUE(std::isfinite(l));
    ASSERT_LT(l, 0.01F);
  }
  // In a closed box, the sun high above it; rays find no sky.
  Scene scene;
  scene.add_object(scene.add_mesh(make_box("cell", {2.0, 2.0, 2.0})), at(0.0, 0.0, 0.0), 1.0,
                   surface("building"));
  ready(scene);
  const Daylight day({.ground_albedo = 0.0}, sun_at(60.0, 180.0));
  parameters.sky_rays = 8;
  CameraRenderer inside(parameters, 1, "camera");
  inside.render(scene, job_for(parameters, at(0.1, 0.2, 0.0), day), picture);
  EXPECT_LT(*std::ranges::max_element(picture.luminance), 1.0F);
  EXPECT_GT(*std::ranges::min_element(picture.range_m), 0.0F);
  // Below the ground.
  camera.render(site.scene, job_for(parameters, at(0.0, 0.0, -3.0, 0.0, -0.5), day), picture);
  for (const float l : picture.luminance) {
    ASSERT_TRUE(std::isfinite(l));
  }
  // An empty scene is sky and far ground.
  Scene nothing;
  ready(nothing);
  camera.render(nothing, job_for(parameters, at(0.0, 0.0, 2.0), day), picture);
  EXPECT_GT(luminance_at(picture, 80, 10), 500.0);
  EXPECT_EQ(*std::ranges::max_element(picture.range_m), 0.0F);
}

TEST(CameraRenderer, RefusesJobsThatDoNotFit) {
  Site site;
  const Daylight light({}, sun_at(35.0, 220.0));
  const CameraParameters parameters = small_camera();
  CameraRenderer camera(parameters, 1, "camera");
  const auto refused = [&](auto change) {
    PictureJob job = job_for(parameters, at(0.0, 0.0, 2.0), light);
    change(job);
    RenderedPicture picture;
    try {
      camera.render(site.scene, job, picture);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refused([](PictureJob&) {}), "");
  EXPECT_NE(refused([](PictureJob& j) { j.light = nullptr; }).find("light"), std::string::npos);
  EXPECT_NE(refused([](PictureJob& j) { j.poses.resize(1); }).find("two poses"), std::string::npos);
  EXPECT_NE(refused([](PictureJob& j) {
              j.poses[3].mount.X_WL.translation().x() = std::numeric_limits<double>::quiet_NaN();
            }).find("pose 3"),
            std::string::npos);
  EXPECT_NE(refused([](PictureJob& j) { std::swap(j.poses[1], j.poses[2]); }).find("order"),
            std::string::npos);
  EXPECT_NE(refused([](PictureJob& j) { j.exposure_start = kStart + 99'500us; }).find("span"),
            std::string::npos);
  EXPECT_NE(refused([](PictureJob& j) {
              j.exposure_start = kStart + 150ms;
              j.poses = poses(at(0.0, 0.0, 2.0), kStart, kStart + 200ms);
            }).find("slice"),
            std::string::npos);
  EXPECT_NE(refused([](PictureJob& j) { j.wetness = 1.5; }).find("wetness"), std::string::npos);
  EXPECT_NE(refused([](PictureJob& j) { j.read_out.bits = 16; }).find("bits"), std::string::npos);
  CameraParameters bad = parameters;
  bad.near_m = 10.0;
  bad.far_m = 5.0;
  EXPECT_THROW(CameraRenderer(bad, 1, "camera"), std::invalid_argument);
  bad = parameters;
  bad.looks = {{.label = "", .kind = SurfaceKind::rock}};
  EXPECT_THROW(CameraRenderer(bad, 1, "camera"), std::invalid_argument);
}

TEST(CameraRenderer, LooksAreChosenByLabel) {
  Scene scene;
  scene.add_terrain(level_ground(), surface("ground"));
  ready(scene);
  const Daylight light({.cloud_cover = 1.0}, sun_at(35.0, 220.0));
  CameraParameters parameters = small_camera();
  const auto colour = [&] {
    CameraRenderer camera(parameters, 1, "camera");
    RenderedPicture picture;
    camera.render(scene, job_for(parameters, at(0.0, 0.0, 2.0, 0.0, 0.9), light), picture);
    return Eigen::Vector3d(mean_luminance(picture, 0, 0, 160, 120, 0),
                           mean_luminance(picture, 0, 0, 160, 120, 1),
                           mean_luminance(picture, 0, 0, 160, 120, 2));
  };
  const Eigen::Vector3d gravel = colour();
  EXPECT_GT(gravel.x(), gravel.y());
  EXPECT_GT(gravel.y(), gravel.z());
  parameters.looks = {{.label = "ground", .kind = SurfaceKind::grass}};
  const Eigen::Vector3d grass = colour();
  EXPECT_GT(grass.y(), grass.x());
  EXPECT_LT(grass.norm(), gravel.norm());
  parameters.looks = {
      {.label = "ground", .kind = SurfaceKind::concrete, .colour = {0.1, 0.1, 0.5}}};
  const Eigen::Vector3d blue = colour();
  EXPECT_GT(blue.z(), 3.0 * blue.x());
}

TEST(CameraRenderer, ShadowPacketsComeBack) {
  // Embree 3.13.5 loops for ever in coherent packets of shadow rays where a mesh and instances mix
  // and few lanes are active. Grazing sun, a camera among the rocks, from many places.
  std::packaged_task<int()> task([] {
    Site site;
    CameraParameters parameters = small_camera();
    CameraRenderer camera(parameters, 1, "camera");
    RenderedPicture picture;
    int pictures = 0;
    for (const double elevation : {1.0, 4.0, 20.0}) {
      for (int i = 0; i < 12; ++i) {
        const Daylight light({}, sun_at(elevation, 30.0 * i));
        PictureJob job = job_for(parameters, at(1.5 * i, 3.0 - 0.5 * i, 0.4, 0.5 * i, 0.05), light);
        job.truth = false;
        camera.render(site.scene, job, picture);
        ++pictures;
      }
    }
    return pictures;
  });
  std::future<int> finished = task.get_future();
  std::thread renderer(std::move(task));
  if (finished.wait_for(120s) != std::future_status::ready) {
    renderer.detach();
    FAIL() << "a packet of shadow rays does not come back";
  }
  renderer.join();
  EXPECT_EQ(finished.get(), 36);
}

TEST(CameraRenderer, RecordsTheRaysThatItCasts) {
  Site site;
  const Daylight light({}, sun_at(35.0, 220.0));
  CameraParameters parameters = small_camera();
  const PictureJob job = job_for(parameters, at(0.0, 0.0, 2.0, 0.0, 0.1), light);
  RecordedPictureRays with_parts = CameraRenderer(parameters, 1, "camera").record(site.scene, job);
  EXPECT_GT(with_parts.primary_rays(), 160U * 120U);
  with_parts.cast_bare(site.scene);
  parameters.edge_ratio = 0.0;
  CameraRenderer camera(parameters, 1, "camera");
  RecordedPictureRays rays = camera.record(site.scene, job);
  EXPECT_EQ(rays.primary_rays(), 160U * 120U);
  EXPECT_GT(rays.shadow_rays(), 160U * 120U / 4U);
  EXPECT_LE(rays.shadow_rays(), 160U * 120U);
  rays.cast_bare(site.scene);
  rays.reset();
  rays.cast_bare(site.scene);
}

}  // namespace
}  // namespace rigwire::sim
