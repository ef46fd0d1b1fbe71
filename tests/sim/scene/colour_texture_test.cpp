#include "sim/scene/colour_texture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "sim/random.h"

namespace rigwire::sim {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr auto kRepeats = TextureEdge::repeats;

Texel grey(std::uint16_t value, std::uint16_t counts = 65535) {
  return {value, value, value, counts};
}

ColourTexture row(std::vector<Texel> texels) {
  const std::size_t columns = texels.size();
  return {"row", columns, 1, std::move(texels)};
}

float seen(const ColourTexture& texture, float u, float v = 0.5F,
           const TextureFootprint& footprint = {}, TextureEdge edge = kRepeats) {
  return texture.mean(u, v, footprint, edge, edge)[0] * 65535.0F;
}

TEST(ColourTexture, LinearOfSrgbIsTheStandards) {
  EXPECT_EQ(linear_of_srgb(0.0), 0.0);
  EXPECT_EQ(linear_of_srgb(1.0), 1.0);
  EXPECT_DOUBLE_EQ(linear_of_srgb(0.04), 0.04 / 12.92);
  EXPECT_NEAR(linear_of_srgb(0.5), 0.21404, 5e-6);
  EXPECT_NEAR(linear_of_srgb(0.0404499999), linear_of_srgb(0.0404500001), 1e-7);
}

TEST(ColourTexture, TexelsHaveTheirCentresAndStraightLinesBetween) {
  const ColourTexture texture = row({grey(1000), grey(3000), grey(9000), grey(5000)});
  EXPECT_FLOAT_EQ(seen(texture, 0.125F), 1000.0F);
  EXPECT_FLOAT_EQ(seen(texture, 0.375F), 3000.0F);
  EXPECT_FLOAT_EQ(seen(texture, 0.25F), 2000.0F);
  EXPECT_FLOAT_EQ(seen(texture, 0.4375F), 4500.0F);
}

TEST(ColourTexture, EdgesRepeatMirrorOrStay) {
  const ColourTexture texture = row({grey(1000), grey(3000), grey(9000), grey(5000)});
  for (const float whole : {-2000.0F, -3.0F, 1.0F, 2000.0F}) {
    EXPECT_NEAR(seen(texture, whole + 0.375F), 3000.0F, 1.0F) << whole;
  }
  EXPECT_FLOAT_EQ(seen(texture, 0.0F), 3000.0F) << "between the last and the first";
  const auto mirrored = [&](float u) { return seen(texture, u, 0.5F, {}, TextureEdge::mirrors); };
  EXPECT_FLOAT_EQ(mirrored(1.0F), 5000.0F);
  EXPECT_FLOAT_EQ(mirrored(1.625F), 3000.0F);
  EXPECT_FLOAT_EQ(mirrored(-0.375F), 3000.0F);
  EXPECT_FLOAT_EQ(mirrored(2.375F), 3000.0F);
  const auto staying = [&](float u) { return seen(texture, u, 0.5F, {}, TextureEdge::stays); };
  EXPECT_FLOAT_EQ(staying(-7.0F), 1000.0F);
  EXPECT_FLOAT_EQ(staying(0.0F), 1000.0F);
  EXPECT_FLOAT_EQ(staying(1.0F), 5000.0F);
  EXPECT_FLOAT_EQ(staying(1e20F), 5000.0F);
}

TEST(ColourTexture, MeanIsKeptDownToOneTexelWhateverTheSides) {
  RandomStream random(3, "texels");
  for (const auto& [columns, rows] : {std::pair{64, 64}, {37, 5}, {1, 9}, {3, 1}, {101, 31}}) {
    std::vector<Texel> texels;
    double sum = 0.0;
    for (int i = 0; i < columns * rows; ++i) {
      texels.push_back(grey(static_cast<std::uint16_t>(random.uniform(0.0, 50000.0))));
      sum += texels.back()[0];
    }
    const ColourTexture texture("noise", static_cast<std::size_t>(columns),
                                static_cast<std::size_t>(rows), texels);
    const float sides = static_cast<float>(columns) / static_cast<float>(rows);
    for (const float at : {0.1F, 0.5F, 0.77F}) {
      EXPECT_NEAR(seen(texture, at, at, {16.0F, 0.0F, 0.0F, 16.0F * sides}), sum / (columns * rows),
                  4.0)
          << columns << " x " << rows;
    }
  }
}

TEST(ColourTexture, SlantIsAveragedAlongAndStaysSharpAcross) {
  // Stripes of one texel along u, alike along v.
  std::vector<Texel> texels;
  for (int i = 0; i < 64 * 64; ++i) {
    texels.push_back(grey(i % 2 == 0 ? 0 : 50000));
  }
  const ColourTexture stripes("stripes", 64, 64, texels);
  const float texel = 1.0F / 64.0F;
  // Along the stripes twelve texels long, across them one wide.
  const TextureFootprint along{texel, 0.0F, 0.0F, 12.0F * texel};
  EXPECT_FLOAT_EQ(seen(stripes, 0.5F * texel, 0.3F, along), 0.0F);
  EXPECT_FLOAT_EQ(seen(stripes, 1.5F * texel, 0.3F, along), 50000.0F);
  // Over twelve stripes the mean is seen, whichever axis is the longer one.
  const TextureFootprint over{0.0F, texel, 12.0F * texel, 0.0F};
  const TextureFootprint turned{12.0F * texel, 0.0F, 0.0F, texel};
  for (int i = 0; i < 20; ++i) {
    const float u = 0.3F + 0.13F * texel * static_cast<float>(i);
    EXPECT_NEAR(seen(stripes, u, 0.3F, over), 25000.0F, 10.0F) << i;
    EXPECT_NEAR(seen(stripes, u, 0.3F, turned), 25000.0F, 10.0F) << i;
  }
}

TEST(ColourTexture, HolesTakeTheColourAroundThem) {
  const ColourTexture texture = row({grey(9000), grey(0, 0), grey(0, 0), grey(9000)});
  for (int i = 0; i < 40; ++i) {
    EXPECT_FLOAT_EQ(seen(texture, 0.025F * static_cast<float>(i)), 9000.0F) << i;
  }
  const ColourTexture clear = row({grey(400, 0), grey(600, 0)});
  EXPECT_FLOAT_EQ(seen(clear, 0.5F, 0.5F, {1.0F, 0.0F, 0.0F, 1.0F}), 500.0F);
}

TEST(ColourTexture, WhitePaintIsNoWhiterNearOrFar) {
  const ColourTexture texture = row({grey(65535), grey(0)});
  EXPECT_NEAR(seen(texture, 0.25F), 0.9F * 65535.0F, 1.0F);
  EXPECT_NEAR(seen(texture, 0.25F, 0.5F, {1.0F, 0.0F, 0.0F, 1.0F}), 0.45F * 65535.0F, 1.0F);
}

TEST(ColourTexture, AnythingMayBeAskedOf) {
  const ColourTexture texture = row({grey(100), grey(200), grey(300)});
  constexpr float kHuge = std::numeric_limits<float>::max();
  constexpr float kNot = std::numeric_limits<float>::quiet_NaN();
  for (const auto edge : {kRepeats, TextureEdge::mirrors, TextureEdge::stays}) {
    for (const float far : {-kHuge, -1e9F, 0.0F, 1e9F, kHuge}) {
      for (const float wide : {0.0F, 1.0F, 1e9F, kHuge, kNot}) {
        const float value = seen(texture, far, far, {wide, wide, -wide, wide}, edge);
        EXPECT_GE(value, 99.9F);
        EXPECT_LE(value, 300.1F);
      }
    }
  }
}

TEST(ColourTexture, SizesAreBoundedAndSaid) {
  EXPECT_THAT([] { return ColourTexture("none", 0, 4, {}); },
              ThrowsMessage<std::invalid_argument>(
                  AllOf(HasSubstr("'none'"), HasSubstr("0 x 4"), HasSubstr("1 to 8192"))));
  EXPECT_THAT([] { return ColourTexture("long", 8193, 1, std::vector<Texel>(8193)); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("8193 x 1")));
  EXPECT_THAT([] { return ColourTexture("short", 2, 2, std::vector<Texel>(3)); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("3 pixels for 4")));
}

TEST(ColourTexture, TakesAThirdMoreThanItsTexels) {
  const ColourTexture texture("square", 256, 256, std::vector<Texel>(256 * 256));
  EXPECT_NEAR(static_cast<double>(texture.memory_bytes()), 256.0 * 256.0 * 8.0 * 4.0 / 3.0, 8.0);
}

}  // namespace
}  // namespace rigwire::sim
