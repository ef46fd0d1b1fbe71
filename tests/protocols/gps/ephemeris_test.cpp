#include "protocols/gps/ephemeris.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "protocols/gps/bits.h"

namespace rigwire::protocols::gps {
namespace {

// Places and scales once more, from tables 20-I and 20-III by document bit number, as independent
// reference: most significant part, then least significant part (0 = not split).
struct DocumentField {
  double Ephemeris::*member;
  int subframe;
  int first_bit, bits, second_bit, second_bits;
  bool negative;
  int exponent;
  bool semicircles;
};
constexpr std::array kDocument{
    DocumentField{&Ephemeris::group_delay_s, 1, 197, 8, 0, 0, true, -31, false},
    DocumentField{&Ephemeris::clock_time_s, 1, 219, 16, 0, 0, false, 4, false},
    DocumentField{&Ephemeris::clock_drift_rate, 1, 241, 8, 0, 0, true, -55, false},
    DocumentField{&Ephemeris::clock_drift, 1, 249, 16, 0, 0, true, -43, false},
    DocumentField{&Ephemeris::clock_bias_s, 1, 271, 22, 0, 0, true, -31, false},
    DocumentField{&Ephemeris::radius_sine_m, 2, 69, 16, 0, 0, true, -5, false},
    DocumentField{&Ephemeris::mean_motion_difference, 2, 91, 16, 0, 0, true, -43, true},
    DocumentField{&Ephemeris::mean_anomaly_rad, 2, 107, 8, 121, 24, true, -31, true},
    DocumentField{&Ephemeris::latitude_cosine_rad, 2, 151, 16, 0, 0, true, -29, false},
    DocumentField{&Ephemeris::eccentricity, 2, 167, 8, 181, 24, false, -33, false},
    DocumentField{&Ephemeris::latitude_sine_rad, 2, 211, 16, 0, 0, true, -29, false},
    DocumentField{&Ephemeris::sqrt_semi_major_axis, 2, 227, 8, 241, 24, false, -19, false},
    DocumentField{&Ephemeris::ephemeris_time_s, 2, 271, 16, 0, 0, false, 4, false},
    DocumentField{&Ephemeris::inclination_cosine_rad, 3, 61, 16, 0, 0, true, -29, false},
    DocumentField{&Ephemeris::ascending_node_rad, 3, 77, 8, 91, 24, true, -31, true},
    DocumentField{&Ephemeris::inclination_sine_rad, 3, 121, 16, 0, 0, true, -29, false},
    DocumentField{&Ephemeris::inclination_rad, 3, 137, 8, 151, 24, true, -31, true},
    DocumentField{&Ephemeris::radius_cosine_m, 3, 181, 16, 0, 0, true, -5, false},
    DocumentField{&Ephemeris::argument_of_perigee_rad, 3, 197, 8, 211, 24, true, -31, true},
    DocumentField{&Ephemeris::ascending_node_rate, 3, 241, 24, 0, 0, true, -43, true},
    DocumentField{&Ephemeris::inclination_rate, 3, 279, 14, 0, 0, true, -43, true},
};

std::uint32_t document_bits(const Subframe& sent, int first, int count) {
  std::uint32_t value = 0;
  for (int bit = first; bit < first + count; ++bit) {
    const auto word = static_cast<std::size_t>((bit - 1) / kWordBits);
    const auto data = decode_word(sent.words[word], word == 0 ? 0 : sent.words[word - 1]);
    value = value * 2U + ((data.value() >> (23 - (bit - 1) % kWordBits)) & 1U);
  }
  return value;
}

double step(const DocumentField& field) {
  return std::ldexp(field.semicircles ? kSemicircle_rad : 1.0, field.exponent);
}
int bits(const DocumentField& field) {
  return field.bits + field.second_bits;
}
double greatest_count(const DocumentField& field) {
  if (field.member == &Ephemeris::clock_time_s || field.member == &Ephemeris::ephemeris_time_s) {
    return 604'784 / 16;
  }
  return std::ldexp(1.0, field.negative ? bits(field) - 1 : bits(field)) - 1.0;
}
double least_count(const DocumentField& field) {
  return field.negative ? -std::ldexp(1.0, bits(field) - 1) : 0.0;
}

SubframeData subframe(const Ephemeris& ephemeris, std::uint8_t id, std::int32_t week,
                      std::uint32_t first_step = 0) {
  SubframeData data;
  set_head(data, {.next_step = (first_step + id) % kStepsPerWeek, .subframe_id = id});
  put_ephemeris(data, id, ephemeris, week);
  return data;
}

Decoded<Ephemeris> there_and_back(const Ephemeris& ephemeris, std::int32_t week,
                                  std::uint32_t first_step = 0) {
  std::array<SubframeData, 3> data;
  for (std::uint8_t id = 1; id <= 3; ++id) {
    data[id - 1U] = *decode_subframe(encode_subframe(subframe(ephemeris, id, week, first_step)));
  }
  return decode_ephemeris(data[0], data[1], data[2], ephemeris.prn, week);
}

TEST(GpsEphemeris, EveryScaledFieldKeepsItsLimitsAndStandsAtTheDocumentsPlace) {
  for (const DocumentField& field : kDocument) {
    for (const double count : {least_count(field), least_count(field) + 1.0, 1.0,
                               greatest_count(field) - 1.0, greatest_count(field)}) {
      Ephemeris ephemeris;
      ephemeris.prn = 7;
      ephemeris.week = 2300;
      ephemeris.*field.member = count * step(field);
      EXPECT_EQ(quantised(ephemeris), ephemeris);
      const auto sent = encode_subframe(
          subframe(ephemeris, static_cast<std::uint8_t>(field.subframe), ephemeris.week));
      const std::uint32_t high = document_bits(sent, field.first_bit, field.bits);
      const std::uint32_t low =
          field.second_bits > 0 ? document_bits(sent, field.second_bit, field.second_bits) : 0;
      const std::uint64_t mask = (std::uint64_t{1} << bits(field)) - 1U;
      const auto expected = static_cast<std::uint64_t>(static_cast<std::int64_t>(count)) & mask;
      EXPECT_EQ((std::uint64_t{high} << field.second_bits) | low, expected);

      auto back = there_and_back(ephemeris, ephemeris.week);
      ASSERT_TRUE(back.ok());
      EXPECT_EQ((*back).*field.member, ephemeris.*field.member);
    }
  }
}

TEST(GpsEphemeris, ValuesBeyondAFieldAreClamped) {
  for (const DocumentField& field : kDocument) {
    Ephemeris ephemeris;
    const double greatest =
        least_count(field) < 0.0 ? -least_count(field) - 1.0 : std::ldexp(1.0, bits(field)) - 1.0;
    ephemeris.*field.member = (greatest + 2.0) * step(field);
    EXPECT_EQ(quantised(ephemeris).*field.member, greatest * step(field));
    ephemeris.*field.member = (least_count(field) - 1.0) * step(field);
    EXPECT_EQ(quantised(ephemeris).*field.member, least_count(field) * step(field));
    ephemeris.*field.member = std::nan("");
    EXPECT_EQ(quantised(ephemeris).*field.member, 0.0);
  }
}

TEST(GpsEphemeris, WholeNumbersComeBackAtTheirLimits) {
  Ephemeris ephemeris{.prn = 32,
                      .week = 2300,
                      .l2_code = 3,
                      .l2_p_data_off = true,
                      .accuracy_index = 15,
                      .health = 63,
                      .issue_of_clock = 0x3FF,
                      .issue_of_ephemeris = 0xFF,
                      .long_fit = true,
                      .age_of_data_offset = 31};
  const auto back = there_and_back(ephemeris, 2300);
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(*back, ephemeris);
}

TEST(GpsEphemeris, QuantisedIsWhatAReceiverDecodes) {
  Ephemeris ephemeris{.prn = 1, .week = 2300};
  for (const DocumentField& field : kDocument) {
    ephemeris.*field.member = 0.123456789 * greatest_count(field) * step(field);
  }
  const auto back = there_and_back(ephemeris, 2300);
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(*back, quantised(ephemeris));
  EXPECT_NE(*back, ephemeris);
  for (const DocumentField& field : kDocument) {
    EXPECT_LE(std::abs((*back).*field.member - ephemeris.*field.member), 0.5001 * step(field));
  }
}

TEST(GpsEphemeris, WeekOfToeIsFoundAcrossTheWeeksEnd) {
  Ephemeris ephemeris{.prn = 1, .week = 2301, .ephemeris_time_s = 0.0};
  auto back = there_and_back(ephemeris, 2300, kStepsPerWeek - 5);
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(back->week, 2301) << "sent in the last half minute of the week before";
  ephemeris = {.prn = 1, .week = 2300, .ephemeris_time_s = 604'784.0};
  back = there_and_back(ephemeris, 2301, 0);
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(back->week, 2300) << "sent in the first half minute of the week after";
}

TEST(GpsEphemeris, WeekOfTenBitsIsTheOneNearestToTheHint) {
  EXPECT_EQ(unrolled_week(0, 1024, 2048), 2048);
  EXPECT_EQ(unrolled_week(1023, 1024, 2048), 2047);
  EXPECT_EQ(unrolled_week(1, 1024, 1023), 1025);
  EXPECT_EQ(unrolled_week(300 % 256, 256, 300), 300);
  EXPECT_EQ(unrolled_week(5, 1024, 0), 5);
}

TEST(GpsEphemeris, SubframesOfDifferentIssuesAreRefused) {
  const Ephemeris old{.prn = 1, .week = 2300, .issue_of_clock = 10, .issue_of_ephemeris = 10};
  const Ephemeris fresh{.prn = 1, .week = 2300, .issue_of_clock = 11, .issue_of_ephemeris = 11};
  const auto decode = [](const Ephemeris& a, const Ephemeris& b, const Ephemeris& c) {
    return decode_ephemeris(subframe(a, 1, 2300), subframe(b, 2, 2300), subframe(c, 3, 2300), 1,
                            2300);
  };
  EXPECT_TRUE(decode(old, old, old).ok());
  EXPECT_EQ(decode(old, fresh, fresh).fault().offset, 1U);
  EXPECT_EQ(decode(old, old, fresh).fault().offset, 2U);
  EXPECT_TRUE(decode_ephemeris(subframe(old, 1, 2300), subframe(old, 3, 2300),
                               subframe(old, 2, 2300), 1, 2300)
                  .malformed());
}

TEST(GpsEphemeris, AccuracyIndexIsTheLeastThatBounds) {
  EXPECT_EQ(accuracy_index(0.0), 0);
  EXPECT_EQ(accuracy_index(2.4), 0);
  EXPECT_EQ(accuracy_index(2.41), 1);
  EXPECT_EQ(accuracy_index(6144.0), 14);
  EXPECT_EQ(accuracy_index(1e9), 15);
}

TEST(GpsEphemeris, NominalAccuraciesHaveTheirOwnIndex) {
  EXPECT_EQ(nominal_accuracy_m(1), 2.8);
  EXPECT_EQ(nominal_accuracy_m(5), 11.3);
  EXPECT_EQ(nominal_accuracy_m(7), 32.0);
  for (std::uint8_t index = 0; index <= 15; ++index) {
    EXPECT_EQ(accuracy_index(nominal_accuracy_m(index)), index);
  }
}

}  // namespace
}  // namespace rigwire::protocols::gps
