#include "protocols/rinex/yuma.h"

#include <gtest/gtest.h>

#include "files.h"

namespace rigwire::protocols::rinex {
namespace {

std::string yuma_refusal_of(const std::string& text) {
  return refusal([&] { static_cast<void>(read_yuma(text, "almanac.yuma", 2300)); });
}

TEST(Yuma, BlockIsReadFieldByField) {
  const YumaAlmanac file = read_yuma(std::string(kYuma) + "\n" + kYuma, "almanac.yuma", 2300);
  ASSERT_EQ(file.almanacs.size(), 2U);
  EXPECT_EQ(file.almanacs[0], file.almanacs[1]);
  const gps::Almanac& a = file.almanacs[0];
  EXPECT_EQ(a.prn, 5);
  EXPECT_EQ(a.week, 2297);
  EXPECT_EQ(a.health, 0);
  EXPECT_EQ(a.almanac_time_s, 319'488.0);
  EXPECT_DOUBLE_EQ(a.eccentricity, 0.5894660950e-2);
  EXPECT_DOUBLE_EQ(a.inclination_rad, 0.9664306641);
  EXPECT_DOUBLE_EQ(a.ascending_node_rate, -0.7977475151e-8);
  EXPECT_DOUBLE_EQ(a.sqrt_semi_major_axis, 5153.681641);
  EXPECT_DOUBLE_EQ(a.ascending_node_rad, -2.362785339);
  EXPECT_DOUBLE_EQ(a.argument_of_perigee_rad, 1.213912725);
  EXPECT_DOUBLE_EQ(a.mean_anomaly_rad, -1.507446766);
  EXPECT_DOUBLE_EQ(a.clock_bias_s, -0.1516342163e-3);
  EXPECT_DOUBLE_EQ(a.clock_drift, -0.1091393642e-10);
}

TEST(Yuma, WeeksFrom1024OnAreTakenAsTheyAre) {
  const auto file = read_yuma(with(kYuma, "    249\n", "   2297\n"), "almanac.yuma", 0);
  EXPECT_EQ(file.almanacs[0].week, 2297);
}

TEST(Yuma, UnknownLinesAreCounted) {
  const auto file = read_yuma(with(kYuma, "Health:", "Colour: blue\nHealth:"), "x", 2300);
  EXPECT_EQ(file.skipped_lines, 1U);
}

TEST(Yuma, EveryCutBlockIsRefused) {
  const std::string text = kYuma;
  for (std::size_t at = text.find('\n'); at + 1 < text.size(); at = text.find('\n', at + 1)) {
    EXPECT_NE(yuma_refusal_of(text.substr(0, at + 1)).find("has no"), std::string::npos);
  }
}

TEST(Yuma, ErrorsNameLineValueAndWhatIsAllowed) {
  EXPECT_EQ(yuma_refusal_of(with(kYuma, "   05\n", "   33\n")),
            "almanac.yuma:2: ID is 33.000000, allowed is 1.000000 to less than 33.000000");
  EXPECT_EQ(yuma_refusal_of(with(kYuma, "319488.0000", "31948x.0000")),
            "almanac.yuma:5: Time of Applicability is \"  31948x.0000\", allowed is a finite "
            "number");
  EXPECT_EQ(yuma_refusal_of(std::string(kYuma) + "ID: 5\n"),
            "almanac.yuma:15: \"ID\" is twice in one block");
  EXPECT_EQ(yuma_refusal_of("ID: 5\n"), "almanac.yuma:1: \"ID\" is before the first \"****\" line");
  EXPECT_EQ(yuma_refusal_of(""),
            "almanac.yuma:0: no almanac found, expected lines from \"******** Week ...\" on");
}

}  // namespace
}  // namespace rigwire::protocols::rinex
