#include "sim/camera/stereo_camera.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <future>

#include "shot_site.h"

namespace rigwire::sim {
namespace {

using namespace camera_test;

/// 320 x 240 pixels, 80 degrees across.
StereoCameraParameters small_stereo(MatchingMethod method = MatchingMethod::census) {
  StereoCameraParameters p;
  p.camera.sensor.width_px = 320;
  p.camera.sensor.height_px = 240;
  p.camera.lens.focal_length_m = 190.0 * p.camera.sensor.pixel_pitch_m;
  p.camera.lens.vignetting = 0.0;
  p.baseline_m = 0.25;
  p.matching.method = method;
  p.matching.disparities = 32;
  return p;
}

const Eigen::Isometry3d kPlace = at(0.0, 0.0, 1.5, 0.0, 0.15);

CameraShot stereo_shot(const Daylight& light) {
  CameraShot shot = shot_for(320, 240, kPlace, light);
  shot.command.intensity_right = true;
  shot.command.disparity = true;
  shot.command.confidence = true;
  shot.exposure = 150us;
  return shot;
}

double coordinate_at(const PicturePart& part, const ReportedGeometry& geometry, int x, int y) {
  return geometry.coding.offset + geometry.coding.scale * number_at(part, x, y);
}

/// Disparities against f B / Z of the true depth, of pixels that the search can find.
struct Errors {
  double density = 0.0;
  double bad1 = 0.0;
  double median_px = 0.0;
  double bad1_of_sure = 0.0;    ///< Among the confidences above 200.
  double bad1_of_unsure = 0.0;  ///< Among those up to 200.
};
Errors errors_of(const Picture& picture, const CameraTruth& truth,
                 const StereoCameraParameters& parameters) {
  const ReportedGeometry geometry = stereo_geometry(parameters);
  const PicturePart& disparity = part_of(picture, PictureComponent::disparity);
  const PicturePart& confidence = part_of(picture, PictureComponent::confidence);
  std::vector<double> errors;
  std::array<double, 2> bad{};
  std::array<double, 2> count{};
  int pixels = 0;
  for (int y = 0; y < truth.height; ++y) {
    for (int x = parameters.matching.disparities; x < truth.width; ++x) {
      const double depth_m = truth_at(truth.depth_m, truth, x, y);
      const double expected = geometry.focal_length_px * geometry.baseline_m / depth_m;
      if (depth_m <= 0.0 || expected >= parameters.matching.disparities - 1) {
        continue;
      }
      ++pixels;
      if (number_at(disparity, x, y) == geometry.coding.invalid) {
        continue;
      }
      const double error = std::abs(coordinate_at(disparity, geometry, x, y) - expected);
      errors.push_back(error);
      const std::size_t sure = number_at(confidence, x, y) > 200 ? 1 : 0;
      count[sure] += 1.0;
      bad[sure] += error > 1.0 ? 1.0 : 0.0;
    }
  }
  std::ranges::nth_element(errors, errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2));
  const auto n = static_cast<double>(errors.size());
  return {n / pixels, (bad[0] + bad[1]) / n, errors[errors.size() / 2],
          bad[1] / std::max(count[1], 1.0), bad[0] / std::max(count[0], 1.0)};
}

TEST(StereoCamera, MatchingFindsTheTrueDisparity) {
  StonySite site;
  const Daylight light({}, sun_at(45.0, 250.0));
  const StereoCameraParameters parameters = small_stereo();
  const auto camera = make_stereo_camera(parameters, 1, "stereo");
  CameraTruth truth;
  const auto taken = camera->take(site.scene, stereo_shot(light), &truth);
  const Errors errors = errors_of(*taken.picture, truth, parameters);
  EXPECT_GT(errors.density, 0.85);
  EXPECT_LT(errors.bad1, 0.08);
  EXPECT_LT(errors.median_px, 0.25);
  // It is matched, not made from the truth.
  EXPECT_GT(errors.median_px, 0.02);
  EXPECT_GT(errors.bad1, 0.001);
  // Where both directions disagree more is wrong.
  EXPECT_GT(errors.bad1_of_unsure, 3.0 * errors.bad1_of_sure);
}

TEST(StereoCamera, TruthIsHalfAStepFromFBOverZ) {
  StonySite site;
  const Daylight light({}, sun_at(45.0, 250.0));
  const StereoCameraParameters parameters = small_stereo(MatchingMethod::truth);
  const auto camera = make_stereo_camera(parameters, 1, "stereo");
  const ReportedGeometry geometry = stereo_geometry(parameters);
  CameraTruth truth;
  const auto taken = camera->take(site.scene, stereo_shot(light), &truth);
  const PicturePart& disparity = part_of(*taken.picture, PictureComponent::disparity);
  int found = 0;
  int hidden = 0;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      const double depth_m = truth_at(truth.depth_m, truth, x, y);
      if (number_at(disparity, x, y) == 0) {
        hidden += depth_m > 0.0 && x > 32 ? 1 : 0;
        continue;
      }
      ++found;
      ASSERT_NEAR(coordinate_at(disparity, geometry, x, y),
                  geometry.focal_length_px * geometry.baseline_m / depth_m, 0.5 / 16.0 + 1e-4);
    }
  }
  EXPECT_GT(found, 40000);
  // Left of each rock lies ground that the right head does not see.
  EXPECT_GT(hidden, 100);
}

