#include "fields/rules.h"

#include <gtest/gtest.h>

namespace rigwire::fields {
namespace {

TEST(IntegerRule, both_ends_are_allowed) {
  constexpr IntegerRule rule{1, 65535};
  EXPECT_TRUE(rule.contains(1));
  EXPECT_TRUE(rule.contains(65535));
  EXPECT_FALSE(rule.contains(0));
  EXPECT_FALSE(rule.contains(65536));
}

TEST(IntegerRule, the_range_is_said_with_its_unit) {
  constexpr std::int64_t kNoLower = std::numeric_limits<std::int64_t>::min();
  EXPECT_EQ((IntegerRule{1, 65535}).range_text(), "1 .. 65535");
  EXPECT_EQ((IntegerRule{0, 65535, unit("ms")}).range_text(), "0 .. 65535 ms");
  EXPECT_EQ(IntegerRule{0}.range_text(), ">= 0");
  EXPECT_EQ((IntegerRule{kNoLower, 5}).range_text(), "<= 5");
  EXPECT_EQ(IntegerRule{}.range_text(), "");
  EXPECT_EQ((IntegerRule{.unit = unit("ms")}).range_text(), "");
}

TEST(DurationRule, both_ends_are_allowed_and_said) {
  constexpr DurationRule rule{10'000, 1'000'000'000};
  EXPECT_TRUE(rule.contains(10'000));
  EXPECT_TRUE(rule.contains(1'000'000'000));
  EXPECT_FALSE(rule.contains(9'999));
  EXPECT_FALSE(rule.contains(1'000'000'001));
  EXPECT_EQ(rule.range_text(), "10 us .. 1 s");
  EXPECT_EQ(DurationRule{}.range_text(), ">= 0 s");
}

TEST(Durations, print_in_the_largest_unit_that_is_exact) {
  EXPECT_EQ(print_duration(0), "0 s");
  EXPECT_EQ(print_duration(1'500'000'000), "1500 ms");
  EXPECT_EQ(print_duration(20'000'000), "20 ms");
  EXPECT_EQ(print_duration(-3'000), "-3 us");
  EXPECT_EQ(print_duration(1'000'000'001), "1000000001 ns");
}

}  // namespace
}  // namespace rigwire::fields
