#include "protocols/velodyne/gprmc.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "protocols/velodyne/gpgga.h"

namespace rigwire::protocols::velodyne {
namespace {

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
            "$GPRMC,080509,A,4925.5000,N,00745.0000,W,001.0,000.0,010626,000.0,E,A");
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

TEST(VelodyneGprmc, WritesTenthsWhereTheReceiverDoes) {
  const GprmcText text({.hour = 1, .second = 2, .tenth = 3, .time_form = NmeaTimeForm::tenths});
  EXPECT_EQ(text.view().substr(0, 18), "$GPRMC,010002.3,V,");
}

TEST(VelodyneGpgga, WritesTheSentenceOfAFix) {
  const GpggaText text({.hour = 17,
                        .minute = 28,
                        .second = 14,
                        .time_form = NmeaTimeForm::tenths,
                        .valid = true,
                        .latitude_deg = 37.3919,
                        .longitude_deg = -122.03781,
                        .quality = 2,
                        .satellites = 6,
                        .horizontal_dilution = 1.2,
                        .altitude_m = 18.893,
                        .geoid_separation_m = -25.669});
  // Checksum by an independent exclusive or over the characters between $ and *.
  EXPECT_EQ(text.view(),
            "$GPGGA,172814.0,3723.5140,N,12202.2686,W,2,06,1.2,18.9,M,-25.7,M,,*50\r\n");
}

TEST(VelodyneGpgga, LeavesThePositionEmptyWithoutAFix) {
  const GpggaText text({.hour = 1, .minute = 2, .second = 3, .satellites = 2});
  EXPECT_EQ(text.view().substr(0, text.view().find('*')), "$GPGGA,010203,,,,,0,02,,,M,,M,,");
}

TEST(VelodyneGpgga, LongestSentenceFitsTheExtendedPacket) {
  const GpggaText text({.hour = 23,
                        .time_form = NmeaTimeForm::tenths,
                        .valid = true,
                        .latitude_deg = -1e30,
                        .longitude_deg = -1e30,
                        .satellites = 1000,
                        .horizontal_dilution = 1e30,
                        .altitude_m = -1e30,
                        .geoid_separation_m = -1e30});
  EXPECT_LE(text.view().size(), 128U);
  EXPECT_TRUE(text.view().ends_with("\r\n"));
}

}  // namespace
}  // namespace rigwire::protocols::velodyne