TEST(StereoCamera, HiddenGroundHasNoTrueDisparity) {
  // A board before a wall: of the wall the right head sees everything but a strip as wide as the
  // difference of both disparities, left of the board.
  Scene scene;
  const auto wall = scene.add_mesh(make_box("wall", {0.1, 40.0, 40.0}));
  scene.add_object(wall, at(8.05, 0.0, 0.0), 1.0, surface("rock"));
  const auto board = scene.add_mesh(make_box("board", {0.02, 1.0, 40.0}));
  scene.add_object(board, at(3.01, 0.0, 0.0), 1.0, surface("rock"));
  ready(scene);
  const Daylight light({}, sun_at(45.0, 250.0));
  const StereoCameraParameters parameters = small_stereo(MatchingMethod::truth);
  const auto camera = make_stereo_camera(parameters, 1, "stereo");
  CameraShot shot = stereo_shot(light);
  shot.poses = poses(at(0.0, 0.0, 0.0), kStart, kStart + 100ms);
  const auto taken = camera->take(scene, shot, nullptr);
  const PicturePart& disparity = part_of(*taken.picture, PictureComponent::disparity);
  const double wide = 190.0 * 0.25 * (1.0 / 3.0 - 1.0 / 8.0);
  for (int y = 0; y < 240; y += 17) {
    int none = 0;
    for (int x = 40; x < 320; ++x) {
      none += number_at(disparity, x, y) == 0 ? 1 : 0;
    }
    EXPECT_NEAR(none, wide, 1.5) << y;
  }
}

TEST(StereoCamera, PartsAreThoseThatWereAskedFor) {
  StonySite site;
  const Daylight light({}, sun_at(45.0, 250.0));
  const auto camera = make_stereo_camera(small_stereo(), 1, "stereo");
  const CameraShot all = stereo_shot(light);
  const auto whole = camera->take(site.scene, all, nullptr);
  ASSERT_EQ(whole.picture->parts.size(), 4U);
  EXPECT_EQ(whole.picture->parts[0].component, PictureComponent::intensity);
  EXPECT_EQ(whole.picture->parts[1].source, 1);
  EXPECT_EQ(whole.picture->parts[2].component, PictureComponent::disparity);
  EXPECT_EQ(whole.picture->parts[2].format, PixelFormat::coord3d_c16);
  EXPECT_EQ(whole.picture->parts[3].component, PictureComponent::confidence);
  EXPECT_NE(whole.picture->parts[0].bytes, whole.picture->parts[1].bytes);
  // One part alone is the same one, whatever else was asked for.
  for (int i = 0; i < 4; ++i) {
    CameraShot one = all;
    one.command.intensity = i == 0;
    one.command.intensity_right = i == 1;
    one.command.disparity = i == 2;
    one.command.confidence = i == 3;
    const auto taken = camera->take(site.scene, one, nullptr);
    ASSERT_EQ(taken.picture->parts.size(), 1U);
    EXPECT_EQ(taken.picture->parts[0].bytes,
              whole.picture->parts[static_cast<std::size_t>(i)].bytes)
        << i;
  }
  // A region is cut out of it.
  CameraShot part = all;
  part.command.region = {40, 100, 64, 32};
  CameraTruth truth;
  const auto taken = camera->take(site.scene, part, &truth);
  EXPECT_EQ(truth.width, 64);
  EXPECT_EQ(truth.height, 32);
  for (std::size_t i = 0; i < 4; ++i) {
    const PicturePart& cut = taken.picture->parts[i];
    ASSERT_EQ(cut.bytes.size(), 64U * 32U * bytes_per_pixel(cut.format));
    for (int y = 0; y < 32; ++y) {
      for (int x = 0; x < 64; ++x) {
        ASSERT_EQ(number_at(cut, x, y), number_at(whole.picture->parts[i], x + 40, y + 100));
      }
    }
  }
}

TEST(StereoCamera, ThreadsDoNotChangeIt) {
  StonySite site;
  const Daylight light({}, sun_at(45.0, 250.0));
  for (const MatchingPaths paths : {MatchingPaths::three, MatchingPaths::five}) {
    StereoCameraParameters parameters = small_stereo();
    parameters.matching.paths = paths;
    parameters.camera.lens.k1 = -0.1;
    std::shared_ptr<const Picture> first;
    for (const int threads : {1, 2, 3}) {
      parameters.camera.threads = threads;
      const auto camera = make_stereo_camera(parameters, 1, "stereo");
      const auto taken = camera->take(site.scene, stereo_shot(light), nullptr);
      if (first) {
        EXPECT_TRUE(same_bytes(*first, *taken.picture)) << threads;
      }
      first = taken.picture;
    }
  }
}

