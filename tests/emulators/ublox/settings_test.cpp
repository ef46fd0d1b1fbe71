#include "emulators/ublox/settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

TEST(UbloxSettings, RefuseMoreThanTheLineCarries) {
  UbloxSettings settings;
  settings.measurement_period = 200ms;
  try {
    validate(settings);
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("960 bytes/s at 9600 baud"));
    EXPECT_THAT(error.what(), HasSubstr("bytes every 200 ms"));
  }
  settings.baud = 38400;
  EXPECT_NO_THROW(validate(settings));
}

TEST(UbloxSettings, RefuseUnknownNames) {
  UbloxSettings settings;
  settings.nmea_sentences = {"XYZ"};
  EXPECT_THROW(validate(settings), std::invalid_argument);
  settings.nmea_sentences = {"NAV-SOL"};
  EXPECT_THROW(validate(settings), std::invalid_argument);
  settings = {};
  settings.baud = 12345;
  EXPECT_THROW(validate(settings), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::emulators
