#include "protocols/nmea/position_sentences.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace rigwire::protocols::nmea {
namespace {

std::string text(Sentence sentence) {
  return std::string(sentence.text());
}

std::span<const std::uint8_t> bytes_of(const std::string& s) {
  return {reinterpret_cast<const std::uint8_t*>(s.data()), s.size()};
}

// An epoch recorded from a NEO-7P.
Epoch recorded_epoch(std::vector<SatelliteInView>& satellites) {
  for (const int number : {3, 23, 10, 7, 27, 32, 48, 51, 30, 16, 9}) {
    satellites.push_back({number, 10, 20, 30, true});
  }
  Epoch epoch;
  epoch.time = TimeOfDay{19, 53, 18, 0};
  epoch.date = Date{2015, 4, 3};
  epoch.fix_dimensions = 3;
  epoch.differential = true;
  epoch.latitude_deg = 34.0 + 1.21530 / 60.0;
  epoch.longitude_deg = -(118.0 + 17.41346 / 60.0);
  epoch.altitude_m = 86.1;
  epoch.separation_m = -32.8;
  epoch.ground_speed_mps = 0.039 * 1852.0 / 3600.0;
  epoch.satellites_used = 11;
  epoch.position_dilution = 2.59;
  epoch.horizontal_dilution = 1.37;
  epoch.vertical_dilution = 2.19;
  epoch.satellites = satellites;
  return epoch;
}

TEST(NmeaWriters, PrintTheRecordedEpochByteForByte) {
  std::vector<SatelliteInView> satellites;
  const Epoch epoch = recorded_epoch(satellites);
  EXPECT_EQ(text(write_rmc(epoch)),
            "$GPRMC,195318.00,A,3401.21530,N,11817.41346,W,0.039,,030415,,,D*60\r\n");
  // The recorded receiver computed km/h from unrounded knots and printed 0.073.
  EXPECT_EQ(text(write_vtg(epoch)), "$GPVTG,,T,,M,0.039,N,0.072,K,D*29\r\n");
  EXPECT_EQ(text(write_gga(epoch)),
            "$GPGGA,195318.00,3401.21530,N,11817.41346,W,2,11,1.37,86.1,M,-32.8,M,,0000*5D\r\n");
  EXPECT_EQ(text(write_gsa(epoch)),
            "$GPGSA,A,3,03,23,10,07,27,32,48,51,30,16,09,,2.59,1.37,2.19*06\r\n");
}

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

TEST(NmeaWriters, ColdStartIsPrintedAsTheRealReceiverDoes) {
  const Epoch epoch;
  EXPECT_EQ(text(write_rmc(epoch)), "$GPRMC,,V,,,,,,,,,,N*53\r\n");
  EXPECT_EQ(text(write_vtg(epoch)), "$GPVTG,,,,,,,,,N*30\r\n");
  EXPECT_EQ(text(write_gga(epoch)), "$GPGGA,,,,,,0,00,99.99,,,,,,*48\r\n");
  EXPECT_EQ(text(write_gsa(epoch)), "$GPGSA,A,1,,,,,,,,,,,,,99.99,99.99,99.99*30\r\n");
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
  EXPECT_THAT(text(write_gga(epoch)), testing::HasSubstr(",-400.0,M,0.0,M,,0000*"));
  epoch.altitude_m = 9000.06;
  epoch.separation_m = -0.04;
  EXPECT_THAT(text(write_gga(epoch)), testing::HasSubstr(",9000.1,M,0.0,M,,0000*"));
}

TEST(NmeaWriters, CourseNeverPrints360) {
  Epoch epoch;
  epoch.fix_dimensions = 3;
  epoch.course_deg = 359.997;
  EXPECT_THAT(text(write_vtg(epoch)), testing::StartsWith("$GPVTG,0.00,T,"));
}

TEST(NmeaWriters, Version21HasNoModeField) {
  Epoch epoch;
  epoch.with_mode = false;
  EXPECT_THAT(text(write_rmc(epoch)), testing::StartsWith("$GPRMC,,V,,,,,,,,,*"));
}

TEST(NmeaReaders, ReadWhatTheWritersPrint) {
  std::vector<SatelliteInView> satellites;
  const Epoch epoch = recorded_epoch(satellites);
  const std::string rmc_text = text(write_rmc(epoch));
  const auto rmc = read_rmc(*decode_sentence(bytes_of(rmc_text)));
  ASSERT_TRUE(rmc.ok());
  EXPECT_TRUE(rmc->valid);
  EXPECT_NEAR(rmc->latitude_deg, epoch.latitude_deg, 1e-7);
  EXPECT_NEAR(rmc->longitude_deg, epoch.longitude_deg, 1e-7);
  EXPECT_EQ(rmc->time, epoch.time);
  EXPECT_EQ(rmc->date, epoch.date);
  EXPECT_FALSE(rmc->course_deg.has_value());
  const std::string gga_text = text(write_gga(epoch));
  const auto gga = read_gga(*decode_sentence(bytes_of(gga_text)));
  ASSERT_TRUE(gga.ok());
  EXPECT_EQ(gga->quality, 2);
  EXPECT_DOUBLE_EQ(gga->altitude_m, 86.1);
  EXPECT_DOUBLE_EQ(gga->separation_m, -32.8);
  EXPECT_EQ(gga->satellites_used, 11);
}

TEST(NmeaReaders, NoFixHasNoPosition) {
  const std::string gga_text = text(write_gga({}));
  const auto gga = read_gga(*decode_sentence(bytes_of(gga_text)));
  ASSERT_TRUE(gga.ok());
  EXPECT_EQ(gga->quality, 0);
  EXPECT_FALSE(gga->horizontal_dilution.has_value());
  const std::string rmc_text = text(write_rmc({}));
  const auto rmc = read_rmc(*decode_sentence(bytes_of(rmc_text)));
  ASSERT_TRUE(rmc.ok());
  EXPECT_FALSE(rmc->valid);
}

TEST(NmeaReaders, StrangeNumbersAreMalformed) {
  for (const char* const latitude : {"34x1.2", "3460.0", "9100.0", "34-1.0", "34nan", "34"}) {
    Sentence sentence("GPGGA");
    sentence.field("195318.00").field(latitude).field("N").field("11817.4").field("W");
    sentence.field("1").field("05").field("1.0").field("1.0").field("M").field("0.0").field("M");
    sentence.empty().field("0000");
    const std::string line(sentence.text());
    const auto view = decode_sentence(bytes_of(line));
    ASSERT_TRUE(view.ok());
    EXPECT_TRUE(read_gga(*view).malformed()) << latitude;
  }
}

TEST(NmeaSentence, TellsIncompleteFromMalformed) {
  const std::string good = "$GPGLL,,,,,,V,N*64\r\n";
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_TRUE(decode_sentence(bytes_of(good).first(size)).incomplete()) << size;
  }
  EXPECT_EQ(decode_sentence(bytes_of(good)).consumed(), good.size());
  for (const char* const bad : {"GPGLL*00\r\n", "$GPGLL,,,,,,V,N*65\r\n", "$GPGLL,,,,,,V,N\r\n",
                                "$GP\x01*00\r\n", "$*0G\n", "$GP$GPGLL,,,,,,V,N*64\r\n", "$\n"}) {
    const std::string line = bad;
    EXPECT_TRUE(decode_sentence(bytes_of(line)).malformed()) << bad;
  }
}

TEST(NmeaSentence, EndlessLineIsMalformed) {
  const std::string line = "$" + std::string(1000, 'A');
  EXPECT_TRUE(decode_sentence(bytes_of(line)).malformed());
}

TEST(NmeaSentence, SplitsFields) {
  const std::string line = "$PUBX,40,GLL,1,0,0,0,0,0*5D\n";
  const auto view = decode_sentence(bytes_of(line));
  ASSERT_TRUE(view.ok());
  EXPECT_EQ(view->address, "PUBX");
  EXPECT_EQ(view->type(), "PUBX");
  EXPECT_EQ(view->field_count, 8U);
  EXPECT_EQ(view->field(1), "GLL");
  EXPECT_EQ(view->field(8), "");
}

}  // namespace
}  // namespace rigwire::protocols::nmea
