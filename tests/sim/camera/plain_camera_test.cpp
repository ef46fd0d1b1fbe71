#include "sim/camera/plain_camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "shot_site.h"

namespace rigwire::sim {
namespace {

using namespace camera_test;

TEST(PlainCamera, BytesAreTheSensorsNumbers) {
  StonySite site;
  const Daylight light({}, sun_at(40.0, 200.0));
  for (const bool colour : {false, true}) {
    CameraParameters parameters = small_camera();
    parameters.sensor.colour = colour;
    const auto camera = make_plain_camera(parameters, 7, "front");
    CameraRenderer renderer(parameters, 7, "front");
    for (const PixelFormat format :
         colour
             ? std::vector{PixelFormat::bayer_rg8, PixelFormat::bayer_rg10, PixelFormat::bayer_rg12}
             : std::vector{PixelFormat::mono8, PixelFormat::mono10, PixelFormat::mono12}) {
      CameraShot shot = shot_for(160, 120, at(0.0, 0.0, 1.5, 0.0, 0.1), light);
      shot.command.format = format;
      shot.command.black_level = 4.0;
      shot.exposure = 200us;
      shot.gain_db = 3.0;
      shot.frame = 5;
      CameraTruth truth;
      const auto taken = camera->take(site.scene, shot, &truth);

      PictureJob job = job_for(parameters, at(0.0, 0.0, 1.5, 0.0, 0.1), light);
      job.read_out.bits = static_cast<int>(significant_bits(format));
      job.read_out.black_level = 4.0;
      job.read_out.exposure = 200us;
      job.read_out.gain_db = 3.0;
      job.read_out.frame = 5;
      RenderedPicture rendered;
      renderer.render(site.scene, job, rendered);
      ASSERT_EQ(taken.picture->parts.size(), 1U);
      const PicturePart& part = taken.picture->parts.front();
      EXPECT_EQ(part.format, format);
      EXPECT_EQ(part.bytes.size(), 160U * 120U * bytes_per_pixel(format));
      for (int y = 0; y < 120; y += 7) {
        for (int x = 0; x < 160; ++x) {
          ASSERT_EQ(
              number_at(part, x, y),
              rendered.numbers[static_cast<std::size_t>(y) * 160 + static_cast<std::size_t>(x)]);
        }
      }
      EXPECT_EQ(taken.mean, rendered.mean);
      EXPECT_EQ(truth.range_m, rendered.range_m);
      EXPECT_EQ(truth.instance, rendered.instance);
      EXPECT_EQ(taken.picture->exposure_start, shot.start);
      EXPECT_EQ(taken.picture->exposure, shot.exposure);
      EXPECT_EQ(taken.picture->gain_db, 3.0);
    }
  }
}

TEST(PlainCamera, ARegionOfBinnedPixelsIsInTheirUnit) {
  StonySite site;
  const Daylight light({}, sun_at(40.0, 200.0));
  const auto camera = make_plain_camera(small_camera(), 7, "front");
  CameraShot shot = shot_for(80, 60, at(0.0, 0.0, 1.5, 0.0, 0.1), light);
  shot.command.binning_horizontal = shot.command.binning_vertical = 2;
  CameraTruth whole;
  (void)camera->take(site.scene, shot, &whole);
  shot.command.region = {10, 6, 40, 20};
  CameraTruth part;
  const auto taken = camera->take(site.scene, shot, &part);
  EXPECT_EQ(taken.picture->parts.front().region, shot.command.region);
  EXPECT_EQ(taken.picture->parts.front().bytes.size(), 40U * 20U);
  ASSERT_EQ(part.width, 40);
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 40; ++x) {
      ASSERT_EQ(truth_at(part.range_m, part, x, y), truth_at(whole.range_m, whole, x + 10, y + 6));
    }
  }
}

TEST(PlainCamera, SpanIsThatOfTheRowsThatAreRead) {
  CameraParameters parameters = small_camera();
  parameters.sensor.row_time = 20us;
  const auto camera = make_plain_camera(parameters, 7, "front");
  CameraCommand command;
  command.region = {0, 0, 160, 120};
  EXPECT_EQ(camera->span(command, 1ms), 1ms + 119 * 20us);
  command.region = {0, 50, 160, 10};
  EXPECT_EQ(camera->span(command, 1ms), 1ms + 9 * 20us);
  command.region = {0, 0, 80, 60};
  command.binning_horizontal = command.binning_vertical = 2;
  EXPECT_EQ(camera->span(command, 1ms), 1ms + 59 * 40us);
}

