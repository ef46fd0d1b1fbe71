#include "protocols/nmea/writers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sentences.h"

namespace rigwire::protocols::nmea {
namespace {

TEST(NmeaWriters, LastGsvPageIsNotPadded) {
  std::vector<SatelliteInView> satellites(12, SatelliteInView{1, 5, 6, 7, true});
  satellites.push_back({46, 47, 145, std::nullopt, false});
  satellites.push_back({48, 47, 205, 46, true});
  satellites.push_back({51, 49, 161, 50, true});
  Epoch epoch;
  epoch.satellites = satellites;
  ASSERT_EQ(gsv_pages(epoch), 4);
  EXPECT_EQ(text(write_gsv(epoch, 4)), "$GPGSV,4,4,15,46,47,145,,48,47,205,46,51,49,161,50*4C\r\n");
}

TEST(NmeaWriters, GsvStopsAtFivePages) {
  const std::vector<SatelliteInView> satellites(23, SatelliteInView{1, 5, 6, 7, true});
  Epoch epoch;
  epoch.satellites = satellites;
  EXPECT_EQ(gsv_pages(epoch), 5);
  EXPECT_THAT(text(write_gsv(epoch, 5)), testing::StartsWith("$GPGSV,5,5,20,"));
}

std::vector<std::string> all_gsv(const Epoch& epoch) {
  std::vector<std::string> lines;
  for (int page = 1; page <= gsv_pages(epoch); ++page) {
    lines.push_back(text(write_gsv(epoch, page)));
  }
  return lines;
}

Epoch several_systems(std::vector<SatelliteInView>& satellites, Version version) {
  const auto add = [&](int number, System system, std::uint8_t signal, std::optional<int> cn0) {
    SatelliteInView satellite{number, 40, 120, cn0, cn0.has_value()};
    satellite.system = system;
    satellite.signal = signal;
    satellites.push_back(satellite);
  };
  add(2, System::gps, 1, 40);
  add(2, System::gps, 6, 35);
  add(5, System::gps, 0, std::nullopt);
  add(46, System::sbas, 1, 38);
  add(70, System::glonass, 1, 33);
  add(11, System::galileo, 7, 41);
  Epoch epoch;
  epoch.talker = "GN";
  epoch.version = version;
  epoch.systems = system_bit(System::gps) | system_bit(System::sbas) | system_bit(System::galileo) |
                  system_bit(System::glonass) | system_bit(System::beidou);
  epoch.fix_dimensions = 3;
  epoch.satellites = satellites;
  return epoch;
}

TEST(NmeaSatellites, GsvComesBySystemAndSignalFrom410On) {
  std::vector<SatelliteInView> satellites;
  const Epoch epoch = several_systems(satellites, Version::v411);
  using testing::StartsWith;
  EXPECT_THAT(all_gsv(epoch),
              testing::ElementsAre(StartsWith("$GPGSV,1,1,02,02,40,120,40,46,40,120,38,1*"),
                                   StartsWith("$GPGSV,1,1,01,02,40,120,35,6*"),
                                   StartsWith("$GPGSV,1,1,01,05,40,120,,0*"),
                                   StartsWith("$GLGSV,1,1,01,70,40,120,33,1*"),
                                   StartsWith("$GAGSV,1,1,01,11,40,120,41,7*"),
                                   StartsWith("$GBGSV,1,1,00,0*77")));
}

TEST(NmeaSatellites, GsvOfVersion40IsBySystemAlone) {
  std::vector<SatelliteInView> satellites;
  Epoch epoch = several_systems(satellites, Version::v40);
  const auto lines = all_gsv(epoch);
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_THAT(lines[0], testing::StartsWith("$GPGSV,1,1,04,02,40,120,40,02,"));
  epoch.gsv_main_talker = true;
  EXPECT_THAT(all_gsv(epoch), testing::Each(testing::StartsWith("$GNGSV,1,1,")));
}

TEST(NmeaSatellites, OneGsaForEachSystemAndEachSatelliteOnce) {
  std::vector<SatelliteInView> satellites;
  const Epoch epoch = several_systems(satellites, Version::v410);
  ASSERT_EQ(gsa_sentences(epoch), 4);
  using testing::StartsWith;
  EXPECT_THAT(text(write_gsa(epoch, 1)),
              StartsWith("$GNGSA,A,3,02,46,,,,,,,,,,,99.99,99.99,99.99,1*"));
  EXPECT_THAT(text(write_gsa(epoch, 2)),
              StartsWith("$GNGSA,A,3,70,,,,,,,,,,,,99.99,99.99,99.99,2*"));
  EXPECT_THAT(text(write_gsa(epoch, 3)),
              StartsWith("$GNGSA,A,3,11,,,,,,,,,,,,99.99,99.99,99.99,3*"));
  EXPECT_THAT(text(write_gsa(epoch, 4)), StartsWith("$GNGSA,A,3,,,,,,,,,,,,,99.99,99.99,99.99,4*"));
}

TEST(NmeaSatellites, LimitOfSatellitesByTalker) {
  const std::vector<SatelliteInView> satellites(15, SatelliteInView{1, 5, 6, 7, true});
  Epoch epoch;
  epoch.satellites = satellites;
  epoch.maximum_satellites = 8;
  EXPECT_EQ(gsv_pages(epoch), 2);
  EXPECT_THAT(text(write_gsv(epoch, 2)), testing::StartsWith("$GPGSV,2,2,08,"));
}

TEST(NmeaSatellites, UnidentifiedGlonassSatelliteHasNoNumber) {
  const std::vector<SatelliteInView> satellites{{0, std::nullopt, std::nullopt, 30, false}};
  Epoch epoch;
  epoch.talker = "GL";
  epoch.satellites = satellites;
  EXPECT_THAT(text(write_gsv(epoch, 1)), testing::StartsWith("$GLGSV,1,1,01,,,,30*"));
}

// The document prints the checksum of GSA without its last field.
TEST(NmeaSatellites, DocumentedGsaGsvAndGrs) {
  std::vector<SatelliteInView> satellites;
  for (const int number : {23, 29, 7, 8, 9, 18, 26, 28}) {
    satellites.push_back({number, std::nullopt, std::nullopt, 40, true});
  }
  const std::vector<double> residuals_m{2.6, 2.2, -1.6, -1.1, -1.7, -1.5, 5.8, 1.7};
  for (std::size_t i = 0; i < satellites.size(); ++i) {
    satellites[i].residual_m = residuals_m[i];
  }
  Epoch epoch;
  epoch.version = Version::v410;
  epoch.time = TimeOfDay{10, 41, 48, 0};
  epoch.fix_dimensions = 3;
  epoch.position_dilution = 1.94;
  epoch.horizontal_dilution = 1.18;
  epoch.vertical_dilution = 1.54;
  epoch.satellites = satellites;
  EXPECT_EQ(text(write_gsa(epoch, 1)),
            "$GPGSA,A,3,23,29,07,08,09,18,26,28,,,,,1.94,1.18,1.54,1*10\r\n");
  epoch.talker = "GN";
  EXPECT_EQ(text(write_grs(epoch, 1)),
            "$GNGRS,104148.00,1,2.6,2.2,-1.6,-1.1,-1.7,-1.5,5.8,1.7,,,,,1,1*52\r\n");
  satellites.assign(9, SatelliteInView{25, std::nullopt, std::nullopt, 40, false});
  epoch.satellites = satellites;
  epoch.talker = "GP";
  EXPECT_EQ(text(write_gsv(epoch, 3)), "$GPGSV,3,3,09,25,,,40,1*6E\r\n");
}

TEST(NmeaSatellites, GstHasTwoSignificantDigitsAsPublishedLinesHave) {
  Epoch epoch;
  epoch.talker = "GN";
  epoch.time = TimeOfDay{9, 12, 0, 54};
  epoch.errors = ErrorStatistics{45.2, 1.21, 0.768, 2.24};
  EXPECT_EQ(text(write_gst(epoch)), "$GNGST,091200.54,45,,,,1.2,0.77,2.2*70\r\n");
  epoch.time = TimeOfDay{14, 7, 59, 75};
  epoch.errors = ErrorStatistics{6.1, 0.46, 0.29, 0.64};
  EXPECT_EQ(text(write_gst(epoch)), "$GNGST,140759.75,6.1,,,,0.46,0.29,0.64*57\r\n");
  epoch.errors = ErrorStatistics{9.96, 0.0996, 0.0144, 9.94};
  EXPECT_THAT(text(write_gst(epoch)), testing::HasSubstr(",10,,,,0.10,0.014,9.9*"));
}

// The document prints the checksum without the two last fields.
TEST(NmeaSatellites, GbsWithoutFault) {
  Epoch epoch;
  epoch.talker = "GN";
  epoch.version = Version::v410;
  epoch.time = TimeOfDay{10, 36, 7, 0};
  epoch.fix_dimensions = 3;
  epoch.errors = ErrorStatistics{0.0, 15.1, 24.2, 31.0};
  EXPECT_EQ(text(write_gbs(epoch)), "$GNGBS,103607.00,15.1,24.2,31.0,,,,,,*6F\r\n");
}

}  // namespace
}  // namespace rigwire::protocols::nmea
