#include "sim/camera/depth_camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "shot_site.h"

namespace rigwire::sim {
namespace {

using namespace camera_test;

/// 64 x 48 pixels; a flat wall of that reflectance across the axis, nothing else.
DepthCameraParameters small_depth() {
  DepthCameraParameters p;
  p.camera.sensor.width_px = 64;
  p.camera.sensor.height_px = 48;
  p.camera.lens.focal_length_m = 80.0 * p.camera.sensor.pixel_pitch_m;
  p.camera.lens.vignetting = 0.0;
  p.cyclic_error_m = 0.0;
  p.step_m = 0.0002;
  return p;
}

struct Wall {
  explicit Wall(double distance_m, double reflectance = 0.9, double yaw_rad = 0.0) {
    const auto mesh = scene.add_mesh(make_box("wall", {0.2, 80.0, 80.0}));
    Eigen::Isometry3d X = at(distance_m, 0.0, 0.0, yaw_rad);
    X.translation() += X.linear() * Eigen::Vector3d(0.1, 0.0, 0.0);
    scene.add_object(mesh, X, 1.0, surface("wall", reflectance));
    ready(scene);
  }
  Scene scene;
};

/// No light of day at all.
const Daylight& night() {
  static const Daylight light({}, sun_at(-60.0, 180.0));
  return light;
}

CameraShot depth_shot(const Daylight& light) {
  CameraShot shot = shot_for(64, 48, at(0.0, 0.0, 0.0), light);
  shot.command.range = true;
  shot.command.confidence = true;
  return shot;
}

struct Spread {
  double mean_m = 0.0;
  double deviation_m = 0.0;
  double valid = 0.0;
};
/// Spread of the differences between ranges and the truth, over some frames.
Spread spread_of(CameraSensor& camera, const Scene& scene, CameraShot shot, double step_m) {
  double sum = 0.0;
  double squares = 0.0;
  int count = 0;
  int pixels = 0;
  for (std::uint64_t frame = 0; frame < 4; ++frame) {
    shot.frame = frame;
    CameraTruth truth;
    const auto taken = camera.take(scene, shot, &truth);
    const PicturePart& range = part_of(*taken.picture, PictureComponent::range);
    for (int y = 0; y < range.region.height; ++y) {
      for (int x = 0; x < range.region.width; ++x) {
        ++pixels;
        if (number_at(range, x, y) != 0) {
          const double error =
              number_at(range, x, y) * step_m - truth_at(truth.depth_m, truth, x, y);
          sum += error;
          squares += error * error;
          ++count;
        }
      }
    }
  }
  const double mean = count > 0 ? sum / count : 0.0;
  return {mean, count > 0 ? std::sqrt(squares / count - mean * mean) : 0.0,
          static_cast<double>(count) / pixels};
}

TEST(DepthCamera, NoiseHasItsReferenceAndGrowsWithTheSquareOfTheDistance) {
  DepthCameraParameters parameters = small_depth();
  parameters.noise_floor_m = 0.0;
  parameters.step_m = 0.0001;
  parameters.farthest_m = 6.5;
  // Straight on only: the middle of the picture.
  parameters.camera.lens.focal_length_m = 2000.0 * parameters.camera.sensor.pixel_pitch_m;
  const auto camera = make_depth_camera(parameters, 1, "depth");
  for (const double distance_m : {2.0, 3.0, 5.5}) {
    Wall wall(distance_m);
    const Spread spread = spread_of(*camera, wall.scene, depth_shot(night()), parameters.step_m);
    const double sigma = 0.001 * std::pow(distance_m / 5.5, 2);
    const double rounded = std::hypot(sigma, parameters.step_m / std::sqrt(12.0));
    EXPECT_NEAR(spread.deviation_m, rounded, 0.03 * rounded) << distance_m;
    EXPECT_NEAR(spread.mean_m, 0.0, 0.1 * sigma) << distance_m;
    EXPECT_EQ(spread.valid, 1.0);
  }
}

TEST(DepthCamera, NoiseFollowsReflectanceIncidenceExposureAndDaylight) {
  const DepthCameraParameters p = small_depth();
  const double far_m = range_noise_m(p, 0.01, 0.0, p.noise_exposure);
  EXPECT_NEAR(far_m, std::hypot(0.1, 0.0003), 1e-9);
  // A surface of twice the doubling luminance trebles the variance; half the exposure halves it.
  EXPECT_NEAR(range_noise_m(p, 0.01, 168.0, p.noise_exposure),
              std::hypot(0.1 * std::sqrt(3.0), 0.0003), 1e-9);
  EXPECT_NEAR(range_noise_m(p, 0.01, 168.0, p.noise_exposure / 2),
              std::hypot(0.1 * std::sqrt(2.0), 0.0003), 1e-9);

  DepthCameraParameters parameters = small_depth();
  parameters.noise_floor_m = 0.0;
  parameters.camera.lens.focal_length_m = 2000.0 * parameters.camera.sensor.pixel_pitch_m;
  const auto camera = make_depth_camera(parameters, 1, "depth");
  const auto deviation = [&](const Scene& scene, Duration exposure) {
    CameraShot shot = depth_shot(night());
    shot.exposure = exposure;
    return spread_of(*camera, scene, shot, parameters.step_m).deviation_m;
  };
  Wall bright(5.5, 0.9);
  const double reference = deviation(bright.scene, 1ms);
  Wall dark(5.5, 0.18);
  EXPECT_NEAR(deviation(dark.scene, 1ms) / reference, 5.0, 0.25);
  Wall slanted(5.5, 0.9, 60.0 * kDegree);
  EXPECT_NEAR(deviation(slanted.scene, 1ms) / reference, 2.0, 0.15);
  EXPECT_NEAR(deviation(bright.scene, 250us) / reference, 4.0, 0.2);
}

TEST(DepthCamera, ThePublishedDaylightMakesSevenTimesTheNoise) {
  // 12.8 W/m2 in its band on a white surface at 6 m and 250 us; 25 W/m2 at 110 klx.
  const DepthCameraParameters p;
  const double illuminance_lx = 12.8 / 25.0 * 110e3;
  const double luminance_cd = 0.9 * illuminance_lx / std::numbers::pi;
  const double strength = std::pow(5.5 / 6.0, 2) * 0.25;
  DepthCameraParameters floorless = p;
  floorless.noise_floor_m = 0.0;
  const double ratio = range_noise_m(floorless, strength, luminance_cd, 250us) /
                       range_noise_m(floorless, strength, 0.0, 250us);
  EXPECT_NEAR(ratio, 7.0, 0.1);
}

TEST(DepthCamera, RangeLiesAlongTheAxis) {
  // A plane across the axis has one depth, whatever the pixel.
  DepthCameraParameters parameters = small_depth();
  parameters.noise_m = 0.0;
  parameters.noise_floor_m = 0.0;
  Wall wall(4.0);
  const auto camera = make_depth_camera(parameters, 1, "depth");
  const auto taken = camera->take(wall.scene, depth_shot(night()), nullptr);
  const PicturePart& range = part_of(*taken.picture, PictureComponent::range);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      // The mean of a pixel's rays is longer than the one through its middle.
      ASSERT_NEAR(number_at(range, x, y) * parameters.step_m, 4.0, 4e-4) << x << ", " << y;
    }
  }
}

