#include "protocols/nmea/sentence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
