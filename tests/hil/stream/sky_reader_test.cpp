#include "hil/stream/sky_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "protocols/nmea/sentence.h"
#include "protocols/ubx/layout.h"
#include "protocols/ubx/navigation.h"

namespace rigwire::hil {
namespace {

using testing::ElementsAre;
using testing::Field;
using testing::IsEmpty;
using testing::SizeIs;

using Sky = std::vector<SkySatellite>;

std::string sky_sentence(const std::string& body) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  const unsigned sum = protocols::nmea::checksum(body);
  return "$" + body + "*" + kDigits[sum / 16] + kDigits[sum % 16] + "\r\n";
}

std::vector<Sky> read(SkyReader& reader, std::string_view bytes, std::string* message = nullptr) {
  std::vector<Sky> all;
  reader.take({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()},
              [&](std::string_view of, std::span<const SkySatellite> sky) {
                all.emplace_back(sky.begin(), sky.end());
                if (message != nullptr) {
                  *message = of;
                }
              });
  return all;
}

TEST(SkyReader, JoinsThePagesOfGsvWithWhatGsaUses) {
  SkyReader reader;
  const auto told =
      read(reader, sky_sentence("GPGSA,A,3,05,,,,,,,,,,,,2.0,1.0,1.7") +
                       sky_sentence("GPGSV,2,1,05,05,60,120,44,07,30,200,,09,10,300,31,"
                                    "12,,,") +
                       sky_sentence("GPGSV,2,2,05,33,25,180,38"));
  ASSERT_THAT(told, SizeIs(1));
  ASSERT_THAT(told[0], SizeIs(4)) << "the one without a direction is left out";
  EXPECT_EQ(told[0][0].name, "GPS 5");
  EXPECT_EQ(told[0][0].azimuth_deg, 120);
  EXPECT_EQ(told[0][0].elevation_deg, 60);
  EXPECT_EQ(told[0][0].cn0_dbhz, 44);
  EXPECT_THAT(told[0],
              ElementsAre(Field(&SkySatellite::used, true), Field(&SkySatellite::used, false),
                          Field(&SkySatellite::used, false), Field(&SkySatellite::used, false)));
  EXPECT_EQ(told[0][1].cn0_dbhz, 0) << "it is not received";
  EXPECT_EQ(told[0][3].name, "SBAS 33");
}

TEST(SkyReader, WhatWasUsedBeforeIsForgottenWithTheNextEpoch) {
  SkyReader reader;
  const std::string view = sky_sentence("GPGSV,1,1,02,05,60,120,44,07,30,200,41");
  (void)read(reader, sky_sentence("GPGSA,A,3,05,,,,,,,,,,,,2.0,1.0,1.7") + view);
  const auto told = read(reader, sky_sentence("GPGSA,A,3,07,,,,,,,,,,,,2.0,1.0,1.7") + view);
  ASSERT_THAT(told, SizeIs(1));
  EXPECT_FALSE(told[0][0].used);
  EXPECT_TRUE(told[0][1].used);
}

TEST(SkyReader, SystemsOfTheSameNumbersAreToldApart) {
  SkyReader reader;
  const auto told = read(reader, sky_sentence("GNGSA,A,3,05,,,,,,,,,,,,2.0,1.0,1.7,1") +
                                     sky_sentence("GPGSV,1,1,01,05,60,120,44,1") +
                                     sky_sentence("GAGSV,1,1,01,05,20,010,40,7"));
  ASSERT_THAT(told, SizeIs(2));
  for (const SkySatellite& one : told[1]) {
    EXPECT_EQ(one.used, one.name == "GPS 5") << one.name;
  }
}

// A ZED-F9P: a group for each signal, and one with signal 0 for what is not received.
TEST(SkyReader, GroupsOfSeveralSignalsOfASystemAreOneSky) {
  SkyReader reader;
  const std::string epoch = sky_sentence("GNGSA,A,3,05,07,,,,,,,,,,,2.0,1.0,1.7,1") +
                            sky_sentence("GPGSV,1,1,02,05,60,120,44,07,30,200,41,1") +
                            sky_sentence("GPGSV,1,1,02,05,60,120,39,07,30,200,,6") +
                            sky_sentence("GPGSV,1,1,01,09,10,300,,0") +
                            sky_sentence("GLGSV,1,1,01,70,20,040,33,1");
  (void)read(reader, epoch);
  for (const Sky& sky : read(reader, epoch)) {
    ASSERT_THAT(sky, SizeIs(4)) << "a group does not replace another";
    EXPECT_THAT(
        sky,
        ElementsAre(Field(&SkySatellite::name, "GPS 5"), Field(&SkySatellite::name, "GPS 7"),
                    Field(&SkySatellite::name, "GPS 9"), Field(&SkySatellite::name, "GLONASS 70")));
    EXPECT_EQ(sky[0].cn0_dbhz, 44) << "the strongest signal";
    EXPECT_EQ(sky[1].cn0_dbhz, 41);
    EXPECT_EQ(sky[2].cn0_dbhz, 0);
    EXPECT_TRUE(sky[0].used && sky[1].used && !sky[2].used && !sky[3].used);
  }
}

TEST(SkyReader, AGroupThatIsSentNoMoreIsForgotten) {
  SkyReader reader;
  const std::string first = sky_sentence("GPGSV,1,1,01,05,60,120,44,1");
  (void)read(reader, first + sky_sentence("GPGSV,1,1,01,09,10,300,,0"));
  EXPECT_THAT(read(reader, first), ElementsAre(SizeIs(2))) << "it can still come in this round";
  EXPECT_THAT(read(reader, first), ElementsAre(SizeIs(1)));
}

TEST(SkyReader, ReadsNavSat) {
  using protocols::ubx::NavSatBlock;
  using protocols::ubx::NavSatHead;
  std::vector<std::uint8_t> frame(protocols::ubx::kOverheadBytes + NavSatHead::kLength +
                                  2 * NavSatBlock::kLength);
  NavSatHead head;
  head.satellites = 2;
  NavSatBlock used;
  used.system = 2;
  used.satellite = 11;
  used.cn0_dbhz = 40;
  used.elevation_deg = -3;
  used.azimuth_deg = 359;
  used.flags = protocols::ubx::kSatUsed;
  NavSatBlock unknown;
  unknown.elevation_deg = -91;
  const auto payload = std::span(frame).subspan(protocols::ubx::kHeaderBytes);
  write_payload(head, payload.first(NavSatHead::kLength));
  write_payload(used, payload.subspan(NavSatHead::kLength, NavSatBlock::kLength));
  write_payload(unknown,
                payload.subspan(NavSatHead::kLength + NavSatBlock::kLength, NavSatBlock::kLength));
  protocols::ubx::seal_frame(NavSatHead::kId, frame);
  SkyReader reader;
  std::string message;
  const auto told =
      read(reader, {reinterpret_cast<const char*>(frame.data()), frame.size()}, &message);
  ASSERT_THAT(told, SizeIs(1));
  EXPECT_EQ(message, "NAV-SAT");
  ASSERT_THAT(told[0], SizeIs(1));
  EXPECT_EQ(told[0][0].name, "Galileo 11");
  EXPECT_EQ(told[0][0].elevation_deg, -3);
  EXPECT_TRUE(told[0][0].used);
}

TEST(SkyReader, PagesWithoutEndAreNoSky) {
  SkyReader reader;
  std::string pages;
  for (int i = 0; i < 1000; ++i) {
    pages += sky_sentence("GPGSV,3,2,12,05,60,120,44,07,30,200,41,08,30,200,41,09,30,200,41");
  }
  EXPECT_THAT(read(reader, pages), IsEmpty());
}

}  // namespace
}  // namespace rigwire::hil
