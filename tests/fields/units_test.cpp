#include "fields/units.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <utility>

namespace rigwire::fields {
namespace {

/// The stored value of a text, read as a file's is.
double stored(const NumberRule& rule, std::string_view text) {
  const auto quantity = split_quantity(text);
  EXPECT_TRUE(quantity) << text;
  const Unit* unit = quantity->unit.empty() ? &rule.written()
                                            : find_unit(quantity->unit, rule.written().dimension);
  EXPECT_NE(unit, nullptr) << text;
  return rule.to_stored(quantity->value, *unit);
}

TEST(Units, conversion_gives_the_double_nearest_to_the_decimal) {
  constexpr NumberRule length = in("mm");
  EXPECT_EQ(stored(length, "9"), 0.009);  // 9 * 0.001 is 0.009000000000000001
  EXPECT_EQ(stored(length, "1050"), 1.05);
  EXPECT_EQ(stored(length, "1050 mm"), 1.05);
  EXPECT_EQ(stored(length, "1.05 m"), 1.05);
  EXPECT_EQ(stored(length, "0.3 cm"), 0.003);
  EXPECT_EQ(stored(in("ppm"), "7"), 7e-6);
  EXPECT_EQ(stored(in("g", Dimension::mass), "35"), 0.035);
  EXPECT_EQ(stored(in("mA").stored_as("mA"), "0.35 A"), 350.0);
  EXPECT_EQ(stored(in("s").stored_as("ns"), "1.5 ms"), 1.5e6);
}

TEST(Units, angles_and_rates_agree_with_their_definitions) {
  EXPECT_DOUBLE_EQ(stored(in("deg"), "180"), std::acos(-1.0));
  EXPECT_DOUBLE_EQ(stored(in("rpm"), "60"), 2.0 * std::acos(-1.0));
  EXPECT_DOUBLE_EQ(stored(in("deg/h"), "3600"), std::acos(-1.0) / 180.0);
  EXPECT_DOUBLE_EQ(stored(in("deg/sqrt(h)"), "60"), std::acos(-1.0) / 180.0);
  EXPECT_EQ(stored(in("g", Dimension::acceleration), "1"), 9.80665);
  EXPECT_EQ(stored(in("km/h"), "36"), 10.0);
  EXPECT_EQ(stored(in("l/min"), "60"), 0.001);
}

TEST(Units, a_unit_of_another_dimension_is_not_found) {
  EXPECT_EQ(find_unit("mm", Dimension::time), nullptr);
  EXPECT_EQ(find_unit("MM", Dimension::length), nullptr);
  EXPECT_EQ(find_unit("g", Dimension::mass)->denominator, 1000.0);
  EXPECT_EQ(find_unit("g", Dimension::acceleration)->denominator, 1.0);
}

TEST(Units, symbols_are_unique_within_a_dimension_and_the_first_is_the_si_unit) {
  std::set<std::pair<Dimension, std::string_view>> seen;
  std::set<Dimension> dimensions;
  for (const Unit& unit : all_units()) {
    EXPECT_TRUE(seen.insert({unit.dimension, unit.symbol}).second) << unit.symbol;
    EXPECT_GT(unit.numerator, 0.0) << unit.symbol;
    EXPECT_GT(unit.denominator, 0.0) << unit.symbol;
    if (dimensions.insert(unit.dimension).second) {
      EXPECT_EQ(unit.numerator, unit.denominator) << unit.symbol;
    }
  }
}

TEST(Units, quantities_are_taken_apart) {
  const auto check = [](std::string_view text, double value, std::string_view unit) {
    const auto quantity = split_quantity(text);
    ASSERT_TRUE(quantity) << text;
    EXPECT_EQ(quantity->value, value) << text;
    EXPECT_EQ(quantity->unit, unit) << text;
  };
  check("1050 mm", 1050.0, "mm");
  check("5Hz", 5.0, "Hz");
  check(" -3.5e2 ", -350.0, "");
  check("+.5 N m", 0.5, "N m");
  check("-.inf", -std::numeric_limits<double>::infinity(), "");
  check("1e999", std::numeric_limits<double>::infinity(), "");
  EXPECT_TRUE(std::isnan(split_quantity(".nan")->value));
  for (const char* word : {"", "mm", "--5", "+-5", "infinite", "nano", "-"}) {
    EXPECT_FALSE(split_quantity(word)) << word;
  }
}

TEST(Units, messages_name_the_units_of_a_dimension) {
  EXPECT_EQ(allowed_units(Dimension::voltage), "V, mV");
  EXPECT_EQ(allowed_units(Dimension::none), "a bare number");
}

TEST(Units, shortest_text_reads_back) {
  EXPECT_EQ(shortest(0.1), "0.1");
  EXPECT_EQ(shortest(35e6), "35000000");
  EXPECT_EQ(shortest(1e-9), "1e-09");
  EXPECT_EQ(shortest(1e16), "1e+16");
  EXPECT_EQ(shortest(std::nan("")), "nan");
  EXPECT_EQ(shortest(-std::numeric_limits<double>::infinity()), "-inf");
}

TEST(NumberRule, a_bound_rounds_as_the_value_that_is_written_at_it) {
  // 0.3 cm and 3 mm, 1.2 deg: none of them is a double in the member's unit.
  for (const double bound : {0.1, 0.3, 1.1, 1.2, 7.7, 35.7, 81.3, 1050.1}) {
    for (const NumberRule& open : {in("mm"), in("deg"), in("l/min"), in("rpm"), in("km/h")}) {
      const NumberRule rule = open.between(-bound, bound);
      EXPECT_TRUE(rule.contains(rule.to_stored(bound, rule.written()))) << bound;
      EXPECT_TRUE(rule.contains(rule.to_stored(-bound, rule.written()))) << bound;
      EXPECT_FALSE(rule.contains(rule.to_stored(bound * (1 + 1e-12), rule.written()))) << bound;
      EXPECT_FALSE(rule.contains(rule.to_stored(-bound * (1 + 1e-12), rule.written()))) << bound;
      const NumberRule above = open.above(bound);
      EXPECT_FALSE(above.contains(above.to_stored(bound, above.written()))) << bound;
      EXPECT_TRUE(above.contains(above.to_stored(bound * (1 + 1e-12), above.written()))) << bound;
    }
  }
}

TEST(NumberRule, a_range_without_bounds_holds_everything_but_nan) {
  constexpr NumberRule rule = in("m");
  EXPECT_TRUE(rule.contains(std::numeric_limits<double>::max()));
  EXPECT_TRUE(rule.contains(std::numeric_limits<double>::lowest()));
  EXPECT_FALSE(rule.contains(std::nan("")));
}

TEST(NumberRule, the_range_is_said_in_the_written_unit) {
  EXPECT_EQ(in("mm").range_text(), "");
  EXPECT_EQ(in("mm").above(0).range_text(), "> 0 mm");
  EXPECT_EQ(in("mm").at_least(-0.5).range_text(), ">= -0.5 mm");
  EXPECT_EQ(in("MPa").at_most(70).range_text(), "<= 70 MPa");
  EXPECT_EQ(in("deg").between(0, 90).range_text(), "0 .. 90 deg");
  EXPECT_EQ(in("Hz").above(0).at_most(1000).range_text(), "above 0 .. 1000 Hz");
  EXPECT_EQ(in("%").between(0, 100).range_text(), "0 .. 100 %");
  EXPECT_EQ(in("1").between(0, 1).range_text(), "0 .. 1");
  EXPECT_EQ(plain().at_least(1).range_text(), ">= 1");
  EXPECT_EQ(in("deg").stored_as("deg").between(5, 60).range_text(), "5 .. 60 deg");
}

TEST(NumberRule, printed_number_reads_back_exactly_whatever_the_unit) {
  constexpr NumberRule degrees = in("deg");
  constexpr NumberRule millimetres = in("mm");
  constexpr NumberRule litres = in("l/min");
  std::uint64_t state = 12345;
  for (int i = 0; i < 20000; ++i) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    const double value = static_cast<double>(static_cast<std::int64_t>(state)) * 1e-18;
    for (const NumberRule* rule : {&degrees, &millimetres, &litres}) {
      ASSERT_EQ(stored(*rule, rule->print(value)), value) << rule->print(value);
    }
  }
}

TEST(NumberRule, round_values_print_round) {
  EXPECT_EQ(in("deg").print(in("deg").to_stored(30, in("deg").written())), "30 deg");
  EXPECT_EQ(in("mm").print(1.05), "1050 mm");
  EXPECT_EQ(in("MPa").print(35e6), "35 MPa");
  EXPECT_EQ(plain().print(0.1), "0.1");
}

TEST(NumberRule, what_is_no_finite_number_prints_in_the_written_unit) {
  EXPECT_EQ(in("mm").print(std::nan("")), "nan mm");
  EXPECT_EQ(in("mm").print(-std::numeric_limits<double>::infinity()), "-inf mm");
}

}  // namespace
}  // namespace rigwire::fields
