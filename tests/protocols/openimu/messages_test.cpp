#include "protocols/openimu/messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "protocols/vehicle/message.h"

namespace rigwire::protocols::openimu {
namespace {

using testing::ElementsAre;
constexpr auto kUnknown = FigureOfMerit::kNotAvailable;
constexpr std::uint8_t kSource = 0x80;

TEST(Slope, LevelBytesOfTheTwoVariants) {
  Slope slope;
  EXPECT_THAT(encode(slope, kSource).payload(), ElementsAre(0, 0, 0x7D, 0, 0, 0x7D, 0x00, 0));
  slope.pitch_merit = kUnknown;
  slope.roll_merit = kUnknown;
  const can::Frame frame = encode(slope, kSource);
  EXPECT_EQ(frame.id, 0x0CF02980U);
  EXPECT_THAT(frame.payload(), ElementsAre(0, 0, 0x7D, 0, 0, 0x7D, 0xCC, 0));
}

TEST(Slope, PitchFiveRollMinusTwoAndAHalf) {
  Slope slope;
  slope.pitch_deg = 5.0;
  slope.roll_deg = -2.5;
  slope.latency_ms = 1.0;
  EXPECT_THAT(encode(slope, kSource).payload(),
              ElementsAre(0x00, 0x80, 0x7F, 0x00, 0xC0, 0x7B, 0x00, 2));
}

TEST(AngularRate, VectorsAndMeritByte) {
  AngularRate rate{1.0, -1.0, 10.0};
  EXPECT_THAT(encode(rate, kSource).payload(),
              ElementsAre(0x80, 0x7D, 0x80, 0x7C, 0x00, 0x82, 0x00, 0));
  rate = {0.0, 0.0, 0.0, kUnknown, kUnknown, kUnknown, 0.0};
  const can::Frame frame = encode(rate, kSource);
  EXPECT_EQ(frame.id, 0x0CF02A80U);
  EXPECT_THAT(frame.payload(), ElementsAre(0, 0x7D, 0, 0x7D, 0, 0x7D, 0x3F, 0));
}

TEST(Acceleration, RestVectorsAndRepetitionRateBits) {
  Acceleration rest{0.0, 0.0, 9.81};
  const can::Frame frame = encode(rest, kSource);
  EXPECT_EQ(frame.id, 0x08F02D80U);
  EXPECT_THAT(frame.payload(), ElementsAre(0, 0x7D, 0, 0x7D, 0xD5, 0x80, 0x80, 0));
  rest = {0.0, 0.0, 9.81, kUnknown, kUnknown, kUnknown};
  EXPECT_EQ(encode(rest, kSource).data[6], 0xBF);
}

TEST(AngularRate, FirmwareClampsAt250) {
  const AngularRate rate{400.0, -400.0, std::nan("")};
  const auto decoded = decode<AngularRate>(encode(rate, kSource));
  EXPECT_EQ(decoded->pitch_dps, 250.0);
  EXPECT_EQ(decoded->roll_dps, -250.0);
  EXPECT_TRUE(std::isnan(decoded->yaw_dps));
}

TEST(AngularRate, FaultIsSentAsErrorValueNotAsNumber) {
  const AngularRate rate{vehicle::kError, 0.0, 0.0, FigureOfMerit::kError};
  const can::Frame frame = encode(rate, kSource);
  EXPECT_EQ(frame.data[1], 0xFE);
  EXPECT_EQ(decode<AngularRate>(frame)->pitch_dps, vehicle::kError);
  EXPECT_EQ(decode<AngularRate>(frame)->pitch_merit, FigureOfMerit::kError);
}

TEST(OpenImuMessages, RoundTripWithinHalfACount) {
  for (double x = -240.0; x < 240.0; x += 3.173) {
    const auto slope = decode<Slope>(encode(Slope{x, -x, 0, 1, 1, 3, 2.5}, kSource));
    EXPECT_NEAR(slope->pitch_deg, x, kSlopeAngle.count / 2);
    EXPECT_NEAR(slope->roll_deg, -x, kSlopeAngle.count / 2);
    EXPECT_EQ(slope->pitch_merit, FigureOfMerit::kFunctional);
    EXPECT_EQ(slope->roll_merit, FigureOfMerit::kDegraded);
    EXPECT_EQ(slope->pitch_compensation, 1);
    EXPECT_EQ(slope->roll_compensation, 3);
    EXPECT_EQ(slope->latency_ms, 2.5);
    const auto rate = decode<AngularRate>(encode(AngularRate{x, -x, x / 2}, kSource));
    EXPECT_NEAR(rate->pitch_dps, x, kRate.count / 2);
    EXPECT_NEAR(rate->roll_dps, -x, kRate.count / 2);
    EXPECT_NEAR(rate->yaw_dps, x / 2, kRate.count / 2);
    const auto acceleration = decode<Acceleration>(encode(Acceleration{x, -x, x / 2}, kSource));
    EXPECT_NEAR(acceleration->lateral_mps2, x, kForce.count / 2 + 1e-12);
    EXPECT_NEAR(acceleration->longitudinal_mps2, -x, kForce.count / 2 + 1e-12);
    EXPECT_NEAR(acceleration->vertical_mps2, x / 2, kForce.count / 2 + 1e-12);
  }
}

TEST(OpenImuMessages, OtherLengthsAndGroupsAreMalformed) {
  can::Frame frame = encode(Slope{}, kSource);
  EXPECT_TRUE(decode<AngularRate>(frame).malformed());
  for (std::uint8_t length = 0; length < 8; ++length) {
    frame.length = length;
    EXPECT_TRUE(decode<Slope>(frame).malformed());
  }
  frame.length = 255;
  EXPECT_TRUE(decode<Slope>(frame).malformed());
}

TEST(Messages, OlderSlopeFineRateAndMagneticField) {
  // 5 deg: 69 * 500 = 34500; -2.5 deg: 61.5 * 500 = 30750; 1 deg/s: 65 * 500 = 32500.
  const can::Frame slope = encode(Slope1{5.0, -2.5, 1.0, 0, 0, 0, 3, 2.0}, 0x80);
  EXPECT_EQ(slope.id, 0x0CF01380U);
  EXPECT_THAT(slope.payload(), ElementsAre(0xC4, 0x86, 0x1E, 0x78, 0xF4, 0x7E, 0xC0, 4));
  // 1 deg/s: 251 * 1024 = 0x3EC00; 0: 0x3E800; -1: 0x3E400, 19 bits each.
  const can::Frame fine = encode(FineRate{1.0, 0.0, -1.0, 0, 0, FigureOfMerit::kDegraded}, 0x80);
  std::uint64_t word = 0;
  for (std::size_t i = 8; i-- > 0;) {
    word = (word << 8U) | fine.data[i];
  }
  EXPECT_EQ(word, 0x3EC00ULL | (0x3E800ULL << 19U) | (0x3E400ULL << 38U) | (1ULL << 61U));
  EXPECT_EQ(decode<FineRate>(fine)->yaw_dps, -1.0);
  EXPECT_EQ(decode<FineRate>(fine)->yaw_merit, FigureOfMerit::kDegraded);
  // 0.2 G: 8.2 / 0.00025 = 32800 = 0x8020.
  EXPECT_THAT(encode(MagneticField{0.2, 0.0, -8.0}, 0x80).payload(),
              ElementsAre(0x20, 0x80, 0x00, 0x7D, 0x00, 0x00, 0, 0));
}

TEST(Messages, LayoutsCarryTheTablesNumbers) {
  const auto slope = vehicle::layout<Slope>({"imu", 0x81});
  EXPECT_EQ(slope.name, "slope_sensor_2");
  EXPECT_EQ(slope.id, 0x0CF02981U);
  EXPECT_EQ(slope.fill, 0);
  EXPECT_EQ(slope.signals.at(0).width, 24);
  EXPECT_EQ(slope.signals.at(0).spn, 3318U);
  EXPECT_EQ(slope.signals.at(4).values.at(1).text, "degraded");
  const auto acceleration = vehicle::layout<Acceleration>({});
  EXPECT_EQ(acceleration.signals.at(2).name, "vertical_acceleration");
  EXPECT_EQ(acceleration.signals.at(2).offset, -320.0);
}

}  // namespace
}  // namespace rigwire::protocols::openimu
