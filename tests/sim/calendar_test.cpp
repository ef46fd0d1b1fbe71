#include "sim/samples/calendar.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace rigwire {
namespace {

using namespace std::chrono_literals;

TEST(Calendar, StartsAtTheGpsEpoch) {
  const Calendar calendar({1980, 1, 6, 0, 0, 0, 0});
  EXPECT_EQ(calendar.gps(kStart), (GpsTime{0, 0}));
  EXPECT_EQ(calendar.leap_seconds(kStart), 0);
}

TEST(Calendar, KnownGpsWeekOf2026) {
  // 2026-06-01 08:00:00 UTC is Monday of GPS week 2421; GPS leads by 18 s.
  const Calendar calendar({2026, 6, 1, 8, 0, 0, 0});
  const GpsTime gps = calendar.gps(kStart);
  EXPECT_EQ(gps.week, 2421);
  EXPECT_EQ(gps.time_of_week_ns, (86400LL + 8 * 3600 + 18) * 1'000'000'000);
}

TEST(Calendar, LeapSecondOf2016IsPrintedAsSecond60) {
  const Calendar calendar({2016, 12, 31, 23, 59, 59, 500'000'000});
  EXPECT_EQ(format_utc(calendar.utc(kStart)), "2016-12-31T23:59:59.5Z");
  EXPECT_EQ(format_utc(calendar.utc(kStart + 500ms)), "2016-12-31T23:59:60Z");
  EXPECT_EQ(format_utc(calendar.utc(kStart + 1499ms)), "2016-12-31T23:59:60.999Z");
  EXPECT_EQ(format_utc(calendar.utc(kStart + 1500ms)), "2017-01-01T00:00:00Z");
  EXPECT_EQ(calendar.leap_seconds(kStart + 1499ms), 17);
  EXPECT_EQ(calendar.leap_seconds(kStart + 1500ms), 18);
}

TEST(Calendar, MayStartWithinALeapSecond) {
  const Calendar calendar({2016, 12, 31, 23, 59, 60, 0});
  EXPECT_EQ(format_utc(calendar.utc(kStart)), "2016-12-31T23:59:60Z");
  EXPECT_EQ(format_utc(calendar.utc(kStart + 1s)), "2017-01-01T00:00:00Z");
  EXPECT_THROW(Calendar({2018, 12, 31, 23, 59, 60, 0}), std::invalid_argument);
}

TEST(Calendar, WeekRollsOverWithinARun) {
  const Calendar calendar({2026, 6, 6, 23, 59, 41, 0});  // Saturday, one second before GPS midnight
  EXPECT_EQ(calendar.gps(kStart).week, 2421);
  EXPECT_EQ(calendar.gps(kStart + 1s), (GpsTime{2422, 0}));
}

TEST(Calendar, HourOfTheVelodyneClockFollowsUtc) {
  const Calendar calendar({2026, 6, 1, 8, 59, 59, 999'999'000});
  EXPECT_EQ(calendar.nanoseconds_of_hour(kStart), 3'599'999'999'000);
  EXPECT_EQ(calendar.nanoseconds_of_hour(kStart + 1us), 0);
}

TEST(Calendar, AlignsEpochsToTheGpsSecond) {
  const Calendar calendar({2026, 6, 1, 8, 0, 0, 250'000'000});
  EXPECT_EQ(calendar.align_to_gps(kStart, 1s), kStart + 750ms);
  EXPECT_EQ(calendar.align_to_gps(kStart + 750ms, 1s), kStart + 750ms);
}

TEST(Calendar, RefusesWhatIsNoDate) {
  EXPECT_THROW(Calendar({2025, 2, 29, 0, 0, 0, 0}), std::invalid_argument);
  EXPECT_THROW(Calendar({1979, 12, 31, 0, 0, 0, 0}), std::invalid_argument);
  EXPECT_THROW(Calendar({2100, 1, 1, 0, 0, 0, 0}), std::invalid_argument);
  EXPECT_THROW((void)parse_utc("2026-06-01 08:00:00"), std::invalid_argument);
  EXPECT_THROW((void)parse_utc("2026-06-01T08:00:00.Z"), std::invalid_argument);
  EXPECT_THROW((void)parse_utc("2026-06-01T08:00:-1Z"), std::invalid_argument);
  EXPECT_EQ(format_utc(parse_utc("2026-06-01T08:00:00.25Z")), "2026-06-01T08:00:00.25Z");
}

}  // namespace
}  // namespace rigwire
