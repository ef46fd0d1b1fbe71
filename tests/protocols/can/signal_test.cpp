// Rows worked by hand; J1939's ranges after SAE J1939-71, 5.1.4.
#include "protocols/can/signal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace rigwire::protocols::can {
namespace {

using testing::ElementsAre;

constexpr double kSignalNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr Coding j1939_row(std::uint16_t bit, std::uint16_t width, double scale, double offset,
                           double lower, double upper) {
  Coding row;
  row.bit = bit;
  row.width = width;
  row.reserved = Reserved::j1939;
  row.scale = scale;
  row.offset = offset;
  row.lower = lower;
  row.upper = upper;
  return row;
}
constexpr Coding kRate = j1939_row(0, 16, 1.0 / 128.0, -250.0, -250.0, 251.99);
constexpr Coding kWide = j1939_row(0, 24, 1.0 / 32768.0, -250.0, -250.0, 252.0);
constexpr Coding kState = j1939_row(10, 2, 1.0, 0.0, 0.0, 1.0);

/// A number over all that it carries.
constexpr Coding number(std::uint16_t bit, std::uint16_t width, bool is_signed = false,
                        ByteOrder order = ByteOrder::little_endian, double scale = 1.0,
                        double offset = 0.0) {
  Coding row;
  row.bit = bit;
  row.width = width;
  row.is_signed = is_signed;
  row.order = order;
  row.scale = scale;
  row.offset = offset;
  return unlimited(row);
}
constexpr Coding floating(std::uint16_t bit, std::uint16_t width,
                          ByteOrder order = ByteOrder::little_endian) {
  Coding row = number(bit, width, true, order);
  row.is_float = true;
  return unlimited(row);
}

using Bytes = std::array<std::uint8_t, 8>;
Bytes bytes_of(const Coding& signal, double value, std::uint8_t fill = 0) {
  Bytes data;
  data.fill(fill);
  put(signal, data, value);
  return data;
}
double returned(const Coding& signal, double value) {
  return get(signal, bytes_of(signal, value)).value;
}

TEST(ReservedPatterns, RangesOfEachWidthAreThoseOfTheStandard) {
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
  EXPECT_EQ(error_value(16), 0xFEFFU);
}

TEST(ReservedPatterns, EveryByteIsClassified) {
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
  for (unsigned width = 2; width <= 64; ++width) {
    EXPECT_EQ(classify(width, greatest_valid(width)), Availability::valid) << width;
    EXPECT_EQ(classify(width, error_value(width)), Availability::error) << width;
    EXPECT_EQ(classify(width, not_available_value(width)), Availability::not_available) << width;
  }
}

TEST(ReservedPatterns, NumbersSaturateBelowThem) {
  EXPECT_EQ(to_raw(kRate, 0.0), 0x7D00U);
  for (const double beyond : {252.0, 262.0, 1e300}) {
    EXPECT_EQ(to_raw(kRate, beyond), 64255U) << beyond;
    EXPECT_EQ(to_raw(kRate, -beyond), 0U) << beyond;
  }
  for (std::uint16_t width = 2; width <= 64; ++width) {
    // Limits above what the width has do not reach the patterns either.
    const Coding row = j1939_row(0, width, 1.0, 0.0, 0.0, 1e30);
    EXPECT_EQ(to_raw(row, 1e30), greatest_valid(width)) << width;
    EXPECT_TRUE(from_raw(row, to_raw(row, 1e30)).valid()) << width;
  }
}

TEST(ReservedPatterns, NanIsNotAvailableAndInfinityAnError) {
  EXPECT_EQ(to_raw(kRate, kSignalNan), 0xFFFFU);
  EXPECT_EQ(to_raw(kRate, kInfinity), 0xFEFFU);
  EXPECT_EQ(to_raw(kRate, -kInfinity), 0xFEFFU);
  EXPECT_TRUE(std::isnan(get(kRate, bytes_of(kRate, kSignalNan)).number()));
  EXPECT_EQ(get(kRate, bytes_of(kRate, -kInfinity)).number(), kInfinity);
  EXPECT_TRUE(std::isnan(from_raw(kRate, 0xFB00).number()));  // an indicator
}

TEST(Signal, RoundTripStaysWithinHalfACount) {
  for (double value = -249.9; value < 250.0; value += 0.7301) {
    EXPECT_NEAR(from_raw(kRate, to_raw(kRate, value)).value, value, 0.5 / 128.0 + 1e-12);
    EXPECT_NEAR(from_raw(kWide, to_raw(kWide, value)).value, value, 0.5 / 32768.0 + 1e-12);
  }
}

TEST(Signal, BitsOfNeighboursAreLeftAlone) {
  Bytes data;
  data.fill(0xFF);
  put_raw(kState, data, 0);
  EXPECT_EQ(data[1], 0b1111'0011);
  EXPECT_EQ(data[0], 0xFF);
  EXPECT_EQ(get_raw(kState, data), 0U);
  data.fill(0);
  put_raw(kState, data, ~std::uint64_t{0});
  EXPECT_THAT(data, ElementsAre(0, 0b1100, 0, 0, 0, 0, 0, 0));
}

TEST(Signal, ShortMessageReadsAsNotAvailable) {
  const Bytes data{};
  constexpr Coding kBig = number(7, 24, false, ByteOrder::big_endian);
  for (std::size_t length = 0; length <= 8; ++length) {
    const auto start = std::span(data).first(length);
    EXPECT_EQ(get(kWide, start).valid(), length >= 3) << length;
    EXPECT_EQ(get(kBig, start).valid(), length >= 3) << length;
  }
}

// cantools, tests/files/dbc/motohawk.dbc (ExampleMessage) and the README's candump of it:
//   SG_ Temperature : 0|12@0- (0.01,250) [229.52|270.47], SG_ AverageRadius : 6|6@0+ (0.1,0) [0|5],
//   SG_ Enable : 7|1@0+; 1F0 [8] 80 4A 0F ...: enabled, 0.0 m, 255.92 degK.
TEST(Signal, MotorolaExampleOfCantools) {
  Coding temperature = number(0, 12, true, ByteOrder::big_endian, 0.01, 250.0);
  temperature.lower = 229.52;
  temperature.upper = 270.47;
  const Coding radius = number(6, 6, false, ByteOrder::big_endian, 0.1);
  const Coding enable = number(7, 1, false, ByteOrder::big_endian);
  const Bytes seen{0x80, 0x4A, 0x0F, 0, 0, 0, 0, 0};
  EXPECT_NEAR(get(temperature, seen).value, 255.92, 1e-9);
  EXPECT_EQ(get(radius, seen).value, 0.0);
  EXPECT_EQ(get(enable, seen).value, 1.0);
  // By hand: 10 counts, 0000'0000'1010, over bit 0, the second byte and the upper three bits of
  // the third; 32 in bits 6 .. 1.
  Bytes data{};
  put(temperature, data, 250.1);
  put(radius, data, 3.2);
  put(enable, data, 1.0);
  EXPECT_THAT(data, ElementsAre(0xC0, 0x01, 0x40, 0, 0, 0, 0, 0));
  EXPECT_EQ(get_raw(temperature, data), 10U);
  // The least value: -2048 counts are the sign bit alone.
  put(temperature, data, -1e9);
  EXPECT_THAT(data, ElementsAre(0xC1, 0x00, 0x00, 0, 0, 0, 0, 0));
}

TEST(Signal, ByteOrdersByHand) {
  EXPECT_THAT(bytes_of(number(4, 12), 0xABC), ElementsAre(0xC0, 0xAB, 0, 0, 0, 0, 0, 0));
  EXPECT_THAT(bytes_of(number(7, 16, false, ByteOrder::big_endian), 0x1234),
              ElementsAre(0x12, 0x34, 0, 0, 0, 0, 0, 0));
  EXPECT_THAT(bytes_of(number(3, 12, false, ByteOrder::big_endian), 0xABC),
              ElementsAre(0x0A, 0xBC, 0, 0, 0, 0, 0, 0));
  EXPECT_THAT(bytes_of(number(2, 5, true, ByteOrder::big_endian), -2.0, 0xFF),
              ElementsAre(0xFF, 0xBF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF));
}

/// Both ends of every width, wherever it can begin, in both orders and with both signs.
TEST(Signal, EndsOfEveryWidthAtEveryPlace) {
  for (const ByteOrder order : {ByteOrder::little_endian, ByteOrder::big_endian}) {
    for (std::uint16_t width = 1; width <= 64; ++width) {
      for (std::uint16_t bit = 0; bit < 64; ++bit) {
        for (const bool is_signed : {false, true}) {
          const Coding row = number(bit, width, is_signed, order);
          if (!fits(row, 8)) {
            EXPECT_FALSE(defect(row, 8).empty());
            continue;
          }
          ASSERT_EQ(defect(row, 8), "");
          const std::uint64_t half = greatest_raw(width) / 2;
          const std::uint64_t least = is_signed ? half + 1 : 0;
          const std::uint64_t greatest = is_signed ? half : greatest_raw(width);
          ASSERT_EQ(to_raw(row, 1e300), greatest) << width;
          ASSERT_EQ(to_raw(row, kInfinity), greatest) << width;
          ASSERT_EQ(to_raw(row, -1e300), least) << width;
          for (const std::uint64_t raw : {least, greatest}) {
            Bytes data;
            data.fill(0xA5);
            const Bytes before = data;
            put_raw(row, data, raw);
            ASSERT_EQ(get_raw(row, data), raw) << width << ' ' << bit;
            for (std::size_t i = 0; i < data.size(); ++i) {
              ASSERT_EQ((data[i] ^ before[i]) & ~bits_in(row, i), 0) << width << ' ' << bit;
            }
            const Reading read = get(row, data);
            ASSERT_TRUE(read.valid());
            ASSERT_EQ(to_raw(row, read.value), raw) << width << ' ' << bit;
          }
        }
      }
    }
  }
}

TEST(Signal, SignedLimitsDoNotWrap) {
  const Coding byte = number(0, 8, true);
  EXPECT_EQ(carried(byte).lower, -128.0);
  EXPECT_EQ(carried(byte).upper, 127.0);
  EXPECT_EQ(to_raw(byte, 127.6), 0x7FU);
  EXPECT_EQ(to_raw(byte, -128.6), 0x80U);
  EXPECT_EQ(returned(byte, -1.0), -1.0);
  EXPECT_EQ(bytes_of(byte, -1.0)[0], 0xFF);
  const Coding bit = number(0, 1, true);  // 0 and -1
  EXPECT_EQ(to_raw(bit, 5.0), 0U);
  EXPECT_EQ(returned(bit, -5.0), -1.0);
}

TEST(Signal, SixtyFourBitsSaturate) {
  EXPECT_EQ(to_raw(number(0, 64), 18446744073709551615.0), ~std::uint64_t{0});
  EXPECT_EQ(to_raw(number(0, 64), 9223372036854775808.0), std::uint64_t{1} << 63U);
  EXPECT_EQ(to_raw(number(0, 64, true), 9223372036854775808.0), (std::uint64_t{1} << 63U) - 1U);
  EXPECT_EQ(to_raw(number(0, 64, true), -9223372036854775808.0), std::uint64_t{1} << 63U);
  EXPECT_EQ(returned(number(0, 64, true), -3.0), -3.0);
}

TEST(Signal, LimitsNarrowerThanTheWidthHold) {
  Coding row = number(0, 16, false, ByteOrder::little_endian, 0.5, -10.0);
  row.lower = -5.0;
  row.upper = 20.0;
  EXPECT_EQ(returned(row, 1e9), 20.0);
  EXPECT_EQ(returned(row, -1e9), -5.0);
}

TEST(Signal, NegativeScaleMirrors) {
  const Coding row = number(0, 8, false, ByteOrder::little_endian, -0.5, 10.0);
  EXPECT_EQ(carried(row).lower, -117.5);
  EXPECT_EQ(carried(row).upper, 10.0);
  EXPECT_EQ(to_raw(row, 9.0), 2U);
  EXPECT_EQ(to_raw(row, 1e9), 0U);
  EXPECT_EQ(to_raw(row, -1e9), 255U);
}

// IEEE 754: 1.5 is 3FC00000, -2 is C0000000'00000000.
TEST(Signal, FloatingPointByHand) {
  EXPECT_THAT(bytes_of(floating(0, 32), 1.5), ElementsAre(0, 0, 0xC0, 0x3F, 0, 0, 0, 0));
  EXPECT_THAT(bytes_of(floating(7, 32, ByteOrder::big_endian), 1.5),
              ElementsAre(0x3F, 0xC0, 0, 0, 0, 0, 0, 0));
  EXPECT_THAT(bytes_of(floating(7, 64, ByteOrder::big_endian), -2.0),
              ElementsAre(0xC0, 0, 0, 0, 0, 0, 0, 0));
  Coding scaled = floating(0, 32);
  scaled.scale = 2.0;
  scaled.offset = 1.0;
  EXPECT_EQ(to_raw(scaled, 4.0), 0x3FC00000U);
  EXPECT_EQ(returned(scaled, 4.0), 4.0);
}

TEST(Signal, FloatingPointCarriesWhatIsNoNumber) {
  for (const Coding& row : {floating(0, 32), floating(0, 64)}) {
    EXPECT_EQ(get(row, bytes_of(row, kSignalNan)).availability, Availability::not_available);
    EXPECT_EQ(get(row, bytes_of(row, -kInfinity)).availability, Availability::error);
    Coding limited = row;
    limited.lower = -10.0;
    limited.upper = 10.0;
    EXPECT_EQ(returned(limited, kInfinity), 10.0);
  }
  EXPECT_EQ(returned(floating(0, 32), 1e300), double{std::numeric_limits<float>::max()});
}

TEST(Signal, NanWithoutAPatternLeavesTheBits) {
  EXPECT_THAT(bytes_of(number(0, 16), kSignalNan, 0xEE),
              ElementsAre(0xEE, 0xEE, 0xEE, 0xEE, 0xEE, 0xEE, 0xEE, 0xEE));
  EXPECT_EQ(to_raw(number(0, 16), kSignalNan), 0U);
}

TEST(Signal, RowsThatAreNoneAreNamedAndHarmless) {
  std::array<Coding, 10> rows;
  rows.fill(number(0, 16));
  rows[0].width = 0;
  rows[1].width = 134;
  rows[2].bit = 60;
  rows[3] = number(56, 9, false, ByteOrder::big_endian);
  rows[4].is_float = true;
  rows[5].reserved = Reserved::j1939;
  rows[5].is_signed = true;
  rows[6].scale = 0.0;
  rows[7].offset = kInfinity;
  rows[8].lower = rows[8].upper + 1.0;
  rows[9].upper = kSignalNan;
  for (const Coding& row : rows) {
    EXPECT_FALSE(defect(row, 8).empty()) << &row - rows.data();
    for (const double value : {0.0, 1e300, -1e300, kSignalNan, kInfinity}) {
      const Bytes data = bytes_of(row, value);
      (void)get(row, data);
      (void)from_raw(row, to_raw(row, value));
      Coding reserved = row;
      reserved.reserved = Reserved::j1939;
      (void)get(unlimited(reserved), bytes_of(unlimited(reserved), value));
    }
  }
  EXPECT_THAT(bytes_of(rows[2], 65535.0), ElementsAre(0, 0, 0, 0, 0, 0, 0, 0));
  EXPECT_EQ(defect(rows[6], 8), "scale and offset are finite, and the scale is not 0");
}

}  // namespace
}  // namespace rigwire::protocols::can
