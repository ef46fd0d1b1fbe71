#include "protocols/galileo/page.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "protocols/gps/bits.h"

namespace rigwire::protocols::galileo {
namespace {

double angle(std::int64_t steps, int exponent) {
  return static_cast<double>(steps) * std::ldexp(gps::kSemicircle_rad, exponent);
}

/// Each figure near an end of its field.
gps::Ephemeris example() {
  gps::Ephemeris e;
  e.prn = 33;
  e.week = 2421;
  e.issue_of_clock = 1023;
  e.issue_of_ephemeris = 255;
  e.accuracy_index = 107;
  e.l2_code = 1;
  e.group_delay_s = std::ldexp(-512, -32);
  e.second_delay_s = std::ldexp(511, -32);
  e.clock_time_s = 10'079 * 60.0;
  e.clock_bias_s = std::ldexp(-(1 << 30), -34);
  e.clock_drift = std::ldexp((1 << 20) - 1, -46);
  e.clock_drift_rate = std::ldexp(-32, -59);
  e.ephemeris_time_s = 10'079 * 60.0;
  e.sqrt_semi_major_axis = std::ldexp(2'852'413'441.0, -19);
  e.eccentricity = std::ldexp(4'294'967'295.0, -33);
  e.mean_anomaly_rad = angle(-2'147'483'648, -31);
  e.mean_motion_difference = angle(-32'768, -43);
  e.ascending_node_rad = angle(2'147'483'647, -31);
  e.inclination_rad = angle(668'101'689, -31);
  e.argument_of_perigee_rad = angle(-1, -31);
  e.ascending_node_rate = angle(-8'388'608, -43);
  e.inclination_rate = angle(8'191, -43);
  e.latitude_cosine_rad = std::ldexp(-32'768, -29);
  e.latitude_sine_rad = std::ldexp(32'767, -29);
  e.radius_cosine_m = std::ldexp(-32'768, -5);
  e.radius_sine_m = std::ldexp(32'767, -5);
  e.inclination_cosine_rad = std::ldexp(-1, -29);
  e.inclination_sine_rad = std::ldexp(1, -29);
  return e;
}

std::array<Word, 5> words_of(const gps::Ephemeris& e, const PageTime& time) {
  std::array<Word, 5> words;
  for (std::uint8_t type = 1; type <= 5; ++type) {
    words[type - 1U] = word(type, e, {}, time);
  }
  return words;
}

TEST(GalileoPage, WordsSayTheOrbitToTheBit) {
  const auto decoded = decode_ephemeris(words_of(example(), {2421, 604'790}));
  ASSERT_TRUE(decoded.ok());
  EXPECT_EQ(*decoded, example());
}

TEST(GalileoPage, OrbitsOfTheWeekBeforeAreOfTheWeekBefore) {
  const auto decoded = decode_ephemeris(words_of(example(), {2422, 12}));
  ASSERT_TRUE(decoded.ok());
  EXPECT_EQ(decoded->week, 2421);
}

TEST(GalileoPage, WordsOfTwoIssuesAreNoOrbit) {
  auto words = words_of(example(), {2421, 0});
  gps::Ephemeris later = example();
  later.issue_of_clock = 0;
  words[2] = word(3, later, {}, {2421, 0});
  EXPECT_TRUE(decode_ephemeris(words).malformed());
}

TEST(GalileoPage, PagesHoldTheirWordAndAChecksum) {
  const Word sent = word(4, example(), {}, {2421, 100});
  const Page page = page_of(sent);
  const auto read = word_of(page);
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(*read, sent);
  EXPECT_EQ(page[0] >> 30U, 0b00U) << "even part, nominal page";
  EXPECT_EQ(page[4] >> 30U, 0b10U) << "odd part, nominal page";
  // Every bit but tails, padding and synchronisation.
  for (std::size_t bit = 0; bit < 256; ++bit) {
    const bool covered =
        bit < 114 || (bit >= 128 && bit < 128 + 18) || (bit >= 128 + 82 && bit < 128 + 106);
    Page bent = page;
    bent[bit / 32] ^= 0x8000'0000U >> bit % 32;
    EXPECT_EQ(word_of(bent).malformed(), covered) << bit;
  }
}

// Both signals bring words 1 to 5 within 30 s, in another order.
TEST(GalileoPage, EveryFrameBringsTheWholeOrbit) {
  std::multiset<int> on_e1;
  std::multiset<int> on_e5b;
  for (std::uint32_t t = 0; t < 30; t += 2) {
    on_e1.insert(type_on_e1(t));
    on_e5b.insert(type_on_e5b(t));
  }
  EXPECT_EQ(on_e1, on_e5b);
  for (int type = 1; type <= 6; ++type) {
    EXPECT_EQ(on_e1.count(type), 1U);
  }
  EXPECT_EQ(type_on_e1(0), 2);
  EXPECT_EQ(type_on_e5b(0), 1);
}

}  // namespace
}  // namespace rigwire::protocols::galileo
