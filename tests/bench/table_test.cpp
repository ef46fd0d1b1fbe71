#include "bench/table.h"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>

namespace rigwire::bench {
namespace {

TEST(Table, a_row_is_a_line_of_columns_and_an_object) {
  std::ostringstream text;
  const Table table(text, {{"medium", "<8"}, {"beams", ">6"}, {"lost", ">7"}, {" says", ""}});
  table.head();
  const nlohmann::json object =
      table.row({word("medium", "fog"), count("beams", 400), stored("beam_ns", 12.25),
                 number("lost_share", 0.125, "{:.1f}%", 100.0), shown(" dense")});
  EXPECT_EQ(text.str(),
            "medium    beams    lost  says\n"
            "fog         400   12.5%  dense\n");
  EXPECT_EQ(object,
            nlohmann::json(
                {{"medium", "fog"}, {"beams", 400}, {"beam_ns", 12.25}, {"lost_share", 0.125}}));
}

TEST(Table, what_is_no_number_is_null_in_the_object) {
  std::ostringstream text;
  const Table table(text, {{"error m", ">8"}, {"at end", ">8"}});
  const nlohmann::json object =
      table.row({number("error_m", std::numeric_limits<double>::quiet_NaN(), "{:.1e}"),
                 cell("final_m", nullptr, "diverged")});
  EXPECT_EQ(text.str(), "     nan diverged\n");
  EXPECT_EQ(object.dump(), R"({"error_m":null,"final_m":null})");
}

}  // namespace
}  // namespace rigwire::bench
