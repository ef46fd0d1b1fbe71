// One picture of a rig's camera, without a run.
#include "hil/rig/picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <stdexcept>

#include "hil/command_line/config_files.h"
#include "hil/rig/rig_configuration.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

/// The Unimog's rig, its camera grey and of 160 x 120 pixels.
RigConfiguration unimog() {
  return load_rig(find_rig("unimog_vision"),
                  {"devices.front_camera.sensor.image_sensor={width: 160, height: 120}"})
      .configuration;
}

/// The excavator's, its stereo camera likewise.
RigConfiguration excavator() {
  return load_rig(find_rig("excavator_vision"),
                  {"devices.stereo.sensor.image_sensor={width: 160, height: 120}",
                   "devices.stereo.sensor.matching.disparities=32"})
      .configuration;
}

std::string refusal(const RigConfiguration& rig, const PictureRequest& request) {
  try {
    (void)take_picture(rig, request);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(PictureOfARig, IsTheSameTwice) {
  const RigConfiguration rig = unimog();
  const PictureRequest request{.device = "front_camera", .at = kStart + 303ms};
  const TakenPicture one = take_picture(rig, request);
  const TakenPicture two = take_picture(rig, request);
  EXPECT_EQ(one.device, "front_camera");
  ASSERT_EQ(one.kept.picture->parts.size(), 1U);
  EXPECT_EQ(one.kept.picture->parts[0].bytes, two.kept.picture->parts[0].bytes);
  EXPECT_EQ(one.kept.truth.depth_m, two.kept.truth.depth_m);
  // The exposure begins when it was asked for, which is no multiple of the camera's period.
  EXPECT_EQ(one.kept.picture->exposure_start, request.at);
  EXPECT_THAT(layers_of(one.kept), ElementsAre("image", "depth", "labels"));
  std::vector<std::string> labels;
  for (const LabelShare& share : label_shares(one.kept)) {
    labels.push_back(share.label);
  }
  EXPECT_THAT(labels, Contains("ground"));
}

TEST(PictureOfARig, HasEveryPartOfItsKind) {
  const TakenPicture taken = take_picture(excavator(), {.device = "stereo", .at = kStart + 20ms});
  EXPECT_THAT(layers_of(taken.kept),
              ElementsAre("image", "right", "disparity", "confidence", "depth", "labels"));
  // What was matched agrees with the truth within a tenth of it, for most of the pixels that are
  // there.
  const Image disparity = layer_image(taken.kept, PictureLayer::disparity, true);
  ASSERT_TRUE(taken.kept.geometry.has_value());
  const auto& geometry = *taken.kept.geometry;
  std::size_t there = 0;
  std::size_t near = 0;
  for (std::size_t i = 0; i < disparity.samples.size(); ++i) {
    if (disparity.samples[i] == geometry.coding.invalid || taken.kept.truth.depth_m[i] == 0.0F) {
      continue;
    }
    const double pixels = geometry.coding.offset + geometry.coding.scale * disparity.samples[i];
    const double depth_m = geometry.focal_length_px * geometry.baseline_m / pixels;
    ++there;
    near += std::abs(depth_m / static_cast<double>(taken.kept.truth.depth_m[i]) - 1.0) < 0.1;
  }
  EXPECT_GT(there, 1000U);
  EXPECT_GT(static_cast<double>(near), 0.7 * static_cast<double>(there));
}

TEST(PictureOfARig, AutomaticExposureHasSettled) {
  const RigConfiguration rig = unimog();
  const auto mean = [&](Duration at) {
    const TakenPicture taken = take_picture(rig, {.device = "front_camera", .at = kStart + at});
    double sum = 0.0;
    for (const std::uint8_t number : taken.kept.picture->parts[0].bytes) {
      sum += number;
    }
    return sum / (255.0 * 160.0 * 120.0);
  };
  EXPECT_NEAR(mean(1500ms), sim::AutoExposureParameters{}.target, 0.05);
}

TEST(PictureOfARig, ShowsAMachineThatDrives) {
  const RigConfiguration rig = unimog();
  const auto ahead_m = [&](std::optional<double> travel_mps) {
    return take_picture(rig,
                        {.device = "front_camera", .at = kStart + 3s, .travel_mps = travel_mps})
        .kept.truth.depth_m;
  };
  const std::vector<float> standing = ahead_m(std::nullopt);
  const std::vector<float> driving = ahead_m(5.0);
  EXPECT_NE(standing, driving);
  EXPECT_THAT(refusal(excavator(), {.device = "stereo", .travel_mps = 1.0}),
              HasSubstr("allowed for machines that drive"));
}

TEST(PictureOfARig, NamesTheCamerasThatThereAre) {
  const RigConfiguration rig = excavator();
  EXPECT_THAT(refusal(rig, {.device = "gnss"}),
              HasSubstr("found \"gnss\", allowed stereo, surround"));
  EXPECT_THAT(refusal(rig, {}), HasSubstr("found 2 of them, allowed stereo, surround"));
  const RigConfiguration none = load_rig(find_rig("excavator_pit"), {}).configuration;
  EXPECT_THAT(refusal(none, {}), HasSubstr("no camera"));
}

}  // namespace
}  // namespace rigwire::hil
