#include "hil/stream/fix_reader.h"

#include <gtest/gtest.h>

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

std::vector<sim::GeodeticPoint> read(std::string_view text, std::size_t piece) {
  FixReader reader;
  std::vector<sim::GeodeticPoint> places;
  for (std::size_t at = 0; at < text.size(); at += piece) {
    const std::string_view part = text.substr(at, piece);
    reader.take({reinterpret_cast<const std::uint8_t*>(part.data()), part.size()},
                [&](const sim::GeodeticPoint& place) { places.push_back(place); });
  }
  return places;
}

TEST(FixReader, ReadsGgaInPiecesOfAnySize) {
  const std::string body(kFix.substr(1, kFix.find('*') - 1));
  const std::string text = "rest of one\r\n" + sentence(body) + "noise" + sentence(body);
  for (const std::size_t piece : std::vector<std::size_t>{1, 7, 1000}) {
    const auto places = read(text, piece);
    ASSERT_EQ(places.size(), 2U) << piece;
    EXPECT_NEAR(places[0].latitude_deg, 49.4247, 1e-6);
    EXPECT_NEAR(places[0].longitude_deg, 7.7517, 1e-6);
    EXPECT_NEAR(places[0].ellipsoid_height_m, 248.0, 1e-6);
  }
}

TEST(FixReader, AReceiverWithoutFixTellsNone) {
  EXPECT_TRUE(read(sentence(std::string(kNoFix.substr(1, kNoFix.find('*') - 1))), 10).empty());
}

TEST(FixReader, AMessageThatNeverEndsIsForgotten) {
  const std::string body(kFix.substr(1, kFix.find('*') - 1));
  EXPECT_EQ(
      read("\xB5\x62" + std::string(3 * ReceiverMessages::kMostKept, '\xFF') + sentence(body), 64)
          .size(),
      1U);
}

}  // namespace
}  // namespace rigwire::hil
