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
  EXPECT_EQ(nearest_word("positioning_of_it", known), "position") << "one begins with the other";
  EXPECT_EQ(nearest_word("dentification", known), "") << "the lengths differ too much";
}

TEST(Suggest, a_word_longer_than_a_files_name_is_compared_with_nothing) {
  const std::vector<std::string> known{"rate", std::string(300, 'r')};
  EXPECT_EQ(nearest_word("rate" + std::string(251, 'x'), known), "rate");
  EXPECT_EQ(nearest_word("rate" + std::string(252, 'x'), known), "");
  EXPECT_EQ(nearest_word(std::string(60'000, 'r'), known), "");
}

}  // namespace
}  // namespace rigwire::hil