TEST(DepthCamera, EdgesFloatBetweenFrontAndBack) {
  DepthCameraParameters parameters = small_depth();
  parameters.noise_m = 0.0;
  parameters.noise_floor_m = 0.0;
  parameters.rays_across = 4;
  Scene scene;
  const auto wall = scene.add_mesh(make_box("wall", {0.2, 80.0, 80.0}));
  scene.add_object(wall, at(5.1, 0.0, 0.0), 1.0, surface("wall", 0.9));
  const auto board = scene.add_mesh(make_box("board", {0.02, 40.0, 80.0}));
  scene.add_object(board, at(3.01, 20.013, 0.0), 1.0, surface("wall", 0.3));
  ready(scene);
  const auto camera = make_depth_camera(parameters, 1, "depth");
  const auto taken = camera->take(scene, depth_shot(night()), nullptr);
  const PicturePart& range = part_of(*taken.picture, PictureComponent::range);
  int between = 0;
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      const double depth_m = number_at(range, x, y) * parameters.step_m;
      EXPECT_GT(depth_m, 2.99);
      EXPECT_LT(depth_m, 5.01);
      between += depth_m > 3.1 && depth_m < 4.9 ? 1 : 0;
    }
  }
  // One column, that of the edge.
  EXPECT_GE(between, 40);
  EXPECT_LE(between, 48);
}