TEST(StereoCamera, TwoAtOnceDoNotDisturbEachOther) {
  StonySite site;
  const Daylight light({}, sun_at(45.0, 250.0));
  const auto picture_of = [&](std::uint64_t seed) {
    return make_stereo_camera(small_stereo(), seed, "stereo")
        ->take(site.scene, stereo_shot(light), nullptr)
        .picture;
  };
  const auto alone = picture_of(1);
  auto other = std::async(std::launch::async, [&] { return picture_of(2); });
  const auto together = picture_of(1);
  EXPECT_FALSE(same_bytes(*alone, *other.get()));  // another seed, other noise
  EXPECT_TRUE(same_bytes(*alone, *together));
}

TEST(StereoCamera, DistortionIsRectifiedToTheReportedGeometry) {
  StonySite site;
  const Daylight light({}, sun_at(45.0, 250.0));
  StereoCameraParameters parameters = small_stereo();
  parameters.camera.lens.k1 = -0.08;
  parameters.camera.lens.p1 = 0.001;
  parameters.camera.lens.principal_offset_px = {4.0, -3.0};
  const auto camera = make_stereo_camera(parameters, 1, "stereo");
  CameraTruth truth;
  const auto taken = camera->take(site.scene, stereo_shot(light), &truth);
  // Straight through the lens's own model the truth would be pixels off at the edges.
  const ReportedGeometry g = stereo_geometry(parameters);
  for (const auto& [x, y] : {std::pair{60, 200}, {160, 180}, {300, 230}}) {
    const Eigen::Vector3d ray =
        lens_to_mount(Eigen::Vector3d((x - g.principal_u_px) / g.focal_length_px,
                                      (y - g.principal_v_px) / g.focal_length_px, 1.0));
    const auto hit = site.scene.cast(kPlace.translation(), kPlace.linear() * ray.normalized(), 0.05,
                                     100.0, kStart);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(truth_at(truth.range_m, truth, x, y), hit->range_m, 1e-3 * hit->range_m);
  }
  const Errors errors = errors_of(*taken.picture, truth, parameters);
  EXPECT_LT(errors.median_px, 0.3);
  EXPECT_LT(errors.bad1, 0.10);
}

TEST(StereoCamera, AHeadThatHasTurnedShiftsWhatItSees) {
  // 0.2 degrees of yaw that nobody knows: f tan(0.2 deg) pixels more or less of disparity.
  StonySite site;
  const Daylight light({}, sun_at(45.0, 250.0));
  StereoCameraParameters parameters = small_stereo();
  const auto disparity_of = [&] {
    return make_stereo_camera(parameters, 1, "stereo")
        ->take(site.scene, stereo_shot(light), nullptr)
        .picture;
  };
  const auto straight = disparity_of();
  parameters.misalignment_rad.z() = 0.2 * kDegree;
  const auto turned = disparity_of();
  double sum_px = 0.0;
  int count = 0;
  for (int y = 120; y < 240; ++y) {
    for (int x = 120; x < 200; ++x) {
      const int before = number_at(part_of(*straight, PictureComponent::disparity), x, y);
      const int after = number_at(part_of(*turned, PictureComponent::disparity), x, y);
      if (before != 0 && after != 0 && std::abs(after - before) < 2 * 16) {
        sum_px += (after - before) / 16.0;
        ++count;
      }
    }
  }
  EXPECT_GT(count, 5000);
  // Turned left the right head sees everything farther right.
  EXPECT_NEAR(sum_px / count, -190.0 * std::tan(0.2 * kDegree), 0.1);
}

TEST(StereoCamera, RefusesShotsThatDoNotFit) {
  StonySite site;
  const Daylight light({}, sun_at(45.0, 250.0));
  const auto camera = make_stereo_camera(small_stereo(), 1, "stereo");
  const CameraShot good = stereo_shot(light);
  EXPECT_EQ(refused(*camera, site.scene, good), "");
  CameraShot shot = good;
  shot.command.range = true;
  EXPECT_EQ(refused(*camera, site.scene, shot),
            "stereo camera: parts: found range, allowed intensity, right intensity, disparity, "
            "confidence");
  shot = good;
  shot.command.binning_horizontal = 2;
  EXPECT_EQ(refused(*camera, site.scene, shot),
            "stereo camera: binning: found 2 x 1, allowed 1 x 1");
  shot = good;
  shot.command.region.offset_x = 8;
  EXPECT_EQ(refused(*camera, site.scene, shot),
            "stereo camera: region: found 320 x 240 at 8, 0, allowed within 320 x 240");
}

}  // namespace
}  // namespace rigwire::sim
