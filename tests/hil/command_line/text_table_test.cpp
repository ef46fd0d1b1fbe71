#include "hil/command_line/text_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rigwire::hil {
namespace {

using testing::ElementsAre;
using testing::Le;

TEST(TextTable, wide_and_combining_characters_take_the_columns_that_terminals_give_them) {
  EXPECT_EQ(display_width("Löffel"), 6U);
  EXPECT_EQ(display_width("o\xcc\x88"), 1U);
  EXPECT_EQ(display_width("挖掘"), 4U);
}

TEST(TextTable, what_is_clipped_ends_with_an_ellipsis) {
  EXPECT_EQ(clipped("gnss", 4), "gnss");
  EXPECT_EQ(clipped("gnss", 3), "gn…");
  EXPECT_EQ(clipped("挖掘机", 4), "挖…");
  EXPECT_EQ(clipped("gnss", 0), "");
}

TextTable table() {
  TextTable table({{"device", false, 0, 4}, {"rate", true}, {"bytes", true, 1}});
  table.add({{"imu_boom_front_left"}, {"100.0"}, {"17 kB/s"}});
  table.add({{"gnss"}, {"1.0"}, {"5 B/s"}});
  return table;
}

TEST(TextTable, columns_are_as_wide_as_what_is_in_them) {
  EXPECT_THAT(table().lines(0, false), ElementsAre("device                rate    bytes",  //
                                                   "imu_boom_front_left  100.0  17 kB/s",  //
                                                   "gnss                   1.0    5 B/s"));
}

TEST(TextTable, a_narrow_window_cuts_what_can_be_cut_and_leaves_out_what_is_least) {
  EXPECT_THAT(table().lines(29, false),
              ElementsAre("device          rate    bytes", "imu_boom_fro…  100.0  17 kB/s",
                          "gnss             1.0    5 B/s"))
      << "cut";
  EXPECT_THAT(table().lines(19, false), ElementsAre("device         rate",  //
                                                    "imu_boom_fr…  100.0", "gnss            1.0"))
      << "without bytes";
}

TEST(TextTable, no_line_is_wider_than_the_window) {
  for (std::size_t width = 1; width < 60; ++width) {
    for (const std::string& line : table().lines(width, false)) {
      EXPECT_THAT(display_width(line), Le(width)) << line;
    }
  }
}

TEST(TextTable, colours_take_no_columns) {
  TextTable coloured({{"drops", true}, {"client"}});
  coloured.add({{"7", "31"}, {"none"}});
  EXPECT_EQ(coloured.lines(20, true)[1], "    \x1b[31m7\x1b[0m  none");
}

}  // namespace
}  // namespace rigwire::hil
