// Frames worked by hand from the maker's document and DBC.
#include "protocols/xsens/messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace rigwire::protocols::xsens {
namespace {

using testing::ElementsAre;

template <std::size_t kCount>
can::Frame frame(MessageId id, const double (&values)[kCount]) {
  return encode(id, values, false);
}

TEST(XsensMessages, KnownFrames) {
  EXPECT_THAT(frame(MessageId::rate_of_turn, {1.0, 0.0, -1.0}).payload(),
              ElementsAre(0x02, 0x00, 0x00, 0x00, 0xFE, 0x00));
  EXPECT_THAT(frame(MessageId::acceleration, {0.0, 0.0, 9.81}).payload(),
              ElementsAre(0x00, 0x00, 0x00, 0x00, 0x09, 0xCF));
  EXPECT_THAT(frame(MessageId::euler_angles, {5.0, -2.5, 90.0}).payload(),
              ElementsAre(0x02, 0x80, 0xFE, 0xC0, 0x2D, 0x00));
  EXPECT_THAT(frame(MessageId::latitude_longitude, {46.0, 7.0}).payload(),
              ElementsAre(0x2E, 0x00, 0x00, 0x00, 0x03, 0x80, 0x00, 0x00));
  EXPECT_THAT(frame(MessageId::quaternion, {1.0, 0.0, 0.0, -1.0}).payload(),
              ElementsAre(0x7F, 0xFF, 0, 0, 0, 0, 0x80, 0x01));
  EXPECT_THAT(frame(MessageId::utc, {26, 6, 1, 8, 30, 59, 0.9999}).payload(),
              ElementsAre(26, 6, 1, 8, 30, 59, 0x27, 0x0F));
  EXPECT_THAT(frame(MessageId::temperature, {-1.5}).payload(), ElementsAre(0xFE, 0x80));
  EXPECT_THAT(frame(MessageId::sample_time, {4294967295.0}).payload(),
              ElementsAre(0xFF, 0xFF, 0xFF, 0xFF));
  EXPECT_EQ(frame(MessageId::acceleration, {0.0, 0.0, 0.0}).id, 0x34U);
  EXPECT_FALSE(frame(MessageId::acceleration, {0.0, 0.0, 0.0}).extended);
  EXPECT_TRUE(encode(MessageId::acceleration, std::array{0.0, 0.0, 0.0}, true).extended);
}

TEST(XsensMessages, EveryFieldComesBackWithinHalfACountOverItsWholeRange) {
  for (const Message& message : messages()) {
    for (std::size_t i = 0; i < message.signals.size(); ++i) {
      const can::Signal& signal = message.signals[i];
      for (int step = 0; step <= 64; ++step) {
        const double value = signal.lower + (signal.upper - signal.lower) * step / 64.0;
        Values values{};
        values[i] = value;
        const auto read =
            decode(encode(static_cast<MessageId>(message.id),
                          std::span(values).first(message.signals.size()), step % 2 == 0));
        ASSERT_TRUE(read.ok());
        EXPECT_EQ(read->message, &message);
        EXPECT_LE(std::abs(read->values[i] - value), 0.5 * signal.scale * (1 + 1e-9))
            << message.name << ' ' << signal.name;
        for (std::size_t other = 0; other < message.signals.size(); ++other) {
          EXPECT_TRUE(other == i || read->values[other] == 0.0) << message.name;
        }
      }
    }
  }
}

TEST(XsensMessages, BeyondTheRangeIsSaturated) {
  EXPECT_THAT(frame(MessageId::acceleration, {1e9, -1e9, 0.0}).payload(),
              ElementsAre(0x7F, 0xFF, 0x80, 0x00, 0x00, 0x00));
}

TEST(XsensMessages, ShortUnknownAndRemoteFramesAreRefused) {
  can::Frame sent = frame(MessageId::acceleration, {0.0, 0.0, 9.81});
  for (std::uint8_t length = 0; length < 6; ++length) {
    sent.length = length;
    EXPECT_TRUE(decode(sent).malformed());
  }
  sent.length = 8;
  EXPECT_TRUE(decode(sent).ok());
  sent.length = 9;
  EXPECT_TRUE(decode(sent).malformed());
  sent.length = 6;
  sent.remote = true;
  EXPECT_TRUE(decode(sent).malformed());
  sent.remote = false;
  sent.id = 0x36;
  EXPECT_TRUE(decode(sent).malformed());
}

TEST(XsensMessages, ExponentOfTheIncrementIsTheGreatestThatFits) {
  EXPECT_EQ(increment_exponent(0.0), 17U);
  EXPECT_EQ(increment_exponent(0.2499), 17U);
  EXPECT_EQ(increment_exponent(0.25), 16U);
  EXPECT_EQ(increment_exponent(9.81), 11U);
}

TEST(XsensLayouts, BigEndianPositionsAreThoseOfTheMostSignificantBit) {
  for (const auto& layout : layouts(false, 100e-6)) {
    if (layout.name == "rate_of_turn") {
      ASSERT_EQ(layout.signals.size(), 3U);
      EXPECT_EQ(layout.signals[0].bit, 7);  // byte 0
      EXPECT_EQ(layout.signals[2].bit, 39);
      EXPECT_EQ(layout.signals[0].scale, 0.001953125);
      EXPECT_TRUE(layout.signals[0].is_signed);
    }
  }
}

}  // namespace
}  // namespace rigwire::protocols::xsens
