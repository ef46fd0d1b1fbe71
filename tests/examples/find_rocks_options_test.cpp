// Options of find_rocks: what is taken has its place, what cannot be is refused with what may be.
#include "find_rocks/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace rigwire::find_rocks {
namespace {

Options parse(std::vector<std::string_view> arguments) {
  return parse_options(arguments);
}

TEST(FindRocksOptions, EachHasItsPlace) {
  const Options options = parse({"--camera",
                                 "127.0.0.7",
                                 "--mount=3.1,17",
                                 "--own-box",
                                 "-1.6,-0.1,9",
                                 "--own-box",
                                 "2,3,4",
                                 "--own-area",
                                 "10,20,30,40",
                                 "--least",
                                 "0.5",
                                 "--largest=3",
                                 "--nearest=1",
                                 "--farthest",
                                 "12",
                                 "--duration",
                                 "20s",
                                 "--patience",
                                 "4",
                                 "--log",
                                 "a.jsonl",
                                 "--csv",
                                 "b.csv",
                                 "--packet-size",
                                 "1500",
                                 "--least-confidence",
                                 "7",
                                 "--disparity-sigma",
                                 "0.2",
                                 "--period",
                                 "2",
                                 "--quiet",
                                 "--wait"});
  EXPECT_EQ(options.camera, "127.0.0.7");
  ASSERT_TRUE(options.rocks.ground.mount);
  EXPECT_EQ(options.rocks.ground.mount->height_m, 3.1);
  EXPECT_EQ(options.rocks.ground.mount->pitch_deg, 17.0);
  ASSERT_EQ(options.rocks.own_boxes.size(), 2U);
  EXPECT_EQ(options.rocks.own_boxes[0].left_from_m, -1.6);
  ASSERT_EQ(options.rocks.own_areas.size(), 1U);
  EXPECT_EQ(options.rocks.own_areas[0].bottom, 40);
  EXPECT_EQ(options.rocks.least_m, 0.5);
  EXPECT_EQ(options.rocks.largest_m, 3.0);
  EXPECT_EQ(options.rocks.nearest_m, 1.0);
  EXPECT_EQ(options.rocks.farthest_m, 12.0);
  EXPECT_EQ(options.rocks.ground.disparity_sigma_px, 0.2);
  EXPECT_EQ(options.duration, std::chrono::seconds{20});
  EXPECT_EQ(options.patience, std::chrono::seconds{4});
  EXPECT_EQ(options.period, std::chrono::seconds{2});
  EXPECT_EQ(options.packet_size, 1500U);
  EXPECT_EQ(options.least_confidence, 7);
  EXPECT_EQ(options.log, "a.jsonl");
  EXPECT_EQ(options.csv, "b.csv");
  EXPECT_TRUE(options.quiet && options.wait);
}

TEST(FindRocksOptions, WhatCannotBeIsRefusedWithWhatMayBe) {
  const auto message = [](std::vector<std::string_view> arguments) -> std::string {
    try {
      (void)parse(std::move(arguments));
    } catch (const UsageError& error) {
      return error.what();
    }
    return "nothing was thrown";
  };
  using testing::HasSubstr;
  EXPECT_THAT(message({"--least", "0"}), HasSubstr("allowed metres, 0.1..5"));
  EXPECT_THAT(message({"--own-box", "1,0,5"}), HasSubstr("FROM below TO"));
  EXPECT_THAT(message({"--own-area", "1,2,3"}), HasSubstr("LEFT,TOP,RIGHT,BOTTOM"));
  EXPECT_THAT(message({"--own-area", "5,2,3,9"}), HasSubstr("LEFT,TOP,RIGHT,BOTTOM"));
  EXPECT_THAT(message({"--mount", "3"}), HasSubstr("HEIGHT,PITCH"));
  EXPECT_THAT(message({"--packet-size", "100"}), HasSubstr("576..16356"));
  EXPECT_THAT(message({"--least", "3", "--largest", "2"}), HasSubstr("allowed above --least"));
  EXPECT_THAT(message({"--rocks"}), HasSubstr("unknown option '--rocks'"));
}

TEST(FindRocksOptions, HelpNamesEveryOption) {
  for (const std::string_view name :
       {"--camera", "--packet-size", "--least-confidence", "--mount", "--own-box", "--own-area",
        "--disparity-sigma", "--least", "--largest", "--nearest", "--farthest", "--duration",
        "--patience", "--wait", "--period", "--log", "--csv", "--quiet"}) {
    EXPECT_THAT(std::string(usage()), testing::HasSubstr(std::string(name) + " ")) << name;
  }
}

}  // namespace
}  // namespace rigwire::find_rocks
