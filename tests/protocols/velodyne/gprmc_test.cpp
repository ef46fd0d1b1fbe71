#include "protocols/velodyne/gprmc.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>

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

}  // namespace
}  // namespace rigwire::protocols::velodyne
