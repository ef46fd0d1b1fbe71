// tshark's J1939 dissector, which shares no table with us, names group, priority and addresses of
// what a StarFire sends; the values are read from its bytes by positions written down here anew.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "emulators/starfire/node.h"
#include "j1939_capture.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;

double number(const Seen& frame, std::size_t first, std::size_t size) {
  double value = 0.0;
  for (std::size_t i = size; i-- > 0;) {
    value = value * 256.0 + frame.bytes.at(first + i);
  }
  return value;
}

TEST(StarFireWire, TsharkReadsGroupsAddressesAndValues) {
  const auto file = std::filesystem::temp_directory_path() /
                    ("rigwire_starfire_" + std::to_string(getpid()) + ".pcap");
  CanCapture capture(file);
  StarFireSettings settings;
  settings.start_up = 0s;
  StarFireNode node(settings, Calendar{UtcTime{2026, 6, 1, 8, 0, 0, 0}}, capture);
  for (int i = 0; i < 6; ++i) {
    GnssSample sample;
    sample.time = kStart + i * kStarFirePeriod;
    sample.fix = GnssFix::three_d;
    sample.latitude_deg = -33.8567844;
    sample.longitude_deg = 151.2152967;
    sample.ellipsoid_height_m = 27.5;
    sample.geoid_separation_m = 22.25;
    sample.velocity_ned_mps = {0.0, -2.5, 0.0};
    node.update(sample);
  }
  node.advance(kStart + 2s);
  capture.close();

  const auto seen = tshark(file);
  std::filesystem::remove(file);
  int positions = 0;
  int directions = 0;
  for (const Seen& frame : seen) {
    EXPECT_EQ(frame.source, 28U);
    EXPECT_EQ(frame.priority, 6U);
    if (frame.pgn == 65267) {
      ++positions;
      EXPECT_NEAR(number(frame, 0, 4) * 1e-7 - 210.0, -33.8567844, 0.51e-7);
      EXPECT_NEAR(number(frame, 4, 4) * 1e-7 - 210.0, 151.2152967, 0.51e-7);
    } else if (frame.pgn == 65256) {
      ++directions;
      EXPECT_NEAR(number(frame, 0, 2) / 128.0, 270.0, 0.5 / 128.0);
      EXPECT_NEAR(number(frame, 2, 2) / 256.0 / 3.6, 2.5, 0.5 / 256.0 / 3.6);
      EXPECT_EQ(number(frame, 4, 2), 0xFFFF);
      EXPECT_NEAR(number(frame, 6, 2) * 0.125 - 2500.0, 5.25, 0.0626);
    }
  }
  EXPECT_EQ(positions, 6);
  EXPECT_EQ(directions, 6);
}

}  // namespace
}  // namespace rigwire::emulators
