#include "sim/lidar/echo_detector.h"

#include <gtest/gtest.h>

#include <vector>

namespace rigwire::sim {
namespace {

constexpr EchoRules kRules{.pulse_m = 0.75F, .separation_m = 1.0F, .threshold = 0.05F};

EchoPart part(float range_m, float energy, float patch_m = 0.0F) {
  return {range_m, energy, energy * range_m * range_m, patch_m};
}

DetectedEchoes detect(std::vector<EchoPart> parts, const EchoRules& rules = kRules) {
  return detect_echoes(parts, rules);
}

TEST(EchoDetector, NothingComesOfNothing) {
  const DetectedEchoes echoes = detect({});
  EXPECT_EQ(echoes.count, 0U);
  EXPECT_EQ(echoes.strongest.energy, 0.0F);
  EXPECT_EQ(echoes.last.energy, 0.0F);
}

TEST(EchoDetector, PartsWithinHalfAPulseMergeIntoTheirMeanByEnergy) {
  const DetectedEchoes echoes = detect({part(10.6F, 0.3F), part(10.0F, 0.9F)});
  ASSERT_EQ(echoes.count, 1U);
  EXPECT_FLOAT_EQ(echoes.strongest.range_m, 10.15F);
  EXPECT_FLOAT_EQ(echoes.strongest.energy, 1.2F);
  EXPECT_FLOAT_EQ(echoes.strongest.brightness, 0.9F * 100.0F + 0.3F * 112.36F);
  EXPECT_TRUE(echoes.last_is_strongest);
  EXPECT_EQ(echoes.second.energy, 0.0F);
}

TEST(EchoDetector, FartherApartTheyAreTwo) {
  const DetectedEchoes echoes = detect({part(12.0F, 0.3F), part(10.0F, 0.9F)});
  ASSERT_EQ(echoes.count, 2U);
  EXPECT_FLOAT_EQ(echoes.strongest.range_m, 10.0F);
  EXPECT_FLOAT_EQ(echoes.second.range_m, 12.0F);
  EXPECT_FLOAT_EQ(echoes.last.range_m, 12.0F);
  EXPECT_FALSE(echoes.last_is_strongest);
  EXPECT_TRUE(echoes.last_is_second);
}

TEST(EchoDetector, LastMayBeTheWeakestOfThree) {
  const DetectedEchoes echoes = detect({part(10.0F, 0.5F), part(20.0F, 0.9F), part(30.0F, 0.1F)});
  ASSERT_EQ(echoes.count, 3U);
  EXPECT_FLOAT_EQ(echoes.strongest.range_m, 20.0F);
  EXPECT_FLOAT_EQ(echoes.second.range_m, 10.0F);
  EXPECT_FLOAT_EQ(echoes.last.range_m, 30.0F);
  EXPECT_FALSE(echoes.last_is_strongest);
  EXPECT_FALSE(echoes.last_is_second);
}

TEST(EchoDetector, FaintPartsCountWhereTheyAddUp) {
  EXPECT_EQ(detect({part(10.0F, 0.04F), part(20.0F, 0.04F)}).count, 0U);
  const DetectedEchoes echoes = detect({part(10.0F, 0.04F), part(10.1F, 0.04F)});
  ASSERT_EQ(echoes.count, 1U);
  EXPECT_FLOAT_EQ(echoes.strongest.range_m, 10.05F);
}

TEST(EchoDetector, OfTwoThatTheReceiverCannotTellApartTheWeakerIsLost) {
  const DetectedEchoes nearer = detect({part(10.0F, 0.9F), part(10.9F, 0.3F)});
  EXPECT_EQ(nearer.count, 1U);
  EXPECT_FLOAT_EQ(nearer.last.range_m, 10.0F);
  const DetectedEchoes farther = detect({part(10.0F, 0.3F), part(10.9F, 0.9F)});
  EXPECT_EQ(farther.count, 1U);
  EXPECT_FLOAT_EQ(farther.strongest.range_m, 10.9F);
  // Not so one that is near to a lost one only.
  EXPECT_EQ(detect({part(10.0F, 0.9F), part(10.9F, 0.3F), part(11.8F, 0.2F)}).count, 2U);
}

TEST(EchoDetector, PatchesOfASlantingSurfaceHangTogether) {
  const std::vector<EchoPart> ground{part(60.0F, 0.2F, 1.0F), part(62.0F, 0.2F, 1.0F),
                                     part(64.0F, 0.2F, 1.0F)};
  const DetectedEchoes echoes = detect(ground);
  ASSERT_EQ(echoes.count, 1U);
  EXPECT_NEAR(echoes.strongest.range_m, 62.0F, 1e-4F);
}

TEST(EchoDetector, ASilhouetteInFrontOfAWallIsNoBridgeToIt) {
  EXPECT_EQ(detect({part(10.0F, 0.2F, 5.0F), part(12.0F, 0.2F, 0.01F)}).count, 2U);
}

TEST(EchoDetector, OfEquallyStrongEchoesTheNearerCountsAsStronger) {
  const DetectedEchoes echoes = detect({part(20.0F, 0.5F), part(10.0F, 0.5F)});
  EXPECT_FLOAT_EQ(echoes.strongest.range_m, 10.0F);
  EXPECT_FLOAT_EQ(echoes.last.range_m, 20.0F);
}

TEST(EchoDetector, EnergyOfSeenEchoesIsThatOfTheirParts) {
  std::vector<EchoPart> parts;
  float sum = 0.0F;
  for (int i = 0; i < 19; ++i) {
    parts.push_back(part(10.0F + 0.02F * static_cast<float>((i * 7) % 19),
                         0.01F + 0.001F * static_cast<float>(i)));
    sum += parts.back().energy;
  }
  const DetectedEchoes echoes = detect(parts);
  ASSERT_EQ(echoes.count, 1U);
  EXPECT_NEAR(echoes.strongest.energy, sum, 1e-6F);
}

}  // namespace
}  // namespace rigwire::sim
