// The suite nmea on what a receiver said, right and with one thing wrong at a time.
#include "conform/nmea/nmea_suite.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/rtcm3/frame.h"
#include "protocols/ubx/frame.h"
#include "suite_verdicts.h"

namespace rigwire::conform {
namespace {

using std::chrono::milliseconds;

std::string checked(const std::string& body) {
  unsigned check = 0;
  for (const char c : body) {
    check ^= static_cast<unsigned char>(c);
  }
  std::array<char, 8> end{};
  std::snprintf(end.data(), end.size(), "*%02X\r\n", check);
  return "$" + body + end.data();
}

/// Twelve seconds of a receiver of 1 Hz with nine satellites of two systems.
std::vector<std::string> bodies() {
  std::vector<std::string> all;
  for (int second = 0; second < 12; ++second) {
    std::array<char, 16> time{};
    std::snprintf(time.data(), time.size(), "0802%02d.00", second);
    const std::string t = time.data();
    const std::string place = "4925.48213,N,00745.10221,E";
    all.push_back("GNRMC," + t + ",A," + place + ",1.004,87.12,010626,,,D");
    all.push_back("GNVTG,87.12,T,,M,1.004,N,1.860,K,D");
    all.push_back("GNGGA," + t + "," + place + ",2,09,0.98,240.1,M,48.0,M,1.0,0120");
    all.push_back("GNGSA,A,3,02,05,07,13,20,,,,,,,,1.86,0.98,1.58");
    all.push_back("GNGSA,A,3,65,66,74,81,,,,,,,,,1.86,0.98,1.58");
    all.push_back("GPGSV,2,1,05,02,35,120,41,05,71,020,44,07,22,300,38,13,15,210,35");
    all.push_back("GPGSV,2,2,05,20,44,080,43");
    all.push_back("GLGSV,1,1,04,65,51,100,40,66,33,010,37,74,20,250,33,81,12,330,30");
    all.push_back("GNGLL," + place + "," + t + ",A,D");
  }
  return all;
}

SuiteResult judge(const std::string& text, const NmeaClaims& claims = {}) {
  NmeaLog log;
  // In pieces, as a line delivers them.
  for (std::size_t at = 0; at < text.size(); at += 100) {
    const std::string piece = text.substr(at, 100);
    log.add(milliseconds(at), {reinterpret_cast<const std::uint8_t*>(piece.data()), piece.size()});
  }
  log.close();
  return run_nmea_suite(log, claims, {});
}

std::string said(const std::vector<std::string>& all) {
  std::string text;
  for (const std::string& body : all) {
    text += checked(body);
  }
  return text;
}

const NmeaClaims kClaims{{"RMC", "VTG", "GGA", "GSA", "GSV", "GLL"}, 1.0};

TEST(NmeaSuite, AReceiverThatIsRightFailsNowhere) {
  const SuiteResult result = judge(said(bodies()), kClaims);
  EXPECT_THAT(wrong_ids(result), testing::IsEmpty());
  EXPECT_GT(result.count(Verdict::pass), 30U);
  EXPECT_EQ(result.count(Verdict::not_applicable), 0U);
}

TEST(NmeaSuite, BinaryBetweenSentencesIsNotTheirs) {
  std::string text = said(bodies());
  text.insert(text.find("$GNVTG"), std::string("\xB5\x62\x01\x07\x00\x00\x08\x19", 8));
  EXPECT_THAT(wrong_ids(judge(text, kClaims)), testing::IsEmpty());
}

// A receiver with UBX and RTCM on beside NMEA; whatever bytes their payloads have.
TEST(NmeaSuite, MessagesOfOtherProtocolsOnTheLineAreNoSentences) {
  constexpr std::string_view kPayload = "$GNRMC,1*00\n$$!x\n\r\n";
  std::vector<std::uint8_t> ubx(protocols::ubx::kOverheadBytes + kPayload.size());
  std::ranges::copy(kPayload, ubx.begin() + protocols::ubx::kHeaderBytes);
  protocols::ubx::seal_frame({0x01, 0x07}, ubx);
  std::vector<std::uint8_t> rtcm(protocols::rtcm3::kGreatestFrame);
  rtcm.resize(protocols::rtcm3::encode_frame(
      {reinterpret_cast<const std::uint8_t*>(kPayload.data()), kPayload.size()}, rtcm));
  const std::string binary =
      std::string(ubx.begin(), ubx.end()) + std::string(rtcm.begin(), rtcm.end());
  std::string text;
  for (const std::string& body : bodies()) {
    text += binary + checked(body);
  }
  const SuiteResult result = judge(text, kClaims);
  EXPECT_THAT(wrong_ids(result), testing::IsEmpty());
}

TEST(NmeaSuite, DilutionsOfOneDecimalAreRounded) {
  std::string text;
  for (std::string body : bodies()) {
    if (const std::size_t at = body.find("1.86,0.98,1.58"); at != std::string::npos) {
      body.replace(at, 14, "1.8,0.9,1.5");  // of a recording
    }
    text += checked(body);
  }
  EXPECT_THAT(wrong_ids(judge(text)), testing::Not(testing::Contains("nmea/together/10")));
}

struct Mutant {
  const char* name;
  const char* id;  ///< Identity of the case that has to find it.
  std::string from;
  std::string to;
  bool in_text = false;  ///< Changes the whole line with its check, else before that is made.
};

class NmeaMutant : public testing::TestWithParam<Mutant> {};

TEST_P(NmeaMutant, IsFoundByItsCase) {
  const Mutant& mutant = GetParam();
  std::string text;
  int count = 0;
  bool changed = false;
  const auto change = [&](std::string& line) {
    const std::size_t at = line.find(mutant.from);
    // In the sixth epoch and after it.
    if (at != std::string::npos && ++count > 5 && !changed) {
      line.replace(at, mutant.from.size(), mutant.to);
      changed = true;
    }
  };
  for (std::string body : bodies()) {
    if (!mutant.in_text) {
      change(body);
    }
    std::string line = body.empty() ? "" : checked(body);
    if (mutant.in_text) {
      change(line);
    }
    text += line;
  }
  ASSERT_TRUE(changed);
  EXPECT_THAT(wrong_ids(judge(text, kClaims)), testing::Contains(mutant.id));
}

INSTANTIATE_TEST_SUITE_P(
    , NmeaMutant,
    testing::Values(
        Mutant{"line_feed_alone", "nmea/sentence/1", "\r\n", "\n", true},
        Mutant{"no_check", "nmea/sentence/2", "*", "", true},
        Mutant{"wrong_check", "nmea/sentence/3", ",A,4925", ",V,4925", true},
        Mutant{"unprintable", "nmea/sentence/4", "GNVTG,", "GNVTG\x07,"},
        Mutant{"too_long", "nmea/sentence/5", "GNGLL,",
               "GNGLL,0000000000000000000000000000000000000000"},
        Mutant{"strange_talker", "nmea/sentence/6", "GNVTG", "XXVTG"},
        Mutant{"field_missing", "nmea/sentence/7", ",M,48.0,M,", ",M,48.0,"},
        Mutant{"row_with_half_a_satellite", "nmea/sentence/7", ",20,44,080,43", ",20,44"},
        Mutant{"minute_60", "nmea/field/1", "0802", "0860"},
        Mutant{"angle_of_60_minutes", "nmea/field/2", "4925.48213,N,00745.10221,E,2",
               "4960.48213,N,00745.10221,E,2"},
        Mutant{"month_13", "nmea/field/4", "010626", "011326"},
        Mutant{"status_x", "nmea/field/5", ",A,4925", ",X,4925"},
        Mutant{"quality_9", "nmea/field/6", ",E,2,09", ",E,9,09"},
        Mutant{"feet", "nmea/field/7", "240.1,M", "240.1,F"},
        Mutant{"course_of_360", "nmea/field/8", "GNVTG,87.12", "GNVTG,360.00"},
        Mutant{"miles", "nmea/field/9", "1.860,K", "1.155,K"},
        Mutant{"azimuth_of_360", "nmea/field/10", ",05,71,020", ",05,71,360"},
        Mutant{"the_same_twice", "nmea/epoch/1", "GNVTG,87.12,T,,M,1.004,N,1.860,K,D",
               "GNGGA,080205.00,4925.48213,N,00745.10221,E,2,09,0.98,240.1,M,48.0,M,1.0,0120"},
        Mutant{"sentence_left_out", "nmea/epoch/4", "GNVTG,87.12,T,,M,1.004,N,1.860,K,D", "PTEST"},
        Mutant{"gga_elsewhere", "nmea/together/1", "4925.48213,N,00745.10221,E,2",
               "4925.48214,N,00745.10221,E,2"},
        Mutant{"gll_elsewhere", "nmea/together/2", "GNGLL,4925.48213", "GNGLL,4925.48214"},
        Mutant{"valid_without_fix", "nmea/together/3", ",E,2,09", ",E,0,09"},
        Mutant{"gll_not_valid", "nmea/together/4", ".00,A,D", ".00,V,D"},
        Mutant{"mode_of_another_quality", "nmea/together/5", "010626,,,D", "010626,,,A"},
        Mutant{"gsa_without_fix", "nmea/together/6", "GSA,A,3,02", "GSA,A,1,02"},
        Mutant{"another_speed", "nmea/together/7", "1.004,N,1.860", "1.104,N,2.045"},
        Mutant{"another_course", "nmea/together/8", "GNVTG,87.12", "GNVTG,88.12"},
        Mutant{"another_hdop", "nmea/together/9", "2,09,0.98", "2,09,1.40"},
        Mutant{"pdop_below_vdop", "nmea/together/10", "1.86,0.98,1.58", "1.20,0.98,1.58"},
        Mutant{"counts_one_more", "nmea/together/11", "2,09,0.98", "2,10,0.98"},
        Mutant{"row_begins_with_two", "nmea/together/12", "GLGSV,1,1,04", "GLGSV,2,2,04"},
        Mutant{"satellite_missing", "nmea/together/13", "GLGSV,1,1,04", "GLGSV,1,1,05"},
        Mutant{"uses_what_is_not_in_view", "nmea/together/14", "GSA,A,3,02", "GSA,A,3,03"},
        Mutant{"age_without_corrections", "nmea/together/15", ",E,2,09", ",E,1,09"}),
    [](const auto& mutant) { return std::string(mutant.param.name); });

TEST(NmeaSuite, TimeThatGoesBackIsFound) {
  std::vector<std::string> all = bodies();
  std::rotate(all.begin() + 18, all.begin() + 27, all.begin() + 36);
  EXPECT_THAT(wrong_ids(judge(said(all), kClaims)),
              testing::IsSupersetOf({"nmea/epoch/2", "nmea/epoch/3"}));
}

TEST(NmeaSuite, MidnightIsNoStepBack) {
  std::vector<std::string> all;
  for (const char* time : {"235958.00", "235959.00", "000000.00", "000001.00", "000002.00"}) {
    all.push_back(std::string("GNRMC,") + time +
                  ",A,4925.48213,N,00745.10221,E,1.004,87.12,010626,,,A");
  }
  EXPECT_THAT(wrong_ids(judge(said(all), {{"RMC"}, 1.0})), testing::IsEmpty());
}

TEST(NmeaSuite, SilenceIsTheToolsError) {
  const SuiteResult result = judge("");
  EXPECT_EQ(result.count(Verdict::error), result.cases.size());
}

TEST(NmeaSuite, ClaimsAreWhatComesInEveryEpoch) {
  NmeaLog log;
  const std::string text = said(bodies());
  log.add(milliseconds(0), {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  log.close();
  const NmeaClaims claims = survey_nmea(log);
  EXPECT_EQ(claims.rate_hz, 1.0);
  EXPECT_THAT(claims.sentences, testing::UnorderedElementsAreArray(kClaims.sentences));
}

}  // namespace
}  // namespace rigwire::conform
