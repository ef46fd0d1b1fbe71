#include "protocols/velodyne/position_packet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace rigwire::protocols::velodyne {
namespace {

using PositionPacketBytes = std::array<std::uint8_t, kPositionPacketSize>;

TEST(VelodynePositionPacket, DecodesWhatItEncoded) {
  PositionPacket packet;
  packet.inertial[0] = {-2048, 2047, -1, 0};
  packet.inertial[2] = {1, -2, 3, -4};
  packet.timestamp_us = 123456789;
  packet.pulse_state = PulseState::locked;
  packet.set_sentence("$GPRMC,190729,A,3708.3184,N*00\r\n");
  PositionPacketBytes bytes{};
  encode(packet, bytes);
  EXPECT_EQ(bytes[14], 0x00);
  EXPECT_EQ(bytes[15], 0x08) << "twelve bits, two's complement";
  EXPECT_EQ(bytes[202], 2);
  EXPECT_EQ(bytes[206], '$');
  const auto decoded = decode_position_packet(bytes);
  ASSERT_TRUE(decoded.ok());
  EXPECT_EQ(*decoded, packet);
  EXPECT_EQ(decoded->sentence(), "$GPRMC,190729,A,3708.3184,N*00\r\n");
}

TEST(VelodynePositionPacket, RefusesWhatCannotBeOne) {
  PositionPacketBytes bytes{};
  EXPECT_TRUE(decode_position_packet(bytes).ok());
  EXPECT_TRUE(decode_position_packet(std::span(bytes).first(511)).incomplete());
  EXPECT_TRUE(decode_position_packet(std::vector<std::uint8_t>(513)).malformed());
  bytes[13] = 1;
  EXPECT_TRUE(decode_position_packet(bytes).malformed());
  bytes[13] = 0;
  bytes[202] = 4;
  EXPECT_TRUE(decode_position_packet(bytes).malformed());
  bytes[202] = 0;
  bytes[300] = 'x';
  ASSERT_TRUE(decode_position_packet(bytes).malformed());
  EXPECT_EQ(decode_position_packet(bytes).fault().offset, 300U);
}

TEST(VelodynePositionPacket, ExtendedFieldsStandWhereTheManualPutsThem) {
  PositionPacket packet;
  packet.status = {.top_board_c = 45,
                   .bottom_board_c = 41,
                   .at_calibration_c = 39,
                   .change_since_calibration_c = -3,
                   .since_calibration_s = 0x01020304,
                   .last_calibration = ConverterCalibration::temperature_change,
                   .calibrating = true,
                   .period_reached = true,
                   .thermal_shutdown = true,
                   .at_shutdown_c = 91,
                   .at_power_up_c = 20};
  packet.timestamp_us = 0x0A0B0C0D;
  packet.set_sentence("$GPGGA,");
  PositionPacketBytes bytes{};
  encode(packet, bytes);
  const std::array<std::uint8_t, 20> expected{45, 41, 39, 0xFD, 0xFF, 4,    3,    2,  1,  3,
                                              5,  13, 12, 11,   10,   0x00, 0x01, 91, 20, '$'};
  EXPECT_TRUE(std::ranges::equal(expected, std::span(bytes).subspan(0xBB, expected.size())));
  const auto decoded = decode_position_packet(bytes);
  ASSERT_TRUE(decoded.ok());
  EXPECT_EQ(*decoded, packet);
  bytes[0xC4] = 5;
  ASSERT_TRUE(decode_position_packet(bytes).malformed());
  EXPECT_EQ(decode_position_packet(bytes).fault().offset, 0xC4U);
  bytes[0xC4] = 0;
  bytes[0xCB] = 2;
  EXPECT_TRUE(decode_position_packet(bytes).malformed());
}

TEST(VelodynePositionPacket, InertialCountsKeepHalfAUnitAndStopAtTwelveBits) {
  const double degree = std::numbers::pi / 180.0;
  const InertialReading reading{.rate_radps = -1.2345,
                                .temperature_c = 37.7,
                                .acceleration_x_mps2 = 9.80665,
                                .acceleration_y_mps2 = -0.5};
  const InertialReading back = from_counts(to_counts(reading));
  EXPECT_NEAR(back.rate_radps, reading.rate_radps, 0.09766 / 2 * degree);
  EXPECT_NEAR(back.temperature_c, reading.temperature_c, 0.1453 / 2);
  EXPECT_NEAR(back.acceleration_x_mps2, reading.acceleration_x_mps2, 0.001221 / 2 * 9.80665);
  EXPECT_EQ(to_counts(reading).acceleration_x, 819) << "1 g";
  const InertialGroup most = to_counts({1e9, 1e9, -1e9, std::nan("")});
  EXPECT_EQ(most, (InertialGroup{2047, 2047, -2048, 0}));
  EXPECT_EQ(to_counts(InertialReading{}), InertialGroup{});
}

}  // namespace
}  // namespace rigwire::protocols::velodyne
