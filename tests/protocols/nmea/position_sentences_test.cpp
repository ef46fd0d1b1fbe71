#include "protocols/nmea/readers.h"
#include "protocols/nmea/writers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "sentences.h"

namespace rigwire::protocols::nmea {
namespace {

TEST(NmeaWriters, PrintTheRecordedEpochByteForByte) {
  std::vector<SatelliteInView> satellites;
  const Epoch epoch = recorded_epoch(satellites);
  EXPECT_EQ(text(write_rmc(epoch)),
            "$GPRMC,195318.00,A,3401.21530,N,11817.41346,W,0.039,,030415,,,D*60\r\n");
  // The recorded receiver computed km/h from unrounded knots and printed 0.073.
  EXPECT_EQ(text(write_vtg(epoch)), "$GPVTG,,T,,M,0.039,N,0.072,K,D*29\r\n");
  EXPECT_EQ(text(write_gga(epoch)),
            "$GPGGA,195318.00,3401.21530,N,11817.41346,W,2,11,1.37,86.1,M,-32.8,M,,0000*5D\r\n");
  EXPECT_EQ(text(write_gsa(epoch, 1)),
            "$GPGSA,A,3,03,23,10,07,27,32,48,51,30,16,09,,2.59,1.37,2.19*06\r\n");
}

TEST(NmeaWriters, ColdStartIsPrintedAsTheRealReceiverDoes) {
  const Epoch epoch;
  EXPECT_EQ(text(write_rmc(epoch)), "$GPRMC,,V,,,,,,,,,,N*53\r\n");
  EXPECT_EQ(text(write_vtg(epoch)), "$GPVTG,,,,,,,,,N*30\r\n");
  EXPECT_EQ(text(write_gga(epoch)), "$GPGGA,,,,,,0,00,99.99,,,,,,*48\r\n");
  EXPECT_EQ(text(write_gsa(epoch, 1)), "$GPGSA,A,1,,,,,,,,,,,,,99.99,99.99,99.99*30\r\n");
  EXPECT_EQ(text(write_gsv(epoch, 1)), "$GPGSV,1,1,00*79\r\n");
  EXPECT_EQ(text(write_gll(epoch)), "$GPGLL,,,,,,V,N*64\r\n");
}

TEST(NmeaWriters, TextsOfTheBannerHaveTheRecordedChecksums) {
  EXPECT_EQ(text(write_txt("GP", TextKind::notice, "u-blox ag - www.u-blox.com")),
            "$GPTXT,01,01,02,u-blox ag - www.u-blox.com*50\r\n");
  EXPECT_EQ(text(write_txt("GP", TextKind::warning, "NMEA unknown msg")),
            "$GPTXT,01,01,01,NMEA unknown msg*58\r\n");
}

TEST(NmeaWriters, MinutesNeverReachSixty) {
  Epoch epoch;
  epoch.fix_dimensions = 3;
  epoch.latitude_deg = 49.99999999999;
  epoch.longitude_deg = -0.99999999999;
  EXPECT_THAT(text(write_gll(epoch)), testing::StartsWith("$GPGLL,5000.00000,N,00100.00000,W,"));
}

TEST(NmeaWriters, PolesAndDateLine) {
  Epoch epoch;
  epoch.fix_dimensions = 3;
  epoch.latitude_deg = -90.0;
  epoch.longitude_deg = -180.0;
  EXPECT_THAT(text(write_gll(epoch)), testing::StartsWith("$GPGLL,9000.00000,S,18000.00000,W,"));
  epoch.latitude_deg = 90.0;
  epoch.longitude_deg = 179.9999999999;
  EXPECT_THAT(text(write_gll(epoch)), testing::StartsWith("$GPGLL,9000.00000,N,18000.00000,E,"));
}

TEST(NmeaWriters, HeightsBelowTheSeaAndAboveTheClouds) {
  Epoch epoch;
  epoch.fix_dimensions = 3;
  epoch.altitude_m = -400.04;
  EXPECT_THAT(text(write_gga(epoch)), testing::HasSubstr(",-400.0,M,0.0,M,,*"));
  epoch.altitude_m = 9000.06;
  epoch.separation_m = -0.04;
  EXPECT_THAT(text(write_gga(epoch)), testing::HasSubstr(",9000.1,M,0.0,M,,*"));
}

TEST(NmeaWriters, CourseNeverPrints360) {
  Epoch epoch;
  epoch.fix_dimensions = 3;
  epoch.course_deg = 359.997;
  EXPECT_THAT(text(write_vtg(epoch)), testing::StartsWith("$GPVTG,0.00,T,"));
}

TEST(NmeaWriters, Version21HasNoModeField) {
  Epoch epoch;
  epoch.version = Version::v21;
  EXPECT_THAT(text(write_rmc(epoch)), testing::StartsWith("$GPRMC,,V,,,,,,,,,*"));
}

// Published lines of receivers with versions 2.3 to 4.11.
Epoch examples() {
  Epoch epoch;
  epoch.version = Version::v410;
  epoch.time = TimeOfDay{8, 35, 59, 0};
  epoch.date = Date{2002, 12, 9};
  epoch.fix_dimensions = 3;
  epoch.latitude_deg = 47.0 + 17.11437 / 60.0;
  epoch.longitude_deg = 8.0 + 33.91522 / 60.0;
  epoch.ground_speed_mps = 0.004 * 1852.0 / 3600.0;
  epoch.course_deg = 77.52;
  return epoch;
}

// The document prints the checksum of the line without its last field.
TEST(NmeaWriters, Version410PrintsTheDocumentsRmc) {
  EXPECT_EQ(text(write_rmc(examples())),
            "$GPRMC,083559.00,A,4717.11437,N,00833.91522,E,0.004,77.52,091202,,,A,V*2D\r\n");
}

TEST(NmeaWriters, GnsOfTheDocumentAndOfAColdReceiver) {
  Epoch epoch = examples();
  epoch.talker = "GN";
  epoch.systems = system_bit(System::gps);
  epoch.time = TimeOfDay{10, 36, 0, 1};
  epoch.latitude_deg = 51.0 + 14.51176 / 60.0;
  epoch.longitude_deg = -12.29380 / 60.0;
  epoch.satellites_used = 7;
  epoch.horizontal_dilution = 1.18;
  epoch.altitude_m = 111.5;
  epoch.separation_m = 45.6;
  EXPECT_EQ(text(write_gns(epoch)),
            "$GNGNS,103600.01,5114.51176,N,00012.29380,W,ANNN,07,1.18,111.5,45.6,,,V*00\r\n");
  Epoch cold;
  cold.talker = "GN";
  cold.version = Version::v40;
  cold.time = TimeOfDay{18, 16, 4, 0};
  EXPECT_EQ(text(write_gns(cold)), "$GNGNS,181604.00,,,,,NN,00,99.99,,,,*59\r\n");
}

TEST(NmeaWriters, DtmIsAlwaysWgs84) {
  EXPECT_EQ(text(write_dtm({})), "$GPDTM,W84,,0.0,N,0.0,E,0.0,W84*6F\r\n");
}

TEST(NmeaWriters, CarrierSolutionsAreToldByVersion) {
  struct Case {
    Version version;
    CarrierFix carrier;
    const char* quality;
    const char* rmc_mode;
  };
  for (const auto& c : {Case{Version::v410, CarrierFix::floating, ",E,5,", ",F,V*"},
                        Case{Version::v411, CarrierFix::fixed, ",E,4,", ",R,V*"},
                        Case{Version::v40, CarrierFix::fixed, ",E,4,", ",R*"},
                        Case{Version::v23, CarrierFix::fixed, ",E,2,", ",D*"}}) {
    Epoch epoch = examples();
    epoch.version = c.version;
    epoch.carrier = c.carrier;
    epoch.differential = true;
    epoch.differential_age_s = 1.0;
    epoch.station = 23;
    EXPECT_THAT(text(write_gga(epoch)), testing::HasSubstr(c.quality));
    EXPECT_THAT(text(write_gga(epoch)), testing::HasSubstr(",M,1.0,0023*"));
    EXPECT_THAT(text(write_rmc(epoch)), testing::HasSubstr(c.rmc_mode));
    EXPECT_THAT(text(write_gll(epoch)), testing::HasSubstr(",A,D*"));
    EXPECT_THAT(text(write_vtg(epoch)), testing::HasSubstr(",K,D*"));
  }
}

TEST(NmeaWriters, StationOfSbasCorrectionsIsItsPrnAndEmptyWithoutCorrections) {
  std::vector<SatelliteInView> satellites;
  Epoch epoch = recorded_epoch(satellites);
  epoch.station = 138;
  EXPECT_THAT(text(write_gga(epoch)), testing::HasSubstr(",-32.8,M,,0138*"));
  epoch.differential = false;
  EXPECT_THAT(text(write_gga(epoch)), testing::HasSubstr(",-32.8,M,,*"));
}

TEST(NmeaWriters, HighPrecisionAndCompatibleDecimals) {
  Epoch epoch = examples();
  epoch.altitude_m = 499.6004;
  epoch.precision = Precision::high;
  EXPECT_THAT(text(write_gga(epoch)),
              testing::HasSubstr(",4717.1143700,N,00833.9152200,E,1,00,99.99,499.600,M,0.0,M,"));
  epoch.precision = Precision::compatible;
  EXPECT_THAT(text(write_gga(epoch)),
              testing::HasSubstr(",4717.1144,N,00833.9152,E,1,00,99.99,499.6,M,"));
}

TEST(NmeaWriters, NothingPrintsANegativeZero) {
  Epoch epoch = examples();
  epoch.latitude_deg = -1e-9;
  epoch.longitude_deg = -1e-9;
  epoch.altitude_m = -0.04;
  epoch.separation_m = -0.0;
  EXPECT_THAT(text(write_gga(epoch)), testing::HasSubstr(",0000.00000,N,00000.00000,E,1,"));
  EXPECT_THAT(text(write_gga(epoch)), testing::HasSubstr(",0.0,M,0.0,M,,*"));
}

TEST(NmeaWriters, PositionsAreWithinHalfAUnit) {
  std::mt19937_64 random(20260601);
  std::uniform_real_distribution<double> latitude(-90.0, 90.0);
  std::uniform_real_distribution<double> longitude(-180.0, 180.0);
  std::vector<std::pair<double, double>> places{
      {90.0, 180.0},
      {-90.0, -180.0},
      {0.0, 0.0},
      {-0.0, -0.0},
      {1e-9, -1e-9},
      {59.0 + 59.999999 / 60.0, -(179.0 + 59.999999 / 60.0)},
      {-1.0 / 60.0, 1.0 / 60.0}};
  for (int i = 0; i < 3000; ++i) {
    places.emplace_back(latitude(random), longitude(random));
  }
  for (const auto& [lat, lon] : places) {
    for (const auto& [precision, unit_min] :
         {std::pair{Precision::normal, 1e-5}, std::pair{Precision::high, 1e-7}}) {
      Epoch epoch = examples();
      epoch.latitude_deg = lat;
      epoch.longitude_deg = lon;
      epoch.precision = precision;
      const std::string line = text(write_gll(epoch));
      const auto gll = read_gll(*decode_sentence(bytes_of(line)));
      ASSERT_TRUE(gll.ok()) << line;
      // A hundredth of a unit for the doubles between here and there.
      ASSERT_NEAR(gll->latitude_deg, lat, 0.51 * unit_min / 60.0) << line;
      ASSERT_NEAR(gll->longitude_deg, lon, 0.51 * unit_min / 60.0) << line;
    }
  }
}

}  // namespace
}  // namespace rigwire::protocols::nmea
