#include "protocols/slcan/acceptance_filter.h"

#include <gtest/gtest.h>

namespace rigwire::protocols::slcan {
namespace {

using can::Frame;

TEST(AcceptanceFilter, AfterPowerUpAcceptsEverything) {
  const AcceptanceFilter filter;
  EXPECT_TRUE(filter.accepts({0x7FF, false, false, 8, {1, 2, 3, 4, 5, 6, 7, 8}}));
  EXPECT_TRUE(filter.accepts({0x1FFFFFFF, true, true, 0, {}}));
}

TEST(AcceptanceFilter, SingleModeComparesIdentifierRemoteBitAndTwoBytes) {
  // Identifier 123: 0010 0100 | 011, data frame 0; bytes A5 5A.
  const AcceptanceFilter filter{0x2460A55A, 0x000F0000, true};
  EXPECT_TRUE(filter.accepts({0x123, false, false, 2, {0xA5, 0x5A}}));
  EXPECT_FALSE(filter.accepts({0x122, false, false, 2, {0xA5, 0x5A}}));
  EXPECT_FALSE(filter.accepts({0x123, false, false, 2, {0xA5, 0x5B}}));
  EXPECT_FALSE(filter.accepts({0x123, false, false, 2, {0xA4, 0x5A}}));
  EXPECT_FALSE(filter.accepts({0x123, false, true, 2, {}}));
  EXPECT_TRUE(filter.accepts({0x123, false, false, 1, {0xA5}})) << "there is no second byte";
  EXPECT_TRUE(filter.accepts({0x123, false, false, 0, {}}));
}

TEST(AcceptanceFilter, SingleModeComparesTheWholeExtendedIdentifier) {
  const AcceptanceFilter filter{0x18FEF327U << 3U, 0x3, true};
  EXPECT_TRUE(filter.accepts({0x18FEF327, true, false, 1, {0xFF}}));
  EXPECT_FALSE(filter.accepts({0x18FEF326, true, false, 1, {0xFF}}));
  EXPECT_FALSE(filter.accepts({0x18FEF327, true, true, 1, {}}));
}

TEST(AcceptanceFilter, DualModeAcceptsWhatEitherFilterDoes) {
  // 1: identifier 100 with first byte 3C. 2: identifier 200, remote.
  const AcceptanceFilter filter{0x2003401C, 0x00000000, false};
  EXPECT_TRUE(filter.accepts({0x100, false, false, 1, {0x3C}}));
  EXPECT_FALSE(filter.accepts({0x100, false, false, 1, {0x3D}}));
  EXPECT_FALSE(filter.accepts({0x100, false, false, 1, {0x2C}}));
  EXPECT_TRUE(filter.accepts({0x100, false, false, 0, {}})) << "no data to compare";
  EXPECT_TRUE(filter.accepts({0x200, false, true, 0, {}}));
  EXPECT_FALSE(filter.accepts({0x200, false, false, 1, {0x00}}));
}

TEST(AcceptanceFilter, DualModeComparesSixteenBitsOfExtendedIdentifiers) {
  // Both filters want 18FEF327 without its lower 13 bits.
  const std::uint32_t upper = 0x18FEF327U >> 13U;
  const AcceptanceFilter filter{upper << 16U | upper, 0, false};
  EXPECT_TRUE(filter.accepts({0x18FEF327, true, false, 0, {}}));
  EXPECT_TRUE(filter.accepts({0x18FEE000, true, false, 0, {}}));
  EXPECT_FALSE(filter.accepts({0x18FF0000, true, false, 0, {}}));
}

}  // namespace
}  // namespace rigwire::protocols::slcan
