#include "protocols/nmea/writers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sentences.h"

namespace rigwire::protocols::nmea {
namespace {

TEST(NmeaPubx, PositionOfAPublishedLine) {
  Epoch epoch;
  epoch.time = TimeOfDay{10, 36, 7, 0};
  epoch.fix_dimensions = 3;
  epoch.latitude_deg = 53.0 + 27.03942 / 60.0;
  epoch.longitude_deg = -(2.0 + 14.42462 / 60.0);
  epoch.altitude_m = 55.961;
  epoch.separation_m = 48.5;
  epoch.horizontal_accuracy_m = 29.2;
  epoch.vertical_accuracy_m = 31.4;
  epoch.ground_speed_mps = 0.085 / 3.6;
  epoch.course_deg = 39.63;
  epoch.down_velocity_mps = -0.007;
  epoch.horizontal_dilution = 5.88;
  epoch.vertical_dilution = 7.62;
  epoch.time_dilution = 8.09;
  epoch.satellites_used = 6;
  EXPECT_EQ(text(write_pubx_position(epoch)),
            "$PUBX,00,103607.00,5327.03942,N,00214.42462,W,104.461,G3,29,31,0.085,39.63,-0.007,,"
            "5.88,7.62,8.09,6,0,0*69\r\n");
}

TEST(NmeaPubx, PositionWithoutFixIsZeroAndNotEmpty) {
  Epoch epoch;
  epoch.time = TimeOfDay{0, 7, 17, 0};
  epoch.latitude_deg = 50.0;
  epoch.horizontal_accuracy_m = 5'303'316.0;
  epoch.vertical_accuracy_m = 3'750'010.0;
  EXPECT_EQ(text(write_pubx_position(epoch)),
            "$PUBX,00,000717.00,0000.00000,N,00000.00000,E,0.000,NF,5303316,3750010,0.000,0.00,"
            "0.000,,99.99,99.99,99.99,0,0,0*2C\r\n");
}

TEST(NmeaPubx, StatesOfTheFix) {
  Epoch epoch;
  epoch.fix_dimensions = 2;
  EXPECT_THAT(text(write_pubx_position(epoch)), testing::HasSubstr(",G2,"));
  epoch.differential = true;
  EXPECT_THAT(text(write_pubx_position(epoch)), testing::HasSubstr(",D2,"));
  epoch.fix_dimensions = 3;
  EXPECT_THAT(text(write_pubx_position(epoch)), testing::HasSubstr(",D3,"));
}

SatelliteInView tracked(int number, bool used, bool ephemeris, int locked_s) {
  SatelliteInView satellite{number, 36, 100, 40, used};
  satellite.single_number = number;
  satellite.ephemeris = ephemeris;
  satellite.locked_s = locked_s;
  return satellite;
}

TEST(NmeaPubx, SatellitesWithStateAndLock) {
  std::vector<SatelliteInView> satellites{
      tracked(5, true, true, 1000), tracked(120, false, true, 7), tracked(255, false, false, 0)};
  satellites[2].elevation_deg = -2;
  satellites[2].cn0_dbhz = std::nullopt;
  Epoch epoch;
  EXPECT_EQ(text(write_pubx_satellites(epoch)), "$PUBX,03,00*1C\r\n");
  epoch.satellites = satellites;
  EXPECT_THAT(text(write_pubx_satellites(epoch)),
              testing::StartsWith("$PUBX,03,03,5,U,100,36,40,064,120,e,100,36,40,007,"
                                  "255,-,100,-2,,000*"));
}

TEST(NmeaPubx, LongestListOfSatellitesIsNotCut) {
  const std::vector<SatelliteInView> satellites(60, tracked(120, true, true, 64));
  Epoch epoch;
  epoch.satellites = satellites;
  EXPECT_THAT(text(write_pubx_satellites(epoch)), testing::HasSubstr("120,U,100,36,40,064*"));
  EXPECT_THAT(text(write_pubx_satellites(epoch)), testing::StartsWith("$PUBX,03,40,"));
}

TEST(NmeaPubx, TimeOfAPublishedLineOfAUblox7) {
  Epoch epoch;
  epoch.time = TimeOfDay{20, 26, 4, 0};
  epoch.date = Date{2024, 8, 15};
  PubxTime time{41'916'400, 2327, 18, true, -672'045.0, -11'949.632, 21};
  EXPECT_EQ(text(write_pubx_time(epoch, time)),
            "$PUBX,04,202604.00,150824,419164.00,2327,18,-672045,-11949.632,21*11\r\n");
  time.leap_seconds_received = false;
  EXPECT_THAT(text(write_pubx_time(epoch, time)), testing::HasSubstr(",2327,18D,-672045,"));
}

}  // namespace
}  // namespace rigwire::protocols::nmea
