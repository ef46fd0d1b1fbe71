// Rocks in disparity pictures of known stages: where they are, how large, and what is none.
#include "find_rocks/rock_finder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "stereo_stage.h"

namespace rigwire::find_rocks {
namespace {

constexpr double kDegree = 3.14159265358979 / 180.0;

/// On level ground, a third sunk in.
Boulder boulder(double x_m, double y_m, double diameter_m) {
  return {x_m, y_m, diameter_m / 6.0, 0.5 * diameter_m};
}

std::vector<SeenRock> rocks_of(const Stage& stage, const RockSettings& settings = {}) {
  return find_rocks(stage_picture(stage), settings).rocks;
}

/// Where the camera's frame has a place of the stage: x ahead along the axis, y left, z up.
std::array<double, 3> in_camera(const Stage& stage, double x, double y, double z) {
  const double pitch = stage.pitch_deg * kDegree;
  const double up = z - stage.camera_height_m;
  return {x * std::cos(pitch) - up * std::sin(pitch), y,
          x * std::sin(pitch) + up * std::cos(pitch)};
}

TEST(FindRocks, BouldersAreWhereTheyAreAndAsLarge) {
  Stage stage;
  stage.boulders = {boulder(6.0, -1.0, 0.6), boulder(7.5, 1.5, 1.0), boulder(9.0, -0.5, 1.4)};
  const FoundRocks found = find_rocks(stage_picture(stage), {});
  EXPECT_TRUE(found.ground);
  EXPECT_NEAR(found.camera_height_m, 3.0, 0.05);
  EXPECT_NEAR(found.pitch_rad, 17.0 * kDegree, 0.01);
  ASSERT_EQ(found.rocks.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const Boulder& b = stage.boulders[i];
    const auto place = in_camera(stage, b.x_m, b.y_m, b.z_m);
    const SeenRock& rock = found.rocks[i];
    EXPECT_NEAR(rock.x_m, place[0], 0.25 + 0.02 * place[0]);
    EXPECT_NEAR(rock.y_m, place[1], 0.15);
    EXPECT_NEAR(rock.z_m, place[2], 0.3);
    EXPECT_NEAR(rock.width_m, 2.0 * b.radius_m, 0.25);
    EXPECT_NEAR(rock.height_m, b.z_m + b.radius_m, 0.2);
    EXPECT_GT(rock.contrast, 0.8);
  }
}

TEST(FindRocks, BareGroundHasNone) {
  EXPECT_THAT(rocks_of({}), testing::IsEmpty());
  Stage rough;
  rough.noise_px = 0.15;
  rough.ground = [](double x, double y) {
    return 0.03 * std::sin(5.0 * x) * std::cos(4.0 * y) + 0.02 * std::sin(9.0 * x + 7.0 * y);
  };
  EXPECT_THAT(rocks_of(rough), testing::IsEmpty());
}

TEST(FindRocks, SlopesAndWavesOfTheGroundAreNoRocks) {
  Stage stage;
  stage.ground = [](double x, double y) {
    return 0.15 * x - 0.1 * y + 0.4 * std::sin(0.6 * x) + 0.3 * std::cos(0.7 * y) - 0.3;
  };
  EXPECT_THAT(rocks_of(stage), testing::IsEmpty());
  const auto sunk = [&stage](double x, double y, double diameter) {
    return Boulder{x, y, stage.ground(x, y) + diameter / 6.0, 0.5 * diameter};
  };
  stage.boulders = {sunk(5.5, 0.5, 0.7), sunk(9.0, -1.0, 1.0)};
  EXPECT_THAT(rocks_of(stage), testing::SizeIs(2));
}

TEST(FindRocks, AHeapOfLooseMaterialIsGround) {
  Stage stage;
  stage.ground = [](double x, double y) {
    return std::max(0.0, 1.4 - std::tan(36.0 * kDegree) * std::hypot(x - 8.0, y - 0.5));
  };
  RockSettings settings;
  settings.ground.mount = CameraMount{3.0, 17.0};
  EXPECT_THAT(rocks_of(stage, settings), testing::IsEmpty());
}

TEST(FindRocks, WithItsMountKnownTheCameraIsNotTakenInByAHeapCloseAhead) {
  Stage stage;
  stage.ground = [](double x, double y) {
    return std::max(0.0, 2.4 - std::tan(36.0 * kDegree) * std::hypot(x - 6.0, 0.5 * (y + 1.0)));
  };
  const StereoPicture picture = stage_picture(stage);
  EXPECT_GT(std::abs(find_rocks(picture, {}).camera_height_m - 3.0), 0.6);
  RockSettings settings;
  settings.ground.mount = CameraMount{3.1, 16.0};
  EXPECT_NEAR(find_rocks(picture, settings).camera_height_m, 3.0, 0.5);
}

TEST(FindRocks, GroundThatRisesMoreThanTheMountPermitsIsFollowedThatFar) {
  Stage stage;
  // Most of what is seen lies on a plane that passes 4 m below the camera.
  stage.ground = [](double x, double) { return 0.26 * std::max(0.0, x - 5.5); };
  RockSettings settings;
  settings.ground.mount = CameraMount{3.0, 17.0};
  const FoundRocks found = find_rocks(stage_picture(stage), settings);
  EXPECT_TRUE(found.ground);
  EXPECT_LE(found.camera_height_m, 3.9);
}

TEST(FindRocks, WhatStandsUprightIsNoRock) {
  Stage stage;
  stage.boxes = {{{6.0, -1.5, 0.0}, {6.5, -1.0, 0.9}}, {{7.0, 1.0, 0.0}, {7.6, 1.6, 1.1}}};
  EXPECT_THAT(rocks_of(stage), testing::IsEmpty()) << "a stump and a bush";
  stage.boxes.push_back({{6.5, 0.0, 0.0}, {7.1, 0.6, 0.6}});
  EXPECT_THAT(rocks_of(stage), testing::SizeIs(1)) << "as wide as high";
}

TEST(FindRocks, WhatIsTooLargeIsNoRock) {
  Stage stage;
  stage.boxes = {{{9.0, -3.5, 0.0}, {12.0, 1.5, 2.8}}, {{6.0, 1.6, 0.0}, {6.3, 1.9, 3.5}}};
  EXPECT_THAT(rocks_of(stage), testing::IsEmpty()) << "a truck and a post";
}

TEST(FindRocks, LeastSizeHolds) {
  Stage stage;
  stage.boulders = {boulder(6.0, 0.0, 0.5)};
  RockSettings settings;
  settings.least_m = 0.4;
  EXPECT_THAT(rocks_of(stage, settings), testing::SizeIs(1));
  settings.least_m = 1.2;
  EXPECT_THAT(rocks_of(stage, settings), testing::IsEmpty());
}

TEST(FindRocks, ABoomThatHangsInTheAirIsNoRock) {
  Stage stage;
  stage.boxes = {{{4.0, -1.2, 1.2}, {7.0, -0.8, 1.7}}};
  EXPECT_THAT(rocks_of(stage), testing::IsEmpty());
}

TEST(FindRocks, ABucketOnTheGroundIsKnownByItsBox) {
  Stage stage;
  stage.boxes = {{{6.0, -1.2, 0.0}, {7.0, -0.3, 0.9}}};
  EXPECT_THAT(rocks_of(stage), testing::SizeIs(1)) << "it looks like one";
  RockSettings settings;
  settings.own_boxes = {{-1.6, 0.1, 9.0}};
  EXPECT_THAT(rocks_of(stage, settings), testing::IsEmpty());
  stage.boulders = {boulder(8.0, 1.5, 0.8)};
  EXPECT_THAT(rocks_of(stage, settings), testing::SizeIs(1)) << "beside the box";
}

TEST(FindRocks, ABucketOnTheGroundIsKnownByItsPartOfThePicture) {
  Stage stage;
  stage.boxes = {{{6.0, -1.2, 0.0}, {7.0, -0.3, 0.9}}};
  RockSettings settings;
  settings.own_areas = {{320, 200, 480, 480}};
  EXPECT_THAT(rocks_of(stage, settings), testing::IsEmpty());
}

TEST(FindRocks, ARockThatTheMatchedPartCutsIsNotMeasured) {
  Stage stage;
  // Its middle lies on the first column that has a disparity.
  const double left = (319.5 - stage.unmatched_columns) / 533.0;
  stage.boulders = {boulder(7.0, left * 7.5, 1.0)};
  EXPECT_THAT(rocks_of(stage), testing::IsEmpty());
}

TEST(FindRocks, RocksBeyondWhatNoiseLetsTellAreNotReported) {
  Stage stage;
  stage.boulders = {boulder(18.0, 0.0, 0.5)};
  EXPECT_THAT(rocks_of(stage), testing::IsEmpty());
  const RockSettings settings;
  // Two thirds of 0.4 m are the roughness and 3.5 deviations: x H s / (f B).
  const double expected = (2.0 / 3.0 * 0.4 - 0.08) * 85.28 / (3.5 * 0.18 * 3.0);
  EXPECT_NEAR(resolvable_m(settings, 85.28, 3.0), expected, 1e-9);
  RockSettings large;
  large.least_m = 1.0;
  EXPECT_NEAR(resolvable_m(large, 85.28, 3.0), 85.28 / 6.0, 1e-9);
}

TEST(FindRocks, PicturesWithoutGroundHaveNone) {
  StereoGeometry geometry = stage_geometry();
  const std::vector<std::uint8_t> nothing(2 * 640 * 480, 0);
  const FoundRocks dark = find_rocks({geometry, 640, 480, nothing}, {});
  EXPECT_FALSE(dark.ground);
  EXPECT_EQ(dark.disparities, 0.0);
  Stage wall;
  wall.boxes = {{{3.0, -50.0, -50.0}, {4.0, 50.0, 50.0}}};
  EXPECT_FALSE(find_rocks(stage_picture(wall), {}).ground);
}

TEST(FindRocks, WrongDisparitiesInAFewPixelsMakeNoRocks) {
  Stage stage;
  std::vector<std::uint8_t> pixels = stage_pixels(stage);
  std::mt19937 random(9);
  for (int i = 0; i < 3000; ++i) {  // one in a hundred, anywhere between near and far
    const std::size_t at = 2 * (random() % (640 * 480));
    pixels[at] = static_cast<std::uint8_t>(random());
    pixels[at + 1] = static_cast<std::uint8_t>(random() % 4);
  }
  EXPECT_THAT(find_rocks({stage_geometry(), 640, 480, pixels}, {}).rocks, testing::IsEmpty());
}

TEST(FindRocks, DoubtfulPixelsAreLeftOut) {
  const Stage stage;
  const std::vector<std::uint8_t> pixels = stage_pixels(stage);
  std::vector<std::uint8_t> confidence(640 * 480, 200);
  std::fill_n(confidence.begin(), 640 * 240, std::uint8_t{50});
  const StereoPicture picture(stage_geometry(), 640, 480, pixels, confidence, 128);
  EXPECT_EQ(picture.disparity_px(400, 100), StereoPicture::kNone);
  EXPECT_GT(picture.disparity_px(400, 400), 0.0F);
}

TEST(FindRocksGeometry, IsReadFromTheCamerasFeatures) {
  std::map<std::string, double, std::less<>> features{
      {"Scan3dFocalLength", 500.0},   {"Scan3dBaseline", 0.2},
      {"Scan3dPrincipalPointU", 320}, {"Scan3dPrincipalPointV", 240},
      {"Scan3dCoordinateScale", 0.5}, {"Scan3dCoordinateOffset", 1.0},
      {"Scan3dInvalidDataFlag", 1.0}, {"Scan3dInvalidDataValue", 7.0}};
  const auto ask = [&features](std::string_view name) {
    const auto found = features.find(name);
    return found == features.end() ? std::nullopt : std::optional(found->second);
  };
  const StereoGeometry geometry = StereoGeometry::read(ask);
  const std::vector<std::uint8_t> pixels{7, 0, 100, 0};
  const StereoPicture picture(geometry, 2, 1, pixels);
  EXPECT_EQ(picture.disparity_px(0, 0), StereoPicture::kNone);
  EXPECT_EQ(picture.disparity_px(1, 0), 51.0F);
  const Point point = picture.point(1, 0);
  EXPECT_NEAR(point.z, 500.0 * 0.2 / 51.0, 1e-6);
  EXPECT_NEAR(point.x, (1.0 - 320.0) / 500.0 * point.z, 1e-6);
  features.erase("Scan3dBaseline");
  try {
    (void)StereoGeometry::read(ask);
    ADD_FAILURE() << "a camera without a baseline was taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("Scan3dBaseline is missing"));
  }
  features["Scan3dBaseline"] = -0.1;
  EXPECT_THROW((void)StereoGeometry::read(ask), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::find_rocks
