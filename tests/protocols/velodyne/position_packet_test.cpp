#include "protocols/velodyne/position_packet.h"

#include <gtest/gtest.h>

#include <vector>

#include "protocols/velodyne/gprmc.h"

namespace rigwire::protocols::velodyne {
namespace {

using Bytes = std::array<std::uint8_t, kPositionPacketSize>;

TEST(VelodynePositionPacket, DecodesWhatItEncoded) {
  PositionPacket packet;
  packet.inertial[0] = {-2048, 2047, -1, 0};
  packet.inertial[2] = {1, -2, 3, -4};
  packet.timestamp_us = 123456789;
  packet.pulse_state = PulseState::locked;
  packet.set_sentence("$GPRMC,190729,A,3708.3184,N*00\r\n");
  Bytes bytes{};
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
  Bytes bytes{};
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

TEST(VelodyneGprmc, WritesTheSentenceOfAFix) {
  const GprmcText text({.year = 2026,
                        .month = 6,
                        .day = 1,
                        .hour = 8,
                        .minute = 5,
                        .second = 9,
                        .valid = true,
                        .latitude_deg = 49.424999999,
                        .longitude_deg = -7.75,
                        .speed_mps = 1852.0 / 3600.0,
                        .course_deg = 359.96});
  // Checksum by hand: exclusive or of the characters between $ and *.
  EXPECT_EQ(text.view().substr(0, text.view().find('*')),
            "$GPRMC,080509,A,4925.5000,N,00745.0000,W,001.0,000.0,010626,,,A");
  unsigned sum = 0;
  for (const char c : text.view().substr(1, text.view().find('*') - 1)) {
    sum ^= static_cast<unsigned char>(c);
  }
  std::array<char, 8> expected{};
  std::snprintf(expected.data(), expected.size(), "*%02X\r\n", sum);
  EXPECT_EQ(text.view().substr(text.view().find('*')), expected.data());
}

TEST(VelodyneGprmc, SaysNoFixWithoutAPosition) {
  const GprmcText text(
      {.year = 2026, .month = 12, .day = 31, .hour = 23, .minute = 59, .second = 60});
  EXPECT_EQ(text.view().substr(0, text.view().find('*')), "$GPRMC,235960,V,,,,,,,311226,,,N");
}

TEST(VelodyneGprmc, NeverPrintsSixtyMinutes) {
  const GprmcText text({.valid = true, .latitude_deg = 48.999999999, .longitude_deg = 179.9999999});
  EXPECT_NE(text.view().find(",4900.0000,N,18000.0000,E,"), std::string_view::npos) << text.view();
}

}  // namespace
}  // namespace rigwire::protocols::velodyne
