#include "hil/stream/identifier_counts.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace rigwire::hil {
namespace {

protocols::can::Frame frame(std::uint32_t id, bool extended, std::uint8_t length) {
  protocols::can::Frame made;
  made.id = id;
  made.extended = extended;
  made.length = length;
  return made;
}

TEST(IdentifierCounts, AreInTheOrderOfArbitrationWithTheNewestFrame) {
  IdentifierCounts counts;
  counts.take(frame(0x18F00400, true, 8), false);
  counts.take(frame(0x63C, false, 2), false);  // the same eleven bits as the extended one
  counts.take(frame(0x0CF00400, true, 8), false);
  counts.take(frame(0x63C, false, 4), true);
  const auto told = nlohmann::json::parse(counts.json({}))["identifiers"];
  ASSERT_EQ(told.size(), 3U);
  EXPECT_EQ(told[0]["id"], "0CF00400");
  EXPECT_EQ(told[1]["id"], "63C");
  EXPECT_EQ(told[1]["count"], 2);
  EXPECT_EQ(told[1]["size"], 4);
  EXPECT_EQ(told[1]["from"], "client");
  EXPECT_EQ(told[2]["id"], "18F00400");
  EXPECT_EQ(told[2]["from"], "device");
}

TEST(IdentifierCounts, OfABusOnWhichNothingCameAreNone) {
  EXPECT_EQ(IdentifierCounts().json({}), R"({"identifiers":[]})");
}

}  // namespace
}  // namespace rigwire::hil
