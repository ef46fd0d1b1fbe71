#include "protocols/can/message.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rigwire::protocols::can {
namespace {

using testing::ElementsAre;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

OwnedSignal byte(std::string name, std::uint16_t bit, std::uint16_t width = 8) {
  OwnedSignal signal;
  signal.name = std::move(name);
  signal.bit = bit;
  signal.width = width;
  return unlimited(signal);
}
OwnedSignal at(OwnedSignal signal, std::uint16_t multiplexor, std::vector<RawRange> values) {
  signal.multiplexor = multiplexor;
  signal.present_at = std::move(values);
  return signal;
}

/// Two pages that share a byte, the second with a page number of its own, and what both have.
/// Those that depend stand before what they depend on.
OwnedMessage paged() {
  OwnedMessage message;
  message.name = "paged";
  message.id = 0x123;
  message.length = 4;
  message.fill = 0xEE;
  message.signals = {at(byte("deep", 16), 3, {{7, 7}}), at(byte("first", 8), 2, {{0, 0}, {5, 6}}),
                     byte("page", 0), at(byte("inner_page", 8), 2, {{1, 1}}), byte("always", 24)};
  return message;
}

TEST(Message, MultiplexedSignalsAreThereAtTheirValues) {
  const OwnedMessage message = paged();
  EXPECT_TRUE(well_formed(message));
  const auto bytes = [&](std::vector<double> values) {
    const Frame frame = encode(message, values);
    EXPECT_EQ(frame.id, 0x123U);
    const auto payload = frame.payload();
    return std::vector<std::uint8_t>(payload.begin(), payload.end());
  };
  // Order: deep, first, page, inner page, always.
  EXPECT_THAT(bytes({1, 2, 0, 7, 9}), ElementsAre(0, 2, 0xEE, 9));
  EXPECT_THAT(bytes({1, 2, 1, 7, 9}), ElementsAre(1, 7, 1, 9));
  EXPECT_THAT(bytes({1, 2, 1, 8, 9}), ElementsAre(1, 8, 0xEE, 9));
  EXPECT_THAT(bytes({1, 2, 6, 7, 9}), ElementsAre(6, 2, 0xEE, 9));
  EXPECT_THAT(bytes({1, 2, 4, 7, 9}), ElementsAre(4, 0xEE, 0xEE, 9));
  // A page that is not known leaves the fill, which is no page here.
  EXPECT_THAT(bytes({1, 2, kNan, 7, 9}), ElementsAre(0xEE, 0xEE, 0xEE, 9));
}

TEST(Message, AbsentSignalsReadAsNotAvailable) {
  const OwnedMessage message = paged();
  const std::vector<std::uint8_t> payload{1, 7, 55, 9};
  EXPECT_EQ(get(message, 0, payload).value, 55.0);
  EXPECT_FALSE(get(message, 1, payload).valid());
  EXPECT_EQ(get(message, 3, payload).value, 7.0);
  // Cut off in front of the value, of the inner page, of the page.
  EXPECT_FALSE(get(message, 0, std::span(payload).first(2)).valid());
  EXPECT_FALSE(get(message, 0, std::span(payload).first(1)).valid());
  EXPECT_FALSE(get(message, 0, std::span(payload).first(0)).valid());
  EXPECT_FALSE(get(message, 9, payload).valid());
}

TEST(Message, WhatCannotBeCodedIsNamed) {
  OwnedMessage message = paged();
  message.signals[4].bit = 25;
  ASSERT_TRUE(defect(message));
  EXPECT_EQ(defect(message)->signal, 4U);
  EXPECT_EQ(defect(message)->what, "the signal does not lie within its message");

  message = paged();
  message.signals[3].multiplexor = 17;
  ASSERT_TRUE(defect(message));
  EXPECT_EQ(defect(message)->signal, 0U);  // depends on the one that is lost

  message = paged();
  message.signals[2] = at(message.signals[2], 3, {{0, 255}});  // in a ring
  EXPECT_TRUE(defect(message));
  EXPECT_FALSE(get(message, 2, std::vector<std::uint8_t>{1, 1, 1, 1}).valid());
  EXPECT_THAT(encode(message, std::vector<double>{1, 2, 1, 7, 9}).payload(),
              ElementsAre(0xEE, 0xEE, 0xEE, 9));
}

TEST(Message, SignalsThatShareBitsWhileBothAreThereAreFound) {
  OwnedMessage message = paged();
  EXPECT_FALSE(overlap(message));
  message.signals[1].present_at = {{0, 1}};  // as the inner page
  ASSERT_TRUE(overlap(message));
  EXPECT_EQ(*overlap(message), std::pair(std::size_t{1}, std::size_t{3}));
  message = paged();
  message.signals.push_back(byte("within", 27, 2));
  EXPECT_EQ(*overlap(message), std::pair(std::size_t{4}, std::size_t{5}));
  EXPECT_FALSE(well_formed(message));
}

TEST(Message, FewerValuesLeaveTheRest) {
  OwnedMessage message;
  message.length = 2;
  message.signals = {byte("a", 0), byte("b", 8)};
  EXPECT_THAT(encode(message, std::vector<double>{3}).payload(), ElementsAre(3, 0));
  EXPECT_THAT(encode(message, std::vector<double>{3, 4, 5}).payload(), ElementsAre(3, 4));
  message.length = 40;
  EXPECT_EQ(encode(message, std::vector<double>{3}).length, 8);
}

TEST(Message, OwnedRowsNameTheReservedPatterns) {
  Signal row;
  row.reserved = Reserved::j1939;
  row.name = "engine's speed, rear";
  row.unit = "1";
  row.spn = 190;
  const OwnedSignal signal = owned(row);
  EXPECT_EQ(signal.name, "engines_speed_rear");
  EXPECT_EQ(signal.unit, "");
  EXPECT_EQ(signal.text, "SPN 190");
  ASSERT_EQ(signal.values.size(), 2U);
  EXPECT_EQ(signal.values[0].raw, 254);
  EXPECT_EQ(signal.values[1].text, "not available");
}

}  // namespace
}  // namespace rigwire::protocols::can
