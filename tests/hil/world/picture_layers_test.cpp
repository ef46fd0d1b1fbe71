#include "hil/world/picture_layers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace rigwire::hil {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::array<std::uint8_t, 3> pixel(const Image& image, std::size_t column, std::size_t row) {
  return {static_cast<std::uint8_t>(image.sample(column, row, 0)),
          static_cast<std::uint8_t>(image.sample(column, row, 1)),
          static_cast<std::uint8_t>(image.sample(column, row, 2))};
}

/// With one part of that component and these bytes.
KeptPicture kept_with(PictureComponent component, PixelFormat format, int width, int height,
                      std::vector<std::uint8_t> bytes, std::uint8_t source = 0) {
  auto picture = std::make_shared<Picture>();
  PicturePart& part = picture->parts.emplace_back();
  part.component = component;
  part.source = source;
  part.format = format;
  part.region = {0, 0, width, height};
  part.bytes = std::move(bytes);
  KeptPicture kept;
  kept.picture = std::move(picture);
  return kept;
}

TEST(PictureLayers, RawIsWhatLeftTheCamera) {
  const Image eight =
      layer_image(kept_with(PictureComponent::intensity, PixelFormat::bayer_rg8, 2, 1, {7, 250}),
                  PictureLayer::image, true);
  EXPECT_EQ(eight.bits, 8);
  EXPECT_THAT(eight.samples, ElementsAre(7, 250));
  // Two bytes each, the least significant first.
  const Image twelve = layer_image(
      kept_with(PictureComponent::intensity, PixelFormat::mono12, 2, 1, {0x34, 0x02, 0xFF, 0x0F}),
      PictureLayer::image, true);
  EXPECT_EQ(twelve.bits, 16);
  EXPECT_THAT(twelve.samples, ElementsAre(0x234, 0xFFF));
}

TEST(PictureLayers, LightIsEncodedForAScreen) {
  const Image shown =
      layer_image(kept_with(PictureComponent::intensity, PixelFormat::mono8, 3, 1, {0, 55, 255}),
                  PictureLayer::image, false);
  // IEC 61966-2-1: 55 / 255 of the light is 0.5016 of the way.
  EXPECT_THAT(shown.samples, ElementsAre(0, 128, 255));
}

TEST(PictureLayers, MosaicsKeepTheirColours) {
  // Light that only the red filter passes, RGGB.
  std::vector<std::uint8_t> bytes;
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 6; ++x) {
      bytes.push_back(x % 2 == 0 && y % 2 == 0 ? 255 : 0);
    }
  }
  const Image shown =
      layer_image(kept_with(PictureComponent::intensity, PixelFormat::bayer_rg8, 6, 6, bytes),
                  PictureLayer::image, false);
  for (std::size_t row = 0; row < 6; ++row) {
    for (std::size_t column = 0; column < 6; ++column) {
      EXPECT_EQ(pixel(shown, column, row), (std::array<std::uint8_t, 3>{255, 0, 0}))
          << column << ", " << row;
    }
  }
}

TEST(PictureLayers, DisparityAndTruthHaveTheSameColours) {
  // 500 px * 0.2 m: 10 m at 10 pixels, which are 160 sixteenths.
  KeptPicture kept =
      kept_with(PictureComponent::disparity, PixelFormat::coord3d_c16, 2, 1, {160, 0, 0, 0});
  kept.geometry = {.focal_length_px = 500.0, .baseline_m = 0.2, .coding = {1.0 / 16.0, 0.0, 0}};
  kept.truth.width = 2;
  kept.truth.height = 1;
  kept.truth.depth_m = {10.0F, 0.0F};
  kept.truth.range_m = {10.0F, 0.0F};
  kept.truth.instance = {0, ~0U};
  const Image disparity = layer_image(kept, PictureLayer::disparity, false);
  const Image depth = layer_image(kept, PictureLayer::depth, false);
  EXPECT_EQ(disparity.samples, depth.samples);
  EXPECT_EQ(pixel(depth, 0, 0), distance_colour(10.0));
  EXPECT_EQ(pixel(depth, 1, 0), (std::array<std::uint8_t, 3>{}));
  EXPECT_THAT(layer_image(kept, PictureLayer::disparity, true).samples, ElementsAre(160, 0));
}

TEST(PictureLayers, NearIsRedAndFarIsBlue) {
  EXPECT_GT(distance_colour(1.0)[0], distance_colour(1.0)[2]);
  EXPECT_LT(distance_colour(100.0)[0], distance_colour(100.0)[2]);
  EXPECT_EQ(distance_colour(0.2), distance_colour(1.0));
  EXPECT_EQ(distance_colour(1e9), distance_colour(100.0));
  EXPECT_EQ(distance_colour(0.0), (std::array<std::uint8_t, 3>{}));
}

TEST(PictureLayers, DepthIsMillimetresUpToTheLastNumber) {
  KeptPicture kept = kept_with(PictureComponent::intensity, PixelFormat::mono8, 4, 1, {1, 2, 3, 4});
  kept.truth.width = 4;
  kept.truth.height = 1;
  kept.truth.depth_m = {1.2344F, 65.534F, 70.0F, 0.0F};
  kept.truth.range_m = kept.truth.depth_m;
  kept.truth.instance = {0, 0, 0, ~0U};
  const Image depth = layer_image(kept, PictureLayer::depth, true);
  EXPECT_EQ(depth.bits, 16);
  EXPECT_THAT(depth.samples, ElementsAre(1234, 65534, 65535, 0));
}

TEST(PictureLayers, LabelsAreNumberedByNameAndKeepTheirColours) {
  KeptPicture kept = kept_with(PictureComponent::intensity, PixelFormat::mono8, 4, 1, {1, 2, 3, 4});
  kept.truth.width = 4;
  kept.truth.height = 1;
  kept.truth.range_m.resize(4);
  kept.truth.depth_m.resize(4);
  kept.truth.instance = {5, 2, 5, ~0U};
  kept.labels = {"", "", "rock", "", "", "bucket"};
  const std::vector<LabelShare> shares = label_shares(kept);
  ASSERT_EQ(shares.size(), 2U);
  EXPECT_EQ(shares[0].label, "bucket");
  EXPECT_EQ(shares[0].pixels, 2U);
  EXPECT_EQ(shares[1].label, "rock");
  EXPECT_NE(shares[0].colour, shares[1].colour);
  EXPECT_THAT(layer_image(kept, PictureLayer::labels, true).samples, ElementsAre(1, 2, 1, 0));
  const Image colours = layer_image(kept, PictureLayer::labels, false);
  EXPECT_EQ(pixel(colours, 0, 0), shares[0].colour);
  EXPECT_EQ(pixel(colours, 1, 0), shares[1].colour);
  EXPECT_EQ(pixel(colours, 3, 0), (std::array<std::uint8_t, 3>{}));
  // Another picture, in which rocks have another number.
  kept.truth.instance = {2, 2, 2, 2};
  EXPECT_EQ(pixel(layer_image(kept, PictureLayer::labels, false), 0, 0), shares[1].colour);
}

TEST(PictureLayers, RefusesLayersThatThereAreNot) {
  const KeptPicture kept = kept_with(PictureComponent::intensity, PixelFormat::mono8, 2, 1, {1, 2});
  EXPECT_THAT(layers_of(kept), ElementsAre("image"));
  try {
    (void)layer_image(kept, PictureLayer::disparity, false);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("found \"disparity\", allowed of this camera image"));
  }
  EXPECT_THROW((void)layer_image(kept, PictureLayer::depth, true), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::hil
