// One picture of a rig's camera, without a run.
#include "hil/rig/picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>

#include "hil/command_line/config_files.h"
#include "hil/rig/rig_configuration.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

/// A shipped rig, its camera of 160 x 120 pixels.
RigConfiguration rig_with(const std::string& name, std::vector<std::string> sets = {}) {
  const std::string sensor = "devices.front_camera.sensor.image_sensor.";
  sets.push_back(sensor + "width=160");
  sets.push_back(sensor + "height=120");
  return load_rig(find_rig(name), sets).configuration;
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
  const RigConfiguration rig = rig_with("excavator_vision");
  const PictureRequest request{.at = kStart + 303ms};
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

TEST(PictureOfARig, AutomaticExposureHasSettled) {
  const RigConfiguration rig = rig_with("excavator_vision");
  const auto mean = [&](Duration at) {
    const TakenPicture taken = take_picture(rig, {.at = kStart + at});
    double sum = 0.0;
    for (const std::uint8_t number : taken.kept.picture->parts[0].bytes) {
      sum += number;
    }
    return sum / (255.0 * 160.0 * 120.0);
  };
  EXPECT_NEAR(mean(1500ms), sim::AutoExposureParameters{}.target, 0.05);
}

TEST(PictureOfARig, ShowsAMachineThatDrives) {
  const RigConfiguration rig = rig_with("unimog_vision");
  const auto ahead_m = [&](std::optional<double> travel_mps) {
    return take_picture(rig, {.at = kStart + 3s, .travel_mps = travel_mps}).kept.truth.depth_m;
  };
  const std::vector<float> standing = ahead_m(std::nullopt);
  const std::vector<float> driving = ahead_m(5.0);
  EXPECT_NE(standing, driving);
  EXPECT_THAT(refusal(rig_with("excavator_vision"), {.travel_mps = 1.0}),
              HasSubstr("allowed for machines that drive"));
}

TEST(PictureOfARig, NamesTheCamerasThatThereAre) {
  const RigConfiguration rig = rig_with("excavator_vision");
  EXPECT_THAT(refusal(rig, {.device = "gnss"}), HasSubstr("found \"gnss\", allowed front_camera"));
  const RigConfiguration none = load_rig(find_rig("excavator_pit"), {}).configuration;
  EXPECT_THAT(refusal(none, {}), HasSubstr("no camera"));
}

}  // namespace
}  // namespace rigwire::hil
