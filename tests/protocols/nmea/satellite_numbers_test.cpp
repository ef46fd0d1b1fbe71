#include "protocols/nmea/satellite_numbers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

namespace rigwire::protocols::nmea {
namespace {

TEST(NmeaNumbers, FollowTheTableOfVersionsAndNumberings) {
  struct Row {
    System system;
    int number;
    std::optional<int> strict23, extended23, strict410, extended410, strict411;
  };
  constexpr auto kNone = std::nullopt;
  for (const auto& row : {
           Row{System::gps, 32, 32, 32, 32, 32, 32},
           Row{System::sbas, 120, 33, 33, 33, 33, 33},
           Row{System::sbas, 133, 46, 46, 46, 46, 46},
           Row{System::sbas, 151, 64, 64, 64, 64, 64},
           Row{System::sbas, 152, kNone, 152, kNone, 152, kNone},
           Row{System::galileo, 36, kNone, 336, 36, 36, 36},
           Row{System::beidou, 37, kNone, 437, 37, 37, 37},
           Row{System::qzss, 1, kNone, 193, kNone, 193, 1},
           Row{System::glonass, 1, 65, 65, 65, 65, 65},
           Row{System::glonass, 32, 96, 96, 96, 96, 96},
           Row{System::glonass, 255, 0, 0, 0, 0, 0},
       }) {
    const auto number = [&](Version version, Numbering numbering) {
      return satellite_number(row.system, row.number, version, numbering);
    };
    EXPECT_EQ(number(Version::v23, Numbering::strict), row.strict23);
    EXPECT_EQ(number(Version::v40, Numbering::extended), row.extended23);
    EXPECT_EQ(number(Version::v410, Numbering::strict), row.strict410);
    EXPECT_EQ(number(Version::v410, Numbering::extended), row.extended410);
    EXPECT_EQ(number(Version::v411, Numbering::strict), row.strict411);
  }
}

TEST(NmeaNumbers, OneByteScheme) {
  EXPECT_EQ(single_satellite_number(System::sbas, 158), 158);
  EXPECT_EQ(single_satellite_number(System::galileo, 36), 246);
  EXPECT_EQ(single_satellite_number(System::beidou, 5), 163);
  EXPECT_EQ(single_satellite_number(System::beidou, 6), 33);
  EXPECT_EQ(single_satellite_number(System::beidou, 37), 64);
  EXPECT_EQ(single_satellite_number(System::beidou, 38), 255);
  EXPECT_EQ(single_satellite_number(System::qzss, 10), 202);
  EXPECT_EQ(single_satellite_number(System::glonass, 32), 96);
}

TEST(NmeaNumbers, MainTalkerIsGnForSeveralGroups) {
  const unsigned gps =
      system_bit(System::gps) | system_bit(System::sbas) | system_bit(System::qzss);
  EXPECT_EQ(main_talker(gps, Version::v410), "GP");
  EXPECT_EQ(main_talker(gps, Version::v411), "GN");
  EXPECT_EQ(main_talker(system_bit(System::glonass), Version::v23), "GL");
  EXPECT_EQ(main_talker(gps | system_bit(System::galileo), Version::v40), "GN");
  EXPECT_EQ(main_talker(0, Version::v40), "GP");
}

}  // namespace
}  // namespace rigwire::protocols::nmea
