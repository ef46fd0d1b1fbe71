#include "protocols/nmea/readers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include "protocols/nmea/writers.h"
#include "sentences.h"

namespace rigwire::protocols::nmea {
namespace {

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

std::string line_of(std::string_view content) {
  std::array<char, 8> tail{};
  std::snprintf(tail.data(), tail.size(), "*%02X\r\n", checksum(content));
  return "$" + std::string(content) + tail.data();
}

TEST(NmeaReaders, RecordedLinesOfTheOthers) {
  const std::string vtg = "$GPVTG,,T,,M,0.039,N,0.073,K,D*28\r\n";
  EXPECT_NEAR(*read_vtg(*decode_sentence(bytes_of(vtg)))->ground_speed_mps, 0.073 / 3.6, 1e-12);
  const std::string gsv = "$GPGSV,4,4,15,46,47,145,,48,47,205,46,51,49,161,50*4C\r\n";
  const auto page = read_gsv(*decode_sentence(bytes_of(gsv)));
  ASSERT_TRUE(page.ok());
  EXPECT_EQ(page->satellite_count, 3U);
  EXPECT_EQ(page->satellites[0].cn0_dbhz, std::nullopt);
  EXPECT_EQ(page->satellites[2].azimuth_deg, 161);
  EXPECT_EQ(page->signal, std::nullopt);
  const std::string signal = "$GPGSV,1,1,03,12,,,42,24,,,47,32,,,37,5*66\r\n";
  EXPECT_EQ(read_gsv(*decode_sentence(bytes_of(signal)))->signal, 5);
  const std::string gsa = "$GPGSA,A,3,23,29,07,08,09,18,26,28,,,,,1.94,1.18,1.54,1*10\r\n";
  const auto active = read_gsa(*decode_sentence(bytes_of(gsa)));
  ASSERT_TRUE(active.ok());
  EXPECT_EQ(active->used_count, 8U);
  EXPECT_EQ(active->system, 1);
  EXPECT_EQ(active->vertical_dilution, 1.54);
  const std::string gst = "$GNGST,091200.54,45,,,,1.2,0.77,2.2*70\r\n";
  EXPECT_EQ(read_gst(*decode_sentence(bytes_of(gst)))->longitude_m, 0.77);
  const std::string zda = "$GNZDA,140759.75,23,02,2016,00,00*72\r\n";
  EXPECT_EQ(read_zda(*decode_sentence(bytes_of(zda)))->date, (Date{2016, 2, 23}));
}

TEST(NmeaReaders, ValuesOutOfRangeAreMalformed) {
  for (const char* const content :
       {"GPGSV,2,3,09,01,10,020,30", "GPGSV,1,1,01,01,91,020,30", "GPGSV,1,1,01,01,10,x,30",
        "GPGSV,1,1,01,01,10", "GPGSA,A,4,,,,,,,,,,,,,1.0,1.0,1.0", "GPGSA,A,3,1.0,1.0,1.0",
        "GPVTG,361,T,,M,0.0,N,0.0,K,A", "GPVTG,,T,,M,0.0,N,-1.0,K,A",
        "GPZDA,000000.00,32,01,2026,00,00", "GPZDA,000000.00,,01,2026,00,00",
        "GPGST,000000.00,x,,,,1,1,1", "GPGLL,,,,,,A,A", "GPGLL,4717.1,N,00833.9,E,240000.00,A,A"}) {
    const std::string line = line_of(content);
    const auto view = decode_sentence(bytes_of(line));
    ASSERT_TRUE(view.ok()) << content;
    EXPECT_FALSE(read_gsv(*view).ok() || read_gsa(*view).ok() || read_vtg(*view).ok() ||
                 read_zda(*view).ok() || read_gst(*view).ok() || read_gll(*view).ok())
        << content;
  }
}

}  // namespace
}  // namespace rigwire::protocols::nmea