TEST(DepthCamera, NoRangeWhereItIsTooNearTooFarTooDarkOrTooBright) {
  const DepthCameraParameters parameters = small_depth();
  const auto camera = make_depth_camera(parameters, 1, "depth");
  const auto valid = [&](const Scene& scene, const CameraShot& shot) {
    const auto taken = camera->take(scene, shot, nullptr);
    const PicturePart& range = part_of(*taken.picture, PictureComponent::range);
    const PicturePart& confidence = part_of(*taken.picture, PictureComponent::confidence);
    int count = 0;
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64; ++x) {
        count += number_at(range, x, y) != 0 ? 1 : 0;
        EXPECT_LE(number_at(confidence, x, y) > 0, number_at(range, x, y) != 0);
      }
    }
    return count / (64.0 * 48.0);
  };
  const CameraShot dark = depth_shot(night());
  EXPECT_EQ(valid(Wall(4.0).scene, dark), 1.0);
  EXPECT_EQ(valid(Wall(0.2).scene, dark), 0.0);
  EXPECT_EQ(valid(Wall(10.5).scene, dark), 0.0);
  EXPECT_EQ(valid(Wall(9.5, 0.02).scene, dark), 0.0);
  // So near that the sensor is full.
  EXPECT_EQ(valid(Wall(0.4).scene, dark), 0.0);
  CameraShot brief = dark;
  brief.exposure = 50us;
  EXPECT_EQ(valid(Wall(0.4).scene, brief), 1.0);
  // The sun on dark ground drowns what comes back of it, not what is near.
  const Daylight noon({}, sun_at(60.0, 270.0));
  CameraShot sunlit = dark;
  sunlit.light = &noon;
  EXPECT_EQ(valid(Wall(6.0, 0.2).scene, dark), 1.0);
  EXPECT_LT(valid(Wall(6.0, 0.2).scene, sunlit), 0.05);
  EXPECT_GT(valid(Wall(1.5, 0.2).scene, sunlit), 0.95);
  // Nothing but the sky.
  Scene empty;
  empty.add_terrain(level_ground(), surface("ground"));
  ready(empty);
  CameraShot up = dark;
  up.poses = poses(at(0.0, 0.0, 1.0, 0.0, -1.2), kStart, kStart + 100ms);
  EXPECT_EQ(valid(empty, up), 0.0);
}

TEST(DepthCamera, DistancesBeyondTheAmbiguityFoldBack) {
  DepthCameraParameters parameters = small_depth();
  parameters.unambiguous_m = 6.0;
  parameters.farthest_m = 6.0;
  parameters.noise_m = 0.0;
  parameters.camera.lens.focal_length_m = 2000.0 * parameters.camera.sensor.pixel_pitch_m;
  const auto camera = make_depth_camera(parameters, 1, "depth");
  Wall wall(8.0);
  const auto taken = camera->take(wall.scene, depth_shot(night()), nullptr);
  const PicturePart& range = part_of(*taken.picture, PictureComponent::range);
  EXPECT_NEAR(number_at(range, 32, 24) * parameters.step_m, 2.0, 0.003);
}

TEST(DepthCamera, TheCyclicErrorRunsThroughItsCycle) {
  DepthCameraParameters parameters = small_depth();
  parameters.noise_m = 0.0;
  parameters.noise_floor_m = 0.0;
  parameters.cyclic_error_m = 0.005;
  parameters.camera.lens.focal_length_m = 2000.0 * parameters.camera.sensor.pixel_pitch_m;
  const auto camera = make_depth_camera(parameters, 1, "depth");
  for (const double part : {0.0, 0.25, 0.5, 0.75}) {
    Wall wall(4.5 + part * parameters.cycle_m);
    const Spread spread = spread_of(*camera, wall.scene, depth_shot(night()), parameters.step_m);
    EXPECT_NEAR(spread.mean_m, 0.005 * std::sin(2.0 * std::numbers::pi * part), 3e-4) << part;
  }
}

