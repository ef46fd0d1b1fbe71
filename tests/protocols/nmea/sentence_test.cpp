#include "protocols/nmea/sentence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>

#include "sentences.h"

namespace rigwire::protocols::nmea {
namespace {

TEST(NmeaSentence, TellsIncompleteFromMalformed) {
  const std::string good = "$GPGLL,,,,,,V,N*64\r\n";
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_TRUE(decode_sentence(bytes_of(good).first(size)).incomplete()) << size;
  }
  EXPECT_EQ(decode_sentence(bytes_of(good)).consumed(), good.size());
  for (const char* const bad : {"GPGLL*00\r\n", "$GPGLL,,,,,,V,N*65\r\n", "$GPGLL,,,,,,V,N\r\n",
                                "$GP\x01*00\r\n", "$*0G\n", "$GP$GPGLL,,,,,,V,N*64\r\n", "$\n"}) {
    const std::string line = bad;
    EXPECT_TRUE(decode_sentence(bytes_of(line)).malformed()) << bad;
  }
}

// The judge is printf; a sign in front of nothing is left out.
TEST(NmeaSentence, NumbersAreAsPrintfRoundsThem) {
  const auto written = [](const auto& put) {
    Sentence sentence("X");
    put(sentence);
    const std::string text(sentence.text());
    return text.substr(3, text.find('*') - 3);
  };
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> exponent(-6.0, 9.0);
  for (int i = 0; i < 20'000; ++i) {
    // Random ones, and halves of the last decimal.
    const int decimals = i % 4;
    const double sign = i % 3 == 0 ? -1.0 : 1.0;
    const double value = i % 2 == 0 ? sign * std::pow(10.0, exponent(random))
                                    : sign * (2.0 * static_cast<double>(random() % 100'000) + 1.0) /
                                          2.0 * std::pow(10.0, -decimals);
    std::array<char, 64> printed{};
    std::snprintf(printed.data(), printed.size(), "%.*f", decimals, value);
    std::string expected = printed.data();
    if (expected.find_first_not_of("-0.") == std::string::npos && expected[0] == '-') {
      expected.erase(0, 1);
    }
    ASSERT_EQ(written([&](Sentence& s) { s.decimal(decimals, value); }), expected);
    const auto whole = static_cast<int>(random() % 2'000'001) - 1'000'000;
    std::snprintf(printed.data(), printed.size(), "%0*d", i % 9, whole);
    ASSERT_EQ(written([&](Sentence& s) { s.number(i % 9, whole); }), printed.data());
    std::snprintf(printed.data(), printed.size(), "%X", static_cast<unsigned>(whole));
    ASSERT_EQ(written([&](Sentence& s) { s.hexadecimal(whole); }), printed.data());
  }
}

TEST(NmeaSentence, EndlessLineIsMalformed) {
  const std::string line = "$" + std::string(1000, 'A');
  EXPECT_TRUE(decode_sentence(bytes_of(line)).malformed());
}

TEST(NmeaSentence, SplitsFields) {
  const std::string line = "$PUBX,40,GLL,1,0,0,0,0,0*5D\n";
  const auto view = decode_sentence(bytes_of(line));
  ASSERT_TRUE(view.ok());
  EXPECT_EQ(view->address, "PUBX");
  EXPECT_EQ(view->type(), "PUBX");
  EXPECT_EQ(view->field_count, 8U);
  EXPECT_EQ(view->field(1), "GLL");
  EXPECT_EQ(view->field(8), "");
}

}  // namespace
}  // namespace rigwire::protocols::nmea
