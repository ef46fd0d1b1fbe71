#include "protocols/gs_usb/host_frame.h"

#include <gtest/gtest.h>

#include <vector>

namespace rigwire::protocols::gs_usb {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes bytes(const HostFrameBytes& frame) {
  return {frame.span().begin(), frame.span().end()};
}

const can::Frame kRates{0x0CF02980, true, false, 8, {0, 0, 0x7D, 0, 0, 0x7D, 0xCC, 0}};

TEST(GsUsbFrame, TheWorkedExampleOfTheHeader) {
  HostFrame frame = from_can(kRates);
  frame.echo = 3;
  const Bytes expected{3, 0, 0, 0, 0x80, 0x29, 0xF0, 0x8C, 8,    0,
                       0, 0, 0, 0, 0x7D, 0,    0,    0x7D, 0xCC, 0};
  EXPECT_EQ(bytes(encode_frame(frame)), expected);
  const auto read = decode_frame(expected, false);
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(*read, frame);
  EXPECT_EQ(to_can(*read), kRates);
}

TEST(GsUsbFrame, ReceivedWithItsTimeStamp) {
  HostFrame frame = from_can({0x123, false, false, 2, {0xAA, 0x55}});
  frame.time_stamp_us = 0x01020304;
  const Bytes expected{0xFF, 0xFF, 0xFF, 0xFF, 0x23, 1, 0, 0, 2, 0, 0, 0,
                       0xAA, 0x55, 0,    0,    0,    0, 0, 0, 4, 3, 2, 1};
  EXPECT_EQ(bytes(encode_frame(frame)), expected);
  EXPECT_EQ(*decode_frame(expected, true), frame);
}

TEST(GsUsbFrame, PaddedToOnePacket) {
  const HostFrameBytes padded = encode_frame(from_can(kRates), true);
  ASSERT_EQ(padded.size, 32U);
  for (std::size_t i = 20; i < 32; ++i) {
    EXPECT_EQ(padded.bytes[i], 0);
  }
}

TEST(GsUsbFrame, RemoteFrameHasALengthAndNoData) {
  const can::Frame remote{0x456, false, true, 4, {}};
  const HostFrame frame = from_can(remote);
  EXPECT_EQ(frame.identifier, 0x40000456U);
  EXPECT_EQ(frame.length_code, 4);
  EXPECT_EQ(to_can(frame), remote);
}

TEST(GsUsbFrame, EveryTruncationIsIncomplete) {
  HostFrame frame = from_can(kRates);
  frame.time_stamp_us = 1;
  const Bytes whole = bytes(encode_frame(frame));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto part = std::span(whole).first(size);
    EXPECT_EQ(decode_frame(part, false).ok(), size >= 20) << size;
    EXPECT_TRUE(decode_frame(part, true).incomplete()) << size;
  }
}

TEST(GsUsbFrame, FlexibleDataRateIsRefused) {
  HostFrame frame = from_can(kRates);
  frame.flags = HostFrame::kFlexibleDataRate;
  const auto read = decode_frame(bytes(encode_frame(frame)), false);
  ASSERT_TRUE(read.malformed());
  EXPECT_EQ(read.fault().offset, 10U);
}

TEST(GsUsbFrame, WhatAControllerCannotSend) {
  HostFrame error;
  error.identifier = HostFrame::kError | 0x40;
  EXPECT_EQ(to_can(error), std::nullopt);

  HostFrame too_long;
  too_long.identifier = 0x1FFFFFFF;  // 11-bit format: the upper bits are not there
  too_long.length_code = 0xFF;
  const auto sent = to_can(too_long);
  ASSERT_TRUE(sent.has_value());
  EXPECT_EQ(sent->id, 0x7FFU);
  EXPECT_EQ(sent->length, 8);
}

}  // namespace
}  // namespace rigwire::protocols::gs_usb
