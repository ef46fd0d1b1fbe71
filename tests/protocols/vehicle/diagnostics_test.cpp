#include "protocols/vehicle/diagnostics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace rigwire::protocols::vehicle {
namespace {

using testing::ElementsAre;

constexpr TroubleCode kLateCommand{5237, 9, 1};
constexpr TroubleCode kHighNumber{0x7FFFF, 31, 127};

TEST(VehicleTrouble, NoneIsACodeOfZerosWithoutLamps) {
  const auto report = make_trouble_report({}, {});
  EXPECT_THAT(report.payload(), ElementsAre(0x00, 0xFF, 0x00, 0x00, 0x00, 0x00, 0xFF, 0xFF));
  EXPECT_EQ(decode_trouble_report(report.payload())->count, 0U);
}

TEST(VehicleTrouble, OneCodeFillsAFrame) {
  Lamps lamps;
  lamps.amber_warning = true;
  const auto report = make_trouble_report(lamps, std::span(&kLateCommand, 1));
  // 5237 = 0x1475
  EXPECT_THAT(report.payload(), ElementsAre(0x04, 0xFF, 0x75, 0x14, 0x09, 0x01, 0xFF, 0xFF));
  const auto decoded = decode_trouble_report(report.payload());
  ASSERT_TRUE(decoded.ok());
  EXPECT_EQ(decoded->lamps, lamps);
  ASSERT_EQ(decoded->count, 1U);
  EXPECT_EQ(decoded->codes[0], kLateCommand);
}

TEST(VehicleTrouble, HighNumberSpreadsOverThreeBytes) {
  const auto report = make_trouble_report({}, std::span(&kHighNumber, 1));
  EXPECT_THAT(report.payload().subspan(2, 4), ElementsAre(0xFF, 0xFF, 0xFF, 0x7F));
  EXPECT_EQ(decode_trouble_report(report.payload())->codes[0], kHighNumber);
}

TEST(VehicleTrouble, TwoCodesAreLongerThanAFrame) {
  const std::array codes{kLateCommand, kHighNumber};
  const auto report = make_trouble_report({}, codes);
  EXPECT_EQ(report.size, 10U);
  const auto decoded = decode_trouble_report(report.payload());
  ASSERT_TRUE(decoded.ok());
  ASSERT_EQ(decoded->count, 2U);
  EXPECT_EQ(decoded->codes[0], kLateCommand);
  EXPECT_EQ(decoded->codes[1], kHighNumber);
}

TEST(VehicleTrouble, ShortPayloadsAreIncompleteAndManyCodesAreCut) {
  const std::array<std::uint8_t, 5> bytes{};
  for (std::size_t size = 0; size <= bytes.size(); ++size) {
    EXPECT_TRUE(decode_trouble_report(std::span(bytes).first(size)).incomplete());
  }
  const std::vector<TroubleCode> many(20, kLateCommand);
  EXPECT_EQ(make_trouble_report({}, many).size, 2U + 4U * kGreatestCodes);
}

}  // namespace
}  // namespace rigwire::protocols::vehicle
