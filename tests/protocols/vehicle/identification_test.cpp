#include "protocols/vehicle/identification.h"

#include <gtest/gtest.h>

#include <string>

namespace rigwire::protocols::vehicle {
namespace {

std::string text(const Identification& identification) {
  const auto payload = identification.payload();
  return {payload.begin(), payload.end()};
}

TEST(Identification, FieldsEndWithAStarAndMayBeEmpty) {
  EXPECT_EQ(text(make_identification({"Rigwire", "gateway", "", "7"})), "Rigwire*gateway**7*");
  EXPECT_EQ(text(make_software_identification({"1.0", "map 3"})),
            "\x02"
            "1.0*map 3*");
}

TEST(Identification, WhatCouldEndAFieldIsReplaced) {
  EXPECT_EQ(text(make_identification({"a*b\nc\x80"})), "a_b_c_*");
}

TEST(Identification, TooLongIsCut) {
  const std::string many(1000, 'x');
  EXPECT_EQ(make_identification({many}).size, Identification::kGreatest);
}

}  // namespace
}  // namespace rigwire::protocols::vehicle
