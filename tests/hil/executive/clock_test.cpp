#include "hil/executive/clock.h"

#include <gtest/gtest.h>

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;

TEST(ClockMode, ParsesWhatTheCommandLineOffers) {
  EXPECT_EQ(parse_clock_mode("real"), (ClockMode{ClockMode::Kind::real, 1.0}));
  EXPECT_EQ(parse_clock_mode("free")->kind, ClockMode::Kind::free);
  EXPECT_EQ(parse_clock_mode("step")->kind, ClockMode::Kind::step);
  EXPECT_EQ(parse_clock_mode("scaled:0.5"), (ClockMode{ClockMode::Kind::scaled, 0.5}));
  EXPECT_EQ(to_string(*parse_clock_mode("scaled:2.50")), "scaled:2.5");
}

TEST(ClockMode, RefusesNonsense) {
  for (const char* text : {"", "Real", "scaled", "scaled:", "scaled:0", "scaled:-1", "scaled:nan",
                           "scaled:inf", "scaled:1x", "scaled:1001"}) {
    EXPECT_FALSE(parse_clock_mode(text).has_value()) << text;
  }
}

TEST(PacedClock, MapsThereAndBackToTheNanosecondInRealTime) {
  const WallTime start{123'456'789ns};
  const PacedClock clock(start, 1.0);
  const SimTime day = kStart + 24h + 1ns;
  EXPECT_EQ(clock.wall_of(day), start + 24h + 1ns);
  EXPECT_EQ(clock.at(start + 24h + 1ns), day);
}

TEST(PacedClock, ScalesBothWays) {
  const PacedClock clock(WallTime{}, 4.0);
  EXPECT_EQ(clock.at(WallTime{250ms}), kStart + 1s);
  EXPECT_EQ(clock.wall_of(kStart + 1s), WallTime{250ms});
}

TEST(PacedClock, ASlipMovesEveryLaterDeadline) {
  PacedClock clock(WallTime{}, 1.0);
  clock.slip(30ms);
  EXPECT_EQ(clock.at(WallTime{1s}), kStart + 970ms);
  EXPECT_EQ(clock.wall_of(kStart + 970ms), WallTime{1s});
  EXPECT_EQ(clock.slipped(), 30ms);
}

TEST(PacedClock, StandsAndGoesOnFromWhereItStood) {
  PacedClock clock(WallTime{}, 2.0);
  clock.stand(kStart + 3s);
  EXPECT_EQ(clock.at(WallTime{9s}), kStart + 3s);
  EXPECT_EQ(clock.wall_of(kStart + 4s), WallTime::max());
  EXPECT_EQ(clock.wall_of(kStart + 2s), WallTime{1s});
  clock.go_on(WallTime{10s});
  EXPECT_EQ(clock.at(WallTime{11s}), kStart + 5s);
  EXPECT_EQ(clock.wall_of(kStart + 5s), WallTime{11s});
  clock.go_on(WallTime{20s});
  EXPECT_EQ(clock.at(WallTime{11s}), kStart + 5s) << "it went already";
  EXPECT_EQ(clock.slipped(), 0s);
}

TEST(PacedClock, AnotherPaceBeginsWhereTheFormerEnds) {
  PacedClock clock(WallTime{}, 1.0);
  clock.set_factor(WallTime{2s}, 10.0);
  EXPECT_EQ(clock.at(WallTime{2s}), kStart + 2s);
  EXPECT_EQ(clock.at(WallTime{3s}), kStart + 12s);
  EXPECT_EQ(clock.wall_of(kStart + 12s), WallTime{3s});
}

}  // namespace
}  // namespace rigwire::hil
