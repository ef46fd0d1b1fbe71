#include "protocols/gs_usb/requests.h"

#include <gtest/gtest.h>

#include <vector>

namespace rigwire::protocols::gs_usb {
namespace {

/// bxCAN in an STM32F0 at 48 MHz, as candleLight reports it.
constexpr BitTimingLimits kLimits{0, 48'000'000, 1, 16, 1, 8, 4, 1, 1024, 1};

/// Timings of the usual rates from 48 MHz; 250 kbit/s is what Linux 6.1 was seen to send.
struct Usual {
  std::uint32_t rate_bps;
  BitTiming timing;
};
constexpr Usual kUsual[] = {
    {1'000'000, {5, 6, 4, 1, 3}}, {800'000, {6, 8, 5, 1, 3}},  {500'000, {6, 7, 2, 1, 6}},
    {250'000, {6, 7, 2, 1, 12}},  {125'000, {6, 7, 2, 1, 24}}, {100'000, {6, 7, 2, 1, 30}},
    {50'000, {6, 7, 2, 1, 60}},   {20'000, {6, 7, 2, 1, 150}}, {10'000, {6, 7, 2, 1, 300}},
};

TEST(GsUsbRequests, BitTimingOfLinuxIsTwentyBytesLittleEndian) {
  const auto bytes = encode(BitTiming{6, 7, 2, 1, 12});
  const std::vector<std::uint8_t> expected{6, 0, 0, 0, 7, 0, 0,  0, 2, 0,
                                           0, 0, 1, 0, 0, 0, 12, 0, 0, 0};
  EXPECT_EQ(std::vector(bytes.begin(), bytes.end()), expected);
  EXPECT_EQ(*decode<BitTiming>(bytes), (BitTiming{6, 7, 2, 1, 12}));
}

TEST(GsUsbRequests, ByteOrderMark) {
  const auto bytes = encode(HostFormat{});
  EXPECT_EQ(std::vector(bytes.begin(), bytes.end()), (std::vector<std::uint8_t>{0xEF, 0xBE, 0, 0}));
}

TEST(GsUsbRequests, ChannelsAreCountedFromTheFourthByte) {
  const std::vector<std::uint8_t> bytes{0, 0, 0, 2, 2, 0, 0, 0, 1, 0, 0, 0};
  const auto configuration = decode<DeviceConfiguration>(bytes);
  ASSERT_TRUE(configuration.ok());
  EXPECT_EQ(configuration->channels(), 3U);
  EXPECT_EQ(configuration->software_version, 2U);
  EXPECT_EQ(configuration->hardware_version, 1U);
}

TEST(GsUsbRequests, EveryTruncationIsIncomplete) {
  const auto bytes = encode(kLimits);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto decoded = decode<BitTimingLimits>(std::span(bytes).first(size));
    ASSERT_TRUE(decoded.incomplete()) << size;
    EXPECT_EQ(decoded.shortage().needed, 40U);
    EXPECT_EQ(decoded.shortage().had, size);
  }
  EXPECT_EQ(*decode<BitTimingLimits>(bytes), kLimits);
}

TEST(GsUsbRequests, WhatFollowsAStructureIsNotItsOwn) {
  std::vector<std::uint8_t> bytes(64, 0xFF);
  const auto mode = decode<Mode>(bytes);
  ASSERT_TRUE(mode.ok());
  EXPECT_EQ(mode.consumed(), 8U);
}

TEST(GsUsbBitTiming, UsualRates) {
  for (const auto& [rate, timing] : kUsual) {
    EXPECT_TRUE(permitted(timing, kLimits)) << rate;
    EXPECT_EQ(bit_rate_bps(timing, kLimits.clock_hz), rate);
  }
}

TEST(GsUsbBitTiming, RatesThatDoNotDivideTheClockAreRounded) {
  // 48 MHz / (36 * 16) = 83333.33, python-can's S9; / (7 * 13) = 527472.5.
  EXPECT_EQ(bit_rate_bps({6, 7, 2, 1, 36}, 48'000'000), 83'333U);
  EXPECT_EQ(bit_rate_bps({4, 5, 3, 1, 7}, 48'000'000), 527'473U);
}

TEST(GsUsbBitTiming, WithoutLengthOrPrescalerThereIsNoRate) {
  EXPECT_EQ(bit_rate_bps({}, 48'000'000), std::nullopt);
  EXPECT_EQ(bit_rate_bps({0, 0, 0, 1, 12}, 48'000'000), std::nullopt);
  EXPECT_EQ(bit_rate_bps({6, 7, 2, 1, 0}, 48'000'000), std::nullopt);
  constexpr std::uint32_t kMost = 0xFFFFFFFF;
  EXPECT_EQ(bit_rate_bps({kMost, kMost, kMost, kMost, kMost}, 48'000'000), std::nullopt);
  EXPECT_EQ(bit_rate_bps({6, 7, 2, 1, kMost}, 48'000'000), std::nullopt);
}

TEST(GsUsbBitTiming, LimitsOfTheController) {
  const BitTiming good{6, 7, 2, 1, 12};
  EXPECT_TRUE(permitted(good, kLimits));
  const auto with = [&](std::uint32_t BitTiming::*member, std::uint32_t value) {
    BitTiming timing = good;
    timing.*member = value;
    return permitted(timing, kLimits);
  };
  EXPECT_TRUE(with(&BitTiming::phase_segment_1, 10));
  EXPECT_FALSE(with(&BitTiming::phase_segment_1, 11));
  EXPECT_FALSE(with(&BitTiming::phase_segment_1, 0xFFFFFFFF));
  EXPECT_TRUE(with(&BitTiming::phase_segment_2, 8));
  EXPECT_FALSE(with(&BitTiming::phase_segment_2, 9));
  EXPECT_FALSE(with(&BitTiming::phase_segment_2, 0));
  EXPECT_TRUE(with(&BitTiming::jump_width, 4));
  EXPECT_FALSE(with(&BitTiming::jump_width, 5));
  EXPECT_TRUE(with(&BitTiming::prescaler, 1024));
  EXPECT_FALSE(with(&BitTiming::prescaler, 1025));
  EXPECT_FALSE(with(&BitTiming::prescaler, 0));
}

}  // namespace
}  // namespace rigwire::protocols::gs_usb
