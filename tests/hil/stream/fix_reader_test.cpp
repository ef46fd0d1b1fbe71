#include "hil/stream/fix_reader.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace rigwire::hil {
namespace {

// Its checksum by hand: the exclusive or of all characters between $ and *.
constexpr std::string_view kFix =
    "$GPGGA,080001.00,4925.4820,N,00745.1020,E,1,08,1.0,200.0,M,48.0,M,,*5C\r\n";
constexpr std::string_view kNoFix = "$GPGGA,080001.00,,,,,0,00,99.99,,M,,M,,*6F\r\n";

std::string sentence(std::string_view body) {
  unsigned sum = 0;
  for (const char letter : body) {
    sum ^= static_cast<unsigned char>(letter);
  }
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  return "$" + std::string(body) + "*" + kDigits[sum / 16] + kDigits[sum % 16] + "\r\n";
}

std::vector<ReceiverFix> read(std::string_view text, std::size_t piece) {
  FixReader reader;
  std::vector<ReceiverFix> fixes;
  for (std::size_t at = 0; at < text.size(); at += piece) {
    const std::string_view part = text.substr(at, piece);
    reader.take({reinterpret_cast<const std::uint8_t*>(part.data()), part.size()},
                [&](const ReceiverFix& fix) { fixes.push_back(fix); });
  }
  return fixes;
}

TEST(FixReader, ReadsGgaInPiecesOfAnySize) {
  const std::string body(kFix.substr(1, kFix.find('*') - 1));
  const std::string text = "rest of one\r\n" + sentence(body) + "noise" + sentence(body);
  for (const std::size_t piece : std::vector<std::size_t>{1, 7, 1000}) {
    const auto fixes = read(text, piece);
    ASSERT_EQ(fixes.size(), 2U) << piece;
    EXPECT_NEAR(fixes[0].place.latitude_deg, 49.4247, 1e-6);
    EXPECT_NEAR(fixes[0].place.longitude_deg, 7.7517, 1e-6);
    EXPECT_NEAR(fixes[0].place.ellipsoid_height_m, 248.0, 1e-6);
  }
}

TEST(FixReader, StandardDeviationsAreThoseOfGstElseAGuess) {
  const std::string fix = sentence(kFix.substr(1, kFix.find('*') - 1));
  const std::string told = sentence("GPGST,080001.00,1.2,,,,0.7,0.9,1.6");
  const auto fixes = read(fix + told + fix + fix, 50);
  ASSERT_EQ(fixes.size(), 3U);
  // A dilution of 1.0, alone.
  EXPECT_TRUE(fixes[0].guessed);
  EXPECT_EQ(*fixes[0].sigma_m, (std::array<double, 3>{15.0 / 2.45, 15.0 / 2.45, 23.0 / 1.96}));
  EXPECT_FALSE(fixes[1].guessed);
  EXPECT_EQ(*fixes[1].sigma_m, (std::array<double, 3>{0.9, 0.7, 1.6}));
  EXPECT_TRUE(fixes[2].guessed) << "that of the epoch before";
}

TEST(FixReader, OfFloatRtkNothingIsGuessed) {
  const auto fixes =
      read(sentence("GPGGA,080001.00,4925.4820,N,00745.1020,E,5,08,1.0,200.0,M,48.0,M,,"), 50);
  ASSERT_EQ(fixes.size(), 1U);
  EXPECT_FALSE(fixes[0].sigma_m);
}

TEST(FixReader, AReceiverWithoutFixTellsNone) {
  EXPECT_TRUE(read(sentence(std::string(kNoFix.substr(1, kNoFix.find('*') - 1))), 10).empty());
}

TEST(FixReader, AMessageThatNeverEndsIsForgotten) {
  const std::string body(kFix.substr(1, kFix.find('*') - 1));
  EXPECT_EQ(read("\xB5\x62" + std::string(3 * protocols::gnss_stream::Splitter::kMostKept, '\xFF') +
                     sentence(body),
                 64)
                .size(),
            1U);
}

}  // namespace
}  // namespace rigwire::hil