TEST(DepthCamera, ItsOwnLightIsSeenByNight) {
  const DepthCameraParameters parameters = small_depth();
  const auto camera = make_depth_camera(parameters, 1, "depth");
  CameraShot shot = depth_shot(night());
  shot.command.format = PixelFormat::mono12;
  const auto mean_at = [&](double distance_m) {
    Wall wall(distance_m);
    return camera->take(wall.scene, shot, nullptr).mean;
  };
  const double near = mean_at(2.0);
  EXPECT_GT(near, 0.01);
  EXPECT_NEAR(mean_at(4.0) / near, 0.25, 0.01);
}

TEST(DepthCamera, FogTakesItThereAndBack) {
  WeatherParameters weather;
  weather.course = {{.fog_visibility_m = 100.0}};
  const CameraAir air(weather, kStart, nullptr);
  const double depth = air.depth(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX(), 6.0).even;
  ASSERT_GT(depth, 0.05);
  DepthCameraParameters parameters = small_depth();
  parameters.noise_floor_m = 0.0;
  parameters.camera.lens.focal_length_m = 2000.0 * parameters.camera.sensor.pixel_pitch_m;
  const auto camera = make_depth_camera(parameters, 1, "depth");
  Wall wall(6.0);
  CameraShot shot = depth_shot(night());
  const double clear = spread_of(*camera, wall.scene, shot, parameters.step_m).deviation_m;
  shot.air = &air;
  const double foggy = spread_of(*camera, wall.scene, shot, parameters.step_m).deviation_m;
  EXPECT_NEAR(foggy / clear, std::exp(2.0 * depth), 0.04 * std::exp(2.0 * depth));
}

TEST(DepthCamera, ThreadsAndRegionsDoNotChangeIt) {
  StonySite site;
  const Daylight light({}, sun_at(45.0, 250.0));
  DepthCameraParameters parameters = small_depth();
  CameraShot shot = depth_shot(light);
  shot.poses = poses(at(0.0, 0.0, 1.5, 0.0, 0.3), kStart, kStart + 100ms, {0.0, 0.0, 0.5});
  std::shared_ptr<const Picture> first;
  for (const int threads : {1, 2, 3}) {
    parameters.camera.threads = threads;
    const auto camera = make_depth_camera(parameters, 1, "depth");
    (void)camera->take(site.scene, depth_shot(light), nullptr);  // what was before does not count
    const auto taken = camera->take(site.scene, shot, nullptr);
    if (first) {
      EXPECT_TRUE(same_bytes(*first, *taken.picture)) << threads;
    }
    first = taken.picture;
  }
  const auto camera = make_depth_camera(parameters, 1, "depth");
  CameraShot cut = shot;
  cut.command.region = {8, 12, 40, 20};
  CameraTruth truth;
  const auto part = camera->take(site.scene, cut, &truth).picture;
  EXPECT_EQ(truth.width, 40);
  for (std::size_t i = 0; i < 3; ++i) {
    for (int y = 0; y < 20; ++y) {
      for (int x = 0; x < 40; ++x) {
        ASSERT_EQ(number_at(part->parts[i], x, y), number_at(first->parts[i], x + 8, y + 12));
      }
    }
  }
}

TEST(DepthCamera, RefusesShotsThatDoNotFit) {
  Wall wall(4.0);
  const auto camera = make_depth_camera(small_depth(), 1, "depth");
  CameraShot shot = depth_shot(night());
  EXPECT_EQ(refused(*camera, wall.scene, shot), "");
  shot.command.disparity = true;
  EXPECT_EQ(refused(*camera, wall.scene, shot),
            "depth camera: parts: found disparity, allowed intensity, range, confidence");
  shot = depth_shot(night());
  shot.command.binning_vertical = 2;
  EXPECT_NE(refused(*camera, wall.scene, shot), "");
}

}  // namespace
}  // namespace rigwire::sim
