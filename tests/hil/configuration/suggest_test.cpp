#include "hil/configuration/suggest.h"

#include <gtest/gtest.h>

namespace rigwire::hil {
namespace {

TEST(Suggest, distance_counts_slips_of_each_kind_once) {
  EXPECT_EQ(edit_distance("", ""), 0u);
  EXPECT_EQ(edit_distance("rate", ""), 4u);
  EXPECT_EQ(edit_distance("rate", "Rate"), 0u);
  EXPECT_EQ(edit_distance("ratte", "rate"), 1u);
  EXPECT_EQ(edit_distance("rte", "rate"), 1u);
  EXPECT_EQ(edit_distance("rade", "rate"), 1u);
  EXPECT_EQ(edit_distance("raet", "rate"), 1u);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
}

TEST(Suggest, nearest_word_is_offered_only_when_it_is_likely) {
  const std::vector<std::string> known{"rate", "baud", "position", "id"};
  EXPECT_EQ(nearest_word("rates", known), "rate");
  EXPECT_EQ(nearest_word("postion", known), "position");
  EXPECT_EQ(nearest_word("pos", known), "position");
  EXPECT_EQ(nearest_word("zebra", known), "");
  EXPECT_EQ(nearest_word("", known), "");
  EXPECT_EQ(nearest_word("x", {}), "");
}

}  // namespace
}  // namespace rigwire::hil
