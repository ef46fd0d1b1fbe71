#include "protocols/rinex/navigation.h"

#include <gtest/gtest.h>

#include "tests/protocols/rinex/files.h"

namespace rigwire::protocols::rinex {
namespace {

std::string refusal_of(const std::string& text) {
  return refusal([&] { static_cast<void>(read_navigation(text, "brdc.24n")); });
}

void expect_satellite_5(const NavigationFile& file) {
  ASSERT_EQ(file.records.size(), 1U);
  const gps::Ephemeris& e = file.records[0].ephemeris;
  EXPECT_EQ(e.prn, 5);
  EXPECT_EQ(e.week, 2297);
  EXPECT_EQ(e.clock_time_s, 295'200.0);
  EXPECT_DOUBLE_EQ(e.clock_bias_s, -0.151757150888e-3);
  EXPECT_DOUBLE_EQ(e.clock_drift, -0.125055521494e-10);
  EXPECT_EQ(e.clock_drift_rate, 0.0);
  EXPECT_EQ(e.issue_of_ephemeris, 77);
  EXPECT_EQ(e.radius_sine_m, 4.3125);
  EXPECT_DOUBLE_EQ(e.mean_motion_difference, 0.426910639614e-8);
  EXPECT_DOUBLE_EQ(e.mean_anomaly_rad, 1.23456789012);
  EXPECT_DOUBLE_EQ(e.latitude_cosine_rad, 0.201165676117e-6);
  EXPECT_DOUBLE_EQ(e.eccentricity, 0.589463487267e-2);
  EXPECT_DOUBLE_EQ(e.latitude_sine_rad, 0.101365149021e-4);
  EXPECT_DOUBLE_EQ(e.sqrt_semi_major_axis, 5153.68164253);
  EXPECT_EQ(e.ephemeris_time_s, 295'200.0);
  EXPECT_DOUBLE_EQ(e.inclination_cosine_rad, 0.111758708954e-7);
  EXPECT_DOUBLE_EQ(e.ascending_node_rad, -2.36278481532);
  EXPECT_DOUBLE_EQ(e.inclination_sine_rad, 0.391155481339e-7);
  EXPECT_DOUBLE_EQ(e.inclination_rad, 0.966430092344);
  EXPECT_EQ(e.radius_cosine_m, 183.125);
  EXPECT_DOUBLE_EQ(e.argument_of_perigee_rad, 1.21391273562);
  EXPECT_DOUBLE_EQ(e.ascending_node_rate, -0.797568936379e-8);
  EXPECT_DOUBLE_EQ(e.inclination_rate, 0.21000875e-9);
  EXPECT_EQ(e.l2_code, 1);
  EXPECT_FALSE(e.l2_p_data_off);
  EXPECT_EQ(e.accuracy_index, 0);
  EXPECT_EQ(e.health, 0);
  EXPECT_DOUBLE_EQ(e.group_delay_s, -0.111758708954e-7);
  EXPECT_EQ(e.issue_of_clock, 589);
  EXPECT_FALSE(e.long_fit);
  EXPECT_EQ(file.records[0].transmission_time_s, 288'018.0);
  EXPECT_TRUE(file.has_ionosphere && file.has_utc && file.has_leap_seconds);
  EXPECT_DOUBLE_EQ(file.ionosphere_utc.alpha[2], -0.596e-7);
  EXPECT_DOUBLE_EQ(file.ionosphere_utc.beta[0], 90'110.0);
  EXPECT_NEAR(file.ionosphere_utc.utc_a1, -4.440892098e-15, 1e-24);
  EXPECT_EQ(file.ionosphere_utc.utc_reference_time_s, 147'456.0);
  EXPECT_EQ(file.ionosphere_utc.utc_reference_week, 2297);
  EXPECT_EQ(file.ionosphere_utc.leap_seconds, 18);
  EXPECT_EQ(file.ionosphere_utc.leap_seconds_future, 18);
}

TEST(RinexNavigation, Version2IsReadFieldByField) {
  const NavigationFile file = read_navigation(kVersion2, "brdc.24n");
  EXPECT_EQ(file.version, 2.10);
  expect_satellite_5(file);
  EXPECT_EQ(file.skipped_records, 0U);
}

TEST(RinexNavigation, Version3IsReadAndOtherSystemsAreCounted) {
  const NavigationFile file = read_navigation(kVersion3, "brdc.rnx");
  expect_satellite_5(file);
  EXPECT_EQ(file.skipped_records, 2U);
  EXPECT_EQ(file.skipped_header_lines, 1U);
  EXPECT_EQ(file.ionosphere_utc.leap_week, 2185);
  EXPECT_EQ(file.ionosphere_utc.leap_day, 7);
}

TEST(RinexNavigation, LineEndsOfOtherSystemsAndBlankLinesDoNotMatter) {
  std::string text;
  for (const char c : std::string(kVersion3)) {
    text += c == '\n' ? "\r\n" : std::string(1, c);
  }
  expect_satellite_5(read_navigation(text + "\r\n  \n", "brdc.rnx"));
}

TEST(RinexNavigation, WrittenFileReadsBackToTheSameBits) {
  NavigationFile file = read_navigation(kVersion3, "brdc.rnx");
  for (NavigationRecord& record : file.records) {
    record.ephemeris = gps::quantised(record.ephemeris);
  }
  file.records.push_back(file.records[0]);
  file.records[1].ephemeris.prn = 32;
  file.records[1].ephemeris.long_fit = true;
  file.records[1].ephemeris.accuracy_index = 15;
  const std::string text = write_navigation(file, {"rigwire", "test", "20240117 000000 UTC"});
  NavigationFile again = read_navigation(text, "again.rnx");
  ASSERT_EQ(again.records.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(gps::quantised(again.records[i].ephemeris), file.records[i].ephemeris);
    EXPECT_EQ(again.records[i].transmission_time_s, file.records[i].transmission_time_s);
  }
  EXPECT_EQ(again.ionosphere_utc, file.ionosphere_utc);
  EXPECT_EQ(again.skipped_header_lines, 0U);
}

TEST(RinexNavigation, NoLineIsLongerThanEightyColumns) {
  const NavigationFile file = read_navigation(kVersion3, "brdc.rnx");
  const std::string text = write_navigation(file, {});
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = text.find('\n', at);
    EXPECT_LE(end - at, 80U) << text.substr(at, end - at);
    at = end + 1;
  }
}

TEST(RinexNavigation, WeekModulo1024IsResolvedByTheDate) {
  const auto file =
      read_navigation(with(kVersion2, "0.229700000000D+04", "0.249000000000D+03"), "x");
  EXPECT_EQ(file.records[0].ephemeris.week, 2297);
}

TEST(RinexNavigation, WeekBelongsToToeWhenTheClockIsOfAnotherWeek) {
  std::string text = with(kVersion2, "24  1 17 10  0  0.0", "24  1 20 23 59 44.0");
  text = with(text, "0.295200000000D+06", "0.000000000000D+00");
  text = with(text, "0.229700000000D+04", "0.229800000000D+04");
  const auto file = read_navigation(text, "x");
  EXPECT_EQ(file.records[0].ephemeris.week, 2298);
  EXPECT_EQ(file.records[0].ephemeris.clock_time_s, 604'784.0);
  const auto again = read_navigation(write_navigation(file, {}), "y");
  EXPECT_EQ(again.records[0], file.records[0]);
}

TEST(RinexNavigation, EveryCutIsRefusedUnlessItLeavesWholeRecords) {
  for (const std::string text : {kVersion2, kVersion3}) {
    std::size_t whole = 0;
    for (std::size_t at = text.find('\n'); at + 1 < text.size(); at = text.find('\n', at + 1)) {
      const std::string message = refusal_of(text.substr(0, at + 1));
      whole += message.empty() ? 1U : 0U;
      if (!message.empty()) {
        EXPECT_EQ(message.rfind("brdc.24n:", 0), 0U) << message;
        EXPECT_NE(message.find("the file ends here"), std::string::npos) << message;
      }
    }
    // After the header; and in the mixed file after each record. Of a record that is skipped only
    // the first four lines are looked for, which are all that some systems have.
    EXPECT_EQ(whole, text == kVersion2 ? 1U : 7U);
  }
}

TEST(RinexNavigation, ErrorsNameLineValueAndWhatIsAllowed) {
  EXPECT_EQ(refusal_of(with(kVersion2, "2.10", "4.00")),
            "brdc.24n:1: version is 4.00, allowed are 2.x and 3.x");
  EXPECT_EQ(refusal_of(with(kVersion2, "N: GPS NAV", "O: OBSERVE")),
            "brdc.24n:1: file type is 'O', allowed is N (navigation)");
  EXPECT_EQ(refusal_of(with(kVersion2, "\n 5 24", "\n33 24")),
            "brdc.24n:9: PRN is \"33\", allowed are whole numbers from 1 to 32");
  EXPECT_EQ(refusal_of(with(kVersion2, "0.431250000000D+01", "0.4312500x0000D+01")),
            "brdc.24n:10: Crs is \" 0.4312500x0000D+01\", allowed is a finite number");
  EXPECT_EQ(refusal_of(with(kVersion2, "0.431250000000D+01", "               nan")),
            "brdc.24n:10: Crs is \"                nan\", allowed is a finite number");
  EXPECT_EQ(refusal_of(with(kVersion2, " 1 17 10", " 2 30 10")).substr(0, 35),
            "brdc.24n:9: date is 2024-2-30 10:0:");
  EXPECT_EQ(refusal_of(with(kVersion2, "0.295200000000D+06", "0.604800000000D+06")),
            "brdc.24n:16: toe is 604800.000000 s, allowed is 0 to less than 604800");
  EXPECT_EQ(refusal_of(with(kVersion2, "0.229700000000D+04", "0.229600000000D+04")),
            "brdc.24n:16: week is 2296, but toe lies in week 2297 by the record's date");
  EXPECT_EQ(refusal_of(with(kVersion3, "R07", "Q07")),
            "brdc.24n:10: record begins with 'Q07', allowed are G and the systems RESCJI");
  EXPECT_EQ(refusal_of(""), "brdc.24n:1: the file ends here, expected RINEX VERSION / TYPE");
}

}  // namespace
}  // namespace rigwire::protocols::rinex