TEST(PlainCamera, NumbersFallOffToTheCornersAboveTheirBlackLevel) {
  // An even wall under an even sky, with and without the lens's cos^4.
  Scene scene;
  const auto wall = scene.add_mesh(make_box("wall", {0.2, 80.0, 80.0}));
  scene.add_object(wall, at(5.0, 0.0, 0.0), 1.0, surface("wall"));
  ready(scene);
  const Daylight light({.cloud_cover = 1.0}, sun_at(40.0, 200.0));
  const auto means = [&](double vignetting) {
    CameraParameters parameters = small_camera();
    parameters.lens.vignetting = vignetting;
    parameters.looks = {{.label = "wall", .kind = SurfaceKind::plaster, .colour = {0.3, 0.3, 0.3}}};
    const auto camera = make_plain_camera(parameters, 7, "front");
    CameraShot shot = shot_for(160, 120, at(0.0, 0.0, 0.0), light);
    shot.command.format = PixelFormat::mono12;
    shot.command.black_level = 16.0;
    const auto picture = camera->take(scene, shot, nullptr).picture;
    const auto mean = [&](int x0, int y0) {
      double sum = 0.0;
      for (int y = y0; y < y0 + 12; ++y) {
        for (int x = x0; x < x0 + 12; ++x) {
          sum += number_at(picture->parts[0], x, y) - 16.0 * 16.0;
        }
      }
      return sum / 144.0;
    };
    return std::pair{mean(74, 54), mean(2, 2)};
  };
  const auto [even_middle, even_corner] = means(0.0);
  const auto [middle, corner] = means(1.0);
  ASSERT_GT(even_middle, 200.0);
  // The middle of the corner's square is 72 columns and 52 rows from the axis, at 80 a unit.
  const double cosine = 1.0 / std::sqrt(1.0 + (72.0 * 72.0 + 52.0 * 52.0) / (80.0 * 80.0));
  EXPECT_NEAR(middle / even_middle, 1.0, 0.02);
  EXPECT_NEAR(corner / even_corner, std::pow(cosine, 4), 0.03 * std::pow(cosine, 4));
}

TEST(PlainCamera, RefusesShotsThatDoNotFit) {
  StonySite site;
  const Daylight light({}, sun_at(40.0, 200.0));
  const auto camera = make_plain_camera(small_camera(), 7, "front");
  const CameraShot good = shot_for(160, 120, at(0.0, 0.0, 1.5), light);
  EXPECT_EQ(refused(*camera, site.scene, good), "");
  CameraShot shot = good;
  shot.command.format = PixelFormat::bayer_rg8;
  EXPECT_EQ(refused(*camera, site.scene, shot),
            "camera: format: found BayerRG8, allowed Mono8, Mono10, Mono12");
  shot = good;
  shot.command.disparity = true;
  EXPECT_EQ(refused(*camera, site.scene, shot),
            "camera: parts: found disparity, allowed intensity");
  shot = good;
  shot.command.intensity = false;
  EXPECT_EQ(refused(*camera, site.scene, shot), "camera: parts: found none, allowed intensity");
  for (const PictureRegion& region :
       {PictureRegion{0, 0, 0, 120}, PictureRegion{1, 0, 160, 120}, PictureRegion{-1, 0, 8, 8},
        PictureRegion{0, 0, std::numeric_limits<int>::max(), 8},
        PictureRegion{std::numeric_limits<int>::max(), 0, 8, 8}}) {
    shot = good;
    shot.command.region = region;
    EXPECT_NE(refused(*camera, site.scene, shot), "") << region.width;
    shot.command.binning_horizontal = 16;
    EXPECT_NE(refused(*camera, site.scene, shot), "") << region.width;
  }
  shot = good;
  shot.exposure = Duration{0};
  EXPECT_NE(refused(*camera, site.scene, shot), "");
  shot = good;
  shot.gain_db = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refused(*camera, site.scene, shot), "");
  shot = good;
  shot.light = nullptr;
  EXPECT_NE(refused(*camera, site.scene, shot), "");
  shot = good;
  shot.poses.front().mount.X_WL.translation().x() = std::numeric_limits<double>::infinity();
  EXPECT_NE(refused(*camera, site.scene, shot), "");
}

}  // namespace
}  // namespace rigwire::sim
