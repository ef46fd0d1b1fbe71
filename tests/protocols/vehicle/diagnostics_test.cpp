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
  const can::Frame frame = report_frame(make_trouble_report({}, {}), 0, 0x00);
  EXPECT_EQ(frame.id, 0x18FECA00U);
  EXPECT_THAT(frame.payload(), ElementsAre(0x00, 0xFF, 0x00, 0x00, 0x00, 0x00, 0xFF, 0xFF));
  EXPECT_EQ(decode_trouble_report(frame.payload())->count, 0U);
}

TEST(VehicleTrouble, OneCodeIsOneFrame) {
  Lamps lamps;
  lamps.amber_warning = true;
  const auto report = make_trouble_report(lamps, std::span(&kLateCommand, 1));
  ASSERT_EQ(report_frames(report), 1U);
  // 5237 = 0x1475
  const can::Frame frame = report_frame(report, 0, 0x00);
  EXPECT_THAT(frame.payload(), ElementsAre(0x04, 0xFF, 0x75, 0x14, 0x09, 0x01, 0xFF, 0xFF));
  const auto decoded = decode_trouble_report(report.payload());
  ASSERT_TRUE(decoded.ok());
  EXPECT_EQ(decoded->lamps, lamps);
  ASSERT_EQ(decoded->count, 1U);
  EXPECT_EQ(decoded->codes[0], kLateCommand);
}

TEST(VehicleTrouble, HighNumberSpreadsOverThreeBytes) {
  const auto report = make_trouble_report({}, std::span(&kHighNumber, 1));
  EXPECT_THAT(report.payload().subspan(2), ElementsAre(0xFF, 0xFF, 0xFF, 0x7F));
  EXPECT_EQ(decode_trouble_report(report.payload())->codes[0], kHighNumber);
}

TEST(VehicleTrouble, TwoCodesAreBroadcastInPackets) {
  const std::array codes{kLateCommand, kHighNumber};
  const auto report = make_trouble_report({}, codes);
  ASSERT_EQ(report_frames(report), 3U);
  const can::Frame announce = report_frame(report, 0, 0x05);
  EXPECT_EQ(announce.id, 0x1CECFF05U);
  EXPECT_THAT(announce.payload(), ElementsAre(32, 10, 0, 2, 0xFF, 0xCA, 0xFE, 0x00));
  const can::Frame first = report_frame(report, 1, 0x05);
  const can::Frame second = report_frame(report, 2, 0x05);
  EXPECT_EQ(first.id, 0x1CEBFF05U);
  EXPECT_EQ(first.data[0], 1);
  EXPECT_THAT(second.payload(), ElementsAre(2, 0xFF, 0xFF, 0x7F, 0xFF, 0xFF, 0xFF, 0xFF));

  std::vector<std::uint8_t> joined(first.data.begin() + 1, first.data.end());
  joined.insert(joined.end(), second.data.begin() + 1, second.data.end());
  joined.resize(report.size);
  const auto decoded = decode_trouble_report(joined);
  ASSERT_TRUE(decoded.ok());
  ASSERT_EQ(decoded->count, 2U);
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
