#include "hil/control/overrun_lines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <vector>

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;

class OverrunLinesTest : public testing::Test {
 protected:
  std::vector<std::string> lines_;
  OverrunLines overruns_{OverrunPolicy::slip,
                         [this](SimTime, const std::string& line) { lines_.push_back(line); }};
};

TEST_F(OverrunLinesTest, a_stall_is_one_line_that_says_how_long_and_when) {
  overruns_.take({kStart + 2s, 520ms}, WallTime{10s});
  EXPECT_THAT(lines_,
              testing::ElementsAre(
                  "the host stalled for 520 ms at 2.000 s: simulated time slipped by as much"));
}

TEST_F(OverrunLinesTest, stalls_within_a_second_share_a_line) {
  for (int i = 0; i < 10; ++i) {
    overruns_.take({kStart + 2s + i * 200ms, 150ms}, WallTime{10s + i * 350ms});
  }
  ASSERT_EQ(lines_.size(), 4U) << "at 0, 1.05, 2.1 and 3.15 s";
  EXPECT_EQ(
      lines_[1],
      "the host stalled 3 times up to 2.600 s, for 450 ms together: simulated time slipped by "
      "as much");
  overruns_.flush();
  EXPECT_EQ(lines_.size(), 4U) << "nothing is left";
}

TEST_F(OverrunLinesTest, what_was_only_counted_comes_at_the_end) {
  overruns_.take({kStart + 2s, 150ms}, WallTime{10s});
  overruns_.take({kStart + 3s, 250ms}, WallTime{10500ms});
  ASSERT_EQ(lines_.size(), 1U);
  overruns_.flush();
  ASSERT_EQ(lines_.size(), 2U);
  EXPECT_THAT(lines_[1], testing::HasSubstr("for 250 ms at 3.000 s"));
}

}  // namespace
}  // namespace rigwire::hil
