#include "protocols/openimu/messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace rigwire::protocols::openimu {
namespace {

using testing::ElementsAre;
constexpr auto kUnknown = FigureOfMerit::not_available;
constexpr std::uint8_t kSource = 0x80;

TEST(Slope, LevelBytesOfTheTwoVariants) {
  Slope slope;
  EXPECT_THAT(encode(slope, kSource).payload(), ElementsAre(0, 0, 0x7D, 0, 0, 0x7D, 0x00, 0));
  slope.pitch_deg.merit = kUnknown;
  slope.roll_deg.merit = kUnknown;
  const can::Frame frame = encode(slope, kSource);
  EXPECT_EQ(frame.id, 0x0CF02980U);
  EXPECT_THAT(frame.payload(), ElementsAre(0, 0, 0x7D, 0, 0, 0x7D, 0xCC, 0));
}

TEST(Slope, PitchFiveRollMinusTwoAndAHalf) {
  Slope slope;
  slope.pitch_deg.value = 5.0;
  slope.roll_deg.value = -2.5;
  slope.latency_ms = 1.0;
  EXPECT_THAT(encode(slope, kSource).payload(),
              ElementsAre(0x00, 0x80, 0x7F, 0x00, 0xC0, 0x7B, 0x00, 2));
}

TEST(AngularRate, VectorsAndMeritByte) {
  AngularRate rate{{1.0}, {-1.0}, {10.0}, 0.0};
  EXPECT_THAT(encode(rate, kSource).payload(),
              ElementsAre(0x80, 0x7D, 0x80, 0x7C, 0x00, 0x82, 0x00, 0));
  rate = {{0.0, kUnknown}, {0.0, kUnknown}, {0.0, kUnknown}, 0.0};
  const can::Frame frame = encode(rate, kSource);
  EXPECT_EQ(frame.id, 0x0CF02A80U);
  EXPECT_THAT(frame.payload(), ElementsAre(0, 0x7D, 0, 0x7D, 0, 0x7D, 0x3F, 0));
}

TEST(Acceleration, RestVectorsAndRepetitionRateBits) {
  Acceleration rest{{0.0}, {0.0}, {9.81}, 0.0};
  const can::Frame frame = encode(rest, kSource);
  EXPECT_EQ(frame.id, 0x08F02D80U);
  EXPECT_THAT(frame.payload(), ElementsAre(0, 0x7D, 0, 0x7D, 0xD5, 0x80, 0x80, 0));
  rest = {{0.0, kUnknown}, {0.0, kUnknown}, {9.81, kUnknown}, 0.0};
  EXPECT_EQ(encode(rest, kSource).data[6], 0xBF);
}

TEST(AngularRate, FirmwareClampsAt250) {
  const AngularRate rate{{400.0}, {-400.0}, {std::nan("")}, 0.0};
  const auto decoded = decode_angular_rate(encode(rate, kSource));
  EXPECT_EQ(decoded->pitch_dps.value, 250.0);
  EXPECT_EQ(decoded->roll_dps.value, -250.0);
  EXPECT_TRUE(std::isnan(decoded->yaw_dps.value));
}

TEST(AngularRate, FaultIsSentAsErrorValueNotAsNumber) {
  const AngularRate rate{{std::nan(""), FigureOfMerit::error}, {0.0}, {0.0}, 0.0};
  const can::Frame frame = encode(rate, kSource);
  EXPECT_EQ(frame.data[1], 0xFE);
  EXPECT_TRUE(std::isnan(decode_angular_rate(frame)->pitch_dps.value));
  EXPECT_EQ(decode_angular_rate(frame)->pitch_dps.merit, FigureOfMerit::error);
}

TEST(OpenImuMessages, RoundTripWithinHalfACount) {
  for (double x = -240.0; x < 240.0; x += 3.173) {
    const auto slope = decode_slope(encode(Slope{{x}, {-x}, 1, 3, 2.5}, kSource));
    EXPECT_NEAR(slope->pitch_deg.value, x, kSlopeScale_deg / 2);
    EXPECT_NEAR(slope->roll_deg.value, -x, kSlopeScale_deg / 2);
    EXPECT_EQ(slope->pitch_compensation, 1);
    EXPECT_EQ(slope->roll_compensation, 3);
    EXPECT_EQ(slope->latency_ms, 2.5);
    const auto rate = decode_angular_rate(encode(AngularRate{{x}, {-x}, {x / 2}, 0.5}, kSource));
    EXPECT_NEAR(rate->pitch_dps.value, x, kRateScale_dps / 2);
    EXPECT_NEAR(rate->roll_dps.value, -x, kRateScale_dps / 2);
    EXPECT_NEAR(rate->yaw_dps.value, x / 2, kRateScale_dps / 2);
    const auto acceleration =
        decode_acceleration(encode(Acceleration{{x}, {-x}, {x / 2}, 0.0}, kSource));
    EXPECT_NEAR(acceleration->lateral_mps2.value, x, kAccelerationScale_mps2 / 2 + 1e-12);
    EXPECT_NEAR(acceleration->longitudinal_mps2.value, -x, kAccelerationScale_mps2 / 2 + 1e-12);
    EXPECT_NEAR(acceleration->vertical_mps2.value, x / 2, kAccelerationScale_mps2 / 2 + 1e-12);
  }
}

TEST(OpenImuMessages, OtherLengthsAndGroupsAreMalformed) {
  can::Frame frame = encode(Slope{}, kSource);
  EXPECT_TRUE(decode_angular_rate(frame).malformed());
  for (std::uint8_t length = 0; length < 8; ++length) {
    frame.length = length;
    EXPECT_TRUE(decode_slope(frame).malformed());
  }
  frame.length = 255;
  EXPECT_TRUE(decode_slope(frame).malformed());
}

TEST(Messages, OlderSlopeFineRateAndMagneticField) {
  // 5 deg: 69 * 500 = 34500; -2.5 deg: 61.5 * 500 = 30750; 1 deg/s: 65 * 500 = 32500.
  const can::Frame slope = encode(Slope1{{5.0}, {-2.5}, {1.0}, 3, 2.0}, 0x80);
  EXPECT_EQ(slope.id, 0x0CF01380U);
  EXPECT_THAT(slope.payload(), ElementsAre(0xC4, 0x86, 0x1E, 0x78, 0xF4, 0x7E, 0xC0, 4));
  // 1 deg/s: 251 * 1024 = 0x3EC00; 0: 0x3E800; -1: 0x3E400, 19 bits each.
  const can::Frame fine = encode(FineRate{{1.0}, {0.0}, {-1.0, FigureOfMerit::degraded}}, 0x80);
  std::uint64_t word = 0;
  for (std::size_t i = 8; i-- > 0;) {
    word = (word << 8U) | fine.data[i];
  }
  EXPECT_EQ(word, 0x3EC00ULL | (0x3E800ULL << 19U) | (0x3E400ULL << 38U) | (1ULL << 61U));
  EXPECT_EQ(decode_fine_rate(fine)->yaw_dps.value, -1.0);
  EXPECT_EQ(decode_fine_rate(fine)->yaw_dps.merit, FigureOfMerit::degraded);
  // 0.2 G: 8.2 / 0.00025 = 32800 = 0x8020.
  EXPECT_THAT(encode(MagneticField{0.2, 0.0, -8.0}, 0x80).payload(),
              ElementsAre(0x20, 0x80, 0x00, 0x7D, 0x00, 0x00, 0, 0));
}

TEST(Messages, LayoutsCarryTheTablesNumbers) {
  const auto list = layouts(0x81);
  ASSERT_EQ(list.size(), 6U);
  EXPECT_EQ(list[0].id, 0x0CF02981U);
  EXPECT_EQ(list[0].fields[0].width, 24);
  EXPECT_EQ(list[2].fields[2].name, "vertical_acceleration");
  EXPECT_EQ(list[2].fields[2].offset, -320.0);
  for (const auto& message : list) {
    for (const auto& field : message.fields) {
      EXPECT_LE(field.bit + field.width, 64) << message.name << ' ' << field.name;
    }
  }
}

}  // namespace
}  // namespace rigwire::protocols::openimu
