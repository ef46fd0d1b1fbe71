// Engine configuration: forty bytes worked by hand, the way back, every shorter one.
#include "protocols/vehicle/engine_configuration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <span>

namespace rigwire::protocols::vehicle {
namespace {

constexpr double kRpm = kRevolutionPerMinute_radps;

EngineConfiguration some() {
  EngineConfiguration c;
  c.speed_radps = {700 * kRpm, 2200 * kRpm, 1000 * kRpm, 1200 * kRpm, 1600 * kRpm};
  c.torque_share = {0.5, 0.85, 0.9, 0.97, 1.0};
  c.high_idle_radps = 2400 * kRpm;
  c.governor_gain_prad = 0.18;
  c.reference_torque_nm = 1019.0;
  c.least_speed_radps = 700 * kRpm;
  c.greatest_speed_radps = 2200 * kRpm;
  c.least_torque_share = 0.0;
  c.greatest_torque_share = 1.0;
  c.inertia_kgm2 = 1.3;
  return c;
}

TEST(EngineConfigurationMessage, BytesAreThoseOfTheAnnex) {
  const auto bytes = encode_engine_configuration(some());
  EXPECT_EQ(bytes[0] | bytes[1] << 8, 5600);   // 700 rpm by 1/8
  EXPECT_EQ(bytes[2], 175);                    // 50 % from -125 %
  EXPECT_EQ(bytes[3] | bytes[4] << 8, 17600);  // 2200 rpm
  EXPECT_EQ(bytes[14], 225);                   // 100 %
  EXPECT_EQ(bytes[15] | bytes[16] << 8, 19200);
  // 0.18 per rad/s are 1.885 % per rpm, by 0.00078125.
  EXPECT_EQ(bytes[17] | bytes[18] << 8, std::lround(18.0 * kRpm / 0.00078125));
  EXPECT_EQ(bytes[19] | bytes[20] << 8, 1019);
  EXPECT_EQ(bytes[21], 0xFF);  // no override speed
  EXPECT_EQ(bytes[24], 70);
  EXPECT_EQ(bytes[25], 220);
  EXPECT_EQ(bytes[26], 125);
  EXPECT_EQ(bytes[27], 225);
  EXPECT_EQ(bytes[30] | bytes[31] << 8, 325);  // 1.3 by 0.004
  EXPECT_EQ(bytes[39], 0xFF);
}

TEST(EngineConfigurationMessage, ReturnsWithinHalfACount) {
  const auto bytes = encode_engine_configuration(some());
  const auto back = decode_engine_configuration(bytes);
  ASSERT_TRUE(back.ok());
  for (std::size_t i = 0; i < EngineConfiguration::kPoints; ++i) {
    EXPECT_NEAR(back->speed_radps[i], some().speed_radps[i], 0.0626 * kRpm);
    EXPECT_NEAR(back->torque_share[i], some().torque_share[i], 0.00501);
  }
  EXPECT_NEAR(back->governor_gain_prad, 0.18, 1e-4);
  EXPECT_NEAR(back->inertia_kgm2, 1.3, 0.002);
}

TEST(EngineConfigurationMessage, OlderOnesAreShorterAndLackWhatFollows) {
  const auto bytes = encode_engine_configuration(some());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto back = decode_engine_configuration(std::span(bytes).first(size));
    EXPECT_EQ(back.ok(), size >= 28) << size;
    if (back.ok() && size < 32) {
      EXPECT_TRUE(std::isnan(back->inertia_kgm2)) << size;
    }
  }
}

}  // namespace
}  // namespace rigwire::protocols::vehicle
