#include "protocols/j1939/field.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace rigwire::protocols::j1939 {
namespace {

constexpr Field kRate{"rate", 0, 0, 16, 1.0 / 128.0, -250.0, -250.0, 251.99, "deg/s"};
constexpr Field kWide{"angle", 0, 0, 24, 1.0 / 32768.0, -250.0, -250.0, 252.0, "deg"};
constexpr Field kState{"state", 0, 10, 2, 1.0, 0.0, 0.0, 1.0, ""};

TEST(Field, RangesOfEachWidthAreThoseOfTheStandard) {
  EXPECT_EQ(greatest_valid(2), 1U);
  EXPECT_EQ(greatest_valid(4), 0xDU);
  EXPECT_EQ(greatest_valid(8), 250U);
  EXPECT_EQ(greatest_valid(10), 1000U);
  EXPECT_EQ(greatest_valid(16), 64255U);
  EXPECT_EQ(greatest_valid(24), 0xFAFFFFU);
  EXPECT_EQ(greatest_valid(32), 0xFAFFFFFFU);
  EXPECT_EQ(not_available_value(2), 3U);
  EXPECT_EQ(not_available_value(16), 0xFFFFU);
  EXPECT_EQ(not_available_value(32), 0xFFFFFFFFU);
  EXPECT_EQ(error_value(2), 2U);
  EXPECT_EQ(error_value(8), 0xFEU);
}

TEST(Field, EveryByteIsClassified) {
  EXPECT_EQ(classify(8, 250), Availability::valid);
  EXPECT_EQ(classify(8, 251), Availability::indicator);
  EXPECT_EQ(classify(8, 253), Availability::indicator);
  EXPECT_EQ(classify(8, 254), Availability::error);
  EXPECT_EQ(classify(8, 255), Availability::not_available);
  EXPECT_EQ(classify(10, 1000), Availability::valid);
  EXPECT_EQ(classify(10, 1001), Availability::indicator);
  EXPECT_EQ(classify(10, 1021), Availability::indicator);
  EXPECT_EQ(classify(16, 0xFAFF), Availability::valid);
  EXPECT_EQ(classify(16, 0xFB00), Availability::indicator);
  EXPECT_EQ(classify(16, 0xFE00), Availability::error);
  EXPECT_EQ(classify(16, 0xFF00), Availability::not_available);
  EXPECT_EQ(classify(24, 0xFE1234), Availability::error);
  EXPECT_EQ(classify(32, 0xFF000000), Availability::not_available);
  EXPECT_EQ(classify(2, 2), Availability::error);
  EXPECT_EQ(classify(4, 0xE), Availability::error);
  for (const unsigned width : {2U, 4U, 8U, 10U, 16U, 24U, 32U}) {
    EXPECT_EQ(classify(width, error_value(width)), Availability::error) << width;
    EXPECT_EQ(classify(width, not_available_value(width)), Availability::not_available) << width;
  }
}

TEST(Field, SaturatesAndNeverReachesTheIndicators) {
  EXPECT_EQ(to_raw(kRate, 0.0), 0x7D00U);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double beyond : {252.0, 262.0, 1e300, kInfinity}) {
    EXPECT_EQ(to_raw(kRate, beyond), 64255U) << beyond;
    EXPECT_EQ(to_raw(kRate, -beyond), 0U) << beyond;
  }
  EXPECT_EQ(to_raw(kRate, std::nan("")), 0xFFFFU);
}

TEST(Field, RoundTripStaysWithinHalfACount) {
  for (double value = -249.9; value < 250.0; value += 0.7301) {
    EXPECT_NEAR(from_raw(kRate, to_raw(kRate, value)).value, value, 0.5 / 128.0 + 1e-12);
    EXPECT_NEAR(from_raw(kWide, to_raw(kWide, value)).value, value, 0.5 / 32768.0 + 1e-12);
  }
}

TEST(Field, BitsOfNeighboursAreLeftAlone) {
  std::array<std::uint8_t, 8> data{};
  data.fill(0xFF);
  put_raw(kState, data, 0);
  EXPECT_EQ(data[1], 0b1111'0011);
  EXPECT_EQ(data[0], 0xFF);
  EXPECT_EQ(get_raw(kState, data), 0U);
}

TEST(Field, ShortMessageReadsAsNotAvailable) {
  const std::array<std::uint8_t, 8> data{};
  for (std::size_t length = 0; length <= 8; ++length) {
    const auto reading = decode(kWide, std::span(data).first(length));
    EXPECT_EQ(reading.valid(), length >= 3) << length;
  }
}

}  // namespace
}  // namespace rigwire::protocols::j1939
