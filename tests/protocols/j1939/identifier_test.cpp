#include "protocols/j1939/identifier.h"

#include <gtest/gtest.h>

namespace rigwire::protocols::j1939 {
namespace {

TEST(Identifier, GroupForEverybodyKeepsItsLowByte) {
  EXPECT_EQ(pack({3, 61481, kGlobalAddress, 0x80}), 0x0CF02980U);
  EXPECT_EQ(unpack(0x0CF02980), (Identifier{3, 61481, kGlobalAddress, 0x80}));
  EXPECT_EQ(pack({2, 61485, kGlobalAddress, 0x80}), 0x08F02D80U);
}

TEST(Identifier, AddressedGroupTakesTheDestination) {
  EXPECT_EQ(pack({6, 59904, 0x80, 0xFE}), 0x18EA80FEU);
  EXPECT_EQ(unpack(0x18EA80FE), (Identifier{6, 59904, 0x80, 0xFE}));
  EXPECT_EQ(pack({6, 60928, kGlobalAddress, 0x50}), 0x18EEFF50U);
}

TEST(Identifier, BoundaryBetweenTheFormatsIs240) {
  EXPECT_TRUE(is_addressed(0xEF00));
  EXPECT_FALSE(is_addressed(0xF000));
  EXPECT_TRUE(is_addressed(0x1EF00));
}

TEST(Identifier, EveryIdentifierSurvivesTheRoundTrip) {
  for (std::uint64_t id = 0; id < (1ULL << 29U); id += 40'503) {
    EXPECT_EQ(pack(unpack(static_cast<std::uint32_t>(id))), id);
  }
}

}  // namespace
}  // namespace rigwire::protocols::j1939
