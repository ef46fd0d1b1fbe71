// From samples to what the receiver claims: time, limits, hold, masks, faults.
#include "emulators/ublox/navigator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "fault_period.h"
#include "protocols/ubx/navigation.h"
#include "rig.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using namespace protocols::ubx;

class UbloxNavigatorTest : public UbloxReceiverTest {
 protected:
  UbloxSettings with(std::vector<std::string> ubx_messages) const {
    UbloxSettings settings = quiet();
    settings.ubx_messages = std::move(ubx_messages);
    return settings;
  }
  void configure(UbloxReceiver& receiver, std::uint16_t mask, CfgNav5 wanted) {
    wanted.mask = mask;
    say(receiver, wanted);
    run(receiver, now_ + 20ms);
  }
};

TEST_F(UbloxNavigatorTest, ClockRestsAddUpToWholeMilliseconds) {
  UbloxReceiver receiver(with({"NAV-SOL", "NAV-TIMEGPS", "NAV-PVT", "NAV-CLOCK"}), calendar_,
                         line_);
  // A clock that gains 0.3 ms a second and is read at its own whole milliseconds.
  run(receiver, kStart + 9900ms, [](GnssSample& s) {
    const std::int64_t gained_ns = 300'123 * (s.time.time_since_epoch() / 1s);
    const std::int64_t label_ns = (gained_ns + 500'000) / 1'000'000 * 1'000'000;
    s.measured_after = Duration{(label_ns - gained_ns) % 1'000'000};
    s.clock_label_offset = Duration{0};
    s.clock_bias_s = -to_seconds(s.measured_after);
  });
  const auto sol = decoded<NavSol>();
  const auto gps = decoded<NavTimegps>();
  const auto pvt = decoded<NavPvt>();
  const auto clock = decoded<NavClock>();
  ASSERT_EQ(sol.size(), 9U);
  bool negative = false;
  for (std::size_t i = 0; i < sol.size(); ++i) {
    EXPECT_EQ((sol[i].time_of_week_rest_ns + clock[i].bias_ns) % 1'000'000, 0);
    EXPECT_EQ(sol[i].time_of_week_ms % 1000, 0U);
    EXPECT_EQ(gps[i].time_of_week_ms, sol[i].time_of_week_ms);
    EXPECT_EQ(gps[i].time_of_week_rest_ns, sol[i].time_of_week_rest_ns);
    EXPECT_EQ(pvt[i].nanosecond, sol[i].time_of_week_rest_ns);
    EXPECT_LE(std::abs(pvt[i].nanosecond), 500'000);
    negative |= pvt[i].nanosecond < 0;
  }
  EXPECT_TRUE(negative);
}

TEST_F(UbloxNavigatorTest, WeekIsResolvedFromTheFirmwaresOn) {
  const auto shown_week = [&](UtcTime start, std::uint16_t rollover) {
    calendar_ = Calendar(start);
    now_ = kStart;
    line_ = {};
    UbloxReceiver receiver(with({"NAV-TIMEGPS"}), calendar_, line_);
    run(receiver, kStart + 500ms);
    CfgNavx5 wanted;
    wanted.mask1 = 1 << 9;
    wanted.week_rollover = rollover;
    say(receiver, wanted);
    run(receiver, kStart + 1900ms);
    return decoded<NavTimegps>().at(0).week;
  };
  EXPECT_EQ(shown_week({2026, 6, 1, 8, 0, 0, 0}, 1691), 2421);
  EXPECT_EQ(shown_week({2012, 6, 3, 0, 0, 0, 0}, 1691), 1691);
  EXPECT_EQ(shown_week({1999, 8, 22, 0, 1, 0, 0}, 1691), 1024 + 1024);
  EXPECT_EQ(shown_week({1999, 8, 22, 0, 1, 0, 0}, 1000), 1024);
  EXPECT_EQ(shown_week({2032, 2, 1, 0, 0, 0, 0}, 1691), 1693);  // rolled over
  EXPECT_EQ(shown_week({2035, 1, 1, 0, 0, 0, 0}, 2000), 2869);
}

TEST_F(UbloxNavigatorTest, RolledOverWeekShowsItsOwnDate) {
  calendar_ = Calendar(UtcTime{1999, 9, 1, 12, 0, 0, 0});  // 13 leap seconds
  UbloxReceiver receiver(with({"NAV-TIMEUTC"}), calendar_, line_);
  run(receiver, kStart + 1900ms);
  const NavTimeutc utc = decoded<NavTimeutc>().at(0);
  // 1024 weeks are 7168 days.
  EXPECT_EQ(utc.year, 2019);
  EXPECT_EQ(utc.month, 4);
  EXPECT_EQ(utc.day, 17);
  EXPECT_EQ(utc.hour, 12);
  EXPECT_EQ(utc.second, 1);
}

TEST_F(UbloxNavigatorTest, LeapSecondsAreTheFirmwaresUntilPage18) {
  UbloxSettings settings = with({"NAV-TIMEGPS", "NAV-PVT"});
  settings.time_to_first_fix = 10s;
  // Monday 08:00 is second 115218 of the week, 468 s into a cycle of the almanac.
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 70s);
  const auto gps = decoded<NavTimegps>();
  const auto pvt = decoded<NavPvt>();
  for (std::size_t i = 4; i < gps.size(); ++i) {
    const bool heard = i + 1 >= 534 - 468;
    EXPECT_EQ(gps[i].leap_seconds, heard ? 18 : 16) << i;
    EXPECT_EQ(gps[i].valid, heard ? 7 : 3) << i;
    EXPECT_EQ(pvt[i].second, (i + 1 + (heard ? 0U : 2U)) % 60) << i;
    EXPECT_EQ(pvt[i].valid & 4, heard ? 4 : 0) << i;
  }
}

TEST_F(UbloxNavigatorTest, WrongLeapSecondShiftsUtcOnly) {
  UbloxSettings settings = with({"NAV-TIMEGPS", "NAV-TIMEUTC"});
  settings.faults = {{between(2s, 4s), WrongLeapSecondFault{1}}};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 5900ms);
  const auto gps = decoded<NavTimegps>();
  const auto utc = decoded<NavTimeutc>();
  ASSERT_EQ(gps.size(), 5U);
  for (std::size_t i = 0; i < gps.size(); ++i) {
    const bool wrong = i == 1 || i == 2;
    EXPECT_EQ(gps[i].leap_seconds, wrong ? 19 : 18);
    EXPECT_EQ(gps[i].time_of_week_ms, (115'219 + i) * 1000);
    EXPECT_EQ(utc[i].second, wrong ? i : i + 1);
  }
}

// A recorded cold start of a NEO-7P: 4 satellites and HDOP 2.35 for 37 s, then 5, 6 after 54 s, 7
// after 84 s. Once all were there in the first epoch.
TEST_F(UbloxNavigatorTest, FirstFixAfterAColdStartBeginsWithFourSatellites) {
  UbloxSettings settings = with({"NAV-SOL", "NAV-DOP", "NAV-POSLLH"});
  settings.time_to_first_fix = 20s;
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 170500ms, [](GnssSample& sample) {
    for (SatelliteView& view : sample.satellites) {
      view.azimuth_rad = std::fmod(2.4 * view.number, 6.28);
      view.elevation_rad = 0.15 + 0.2 * (view.number % 5);
    }
  });
  const auto sol = decoded<NavSol>();
  const auto dop = decoded<NavDop>();
  const auto position = decoded<NavPosllh>();
  ASSERT_EQ(sol.size(), 170U);
  const auto at = [](int after_fix_s) { return static_cast<std::size_t>(20 - 1 + after_fix_s); };
  EXPECT_EQ(sol[at(-2)].fix_type, kFixNone);
  const std::vector<std::pair<int, int>> expected{{0, 4},  {36, 4}, {37, 5},  {53, 5},
                                                  {54, 6}, {84, 7}, {131, 7}, {132, 8}};
  for (const auto& [after_fix_s, used] : expected) {
    EXPECT_EQ(sol[at(after_fix_s)].satellites_used, used) << after_fix_s;
    EXPECT_EQ(sol[at(after_fix_s)].fix_type, kFix3d);
  }
  EXPECT_GT(dop[at(0)].horizontal_e2, dop[at(132)].horizontal_e2);
  EXPECT_EQ(dop[at(132)].horizontal_e2, 159);
  EXPECT_GT(position[at(0)].horizontal_accuracy_mm, position[at(132)].horizontal_accuracy_mm);
  // PDOP is that of its parts.
  const double parts = std::hypot(dop[at(0)].horizontal_e2, dop[at(0)].vertical_e2);
  EXPECT_NEAR(dop[at(0)].position_e2, parts, 2.0);
}

// 3890 of 3890 sentences of a recorded NEO-7P with SBAS corrections have an empty age.
TEST_F(UbloxNavigatorTest, AgeOfSbasCorrectionsIsNotTold) {
  UbloxSettings settings = quiet();
  settings.nmea_sentences = {"GGA"};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 1500ms, [](GnssSample& sample) {
    sample.differential = true;
    sample.differential_age_s = 1.0;
  });
  const auto sentences = line_.sentences();
  ASSERT_FALSE(sentences.empty());
  EXPECT_NE(sentences.back().find(",W,2,"), std::string::npos) << sentences.back();
  EXPECT_NE(sentences.back().find(",M,,0000*"), std::string::npos) << sentences.back();
}

TEST_F(UbloxNavigatorTest, FrozenFixRepeatsPositionWhileTimeGoesOn) {
  UbloxSettings settings = with({"NAV-POSLLH", "NAV-SOL"});
  settings.faults = {{between(2500ms, 4500ms), FrozenFixFault{}}};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 5900ms,
      [](GnssSample& s) { s.latitude_deg += 1e-3 * to_seconds(s.time); });
  const auto position = decoded<NavPosllh>();
  ASSERT_EQ(position.size(), 5U);
  EXPECT_EQ(position[2].latitude_e7deg, position[1].latitude_e7deg);
  EXPECT_EQ(position[3].latitude_e7deg, position[1].latitude_e7deg);
  EXPECT_EQ(position[4].latitude_e7deg, position[1].latitude_e7deg + 30'000);
  for (std::size_t i = 1; i < position.size(); ++i) {
    EXPECT_EQ(position[i].time_of_week_ms, position[i - 1].time_of_week_ms + 1000);
  }
  EXPECT_EQ(decoded<NavSol>().at(2).flags, 0xDD);
}

TEST_F(UbloxNavigatorTest, StaticHoldKeepsThePosition) {
  UbloxReceiver receiver(with({"NAV-POSLLH", "NAV-VELNED"}), calendar_, line_);
  run(receiver, kStart + 500ms);
  CfgNav5 wanted;
  wanted.static_hold_cmps = 50;
  wanted.static_hold_distance_m = 20;
  configure(receiver, 1 << 6, wanted);
  const auto crawl = [](GnssSample& s) {
    s.velocity_ned_mps = {0.0001, 0.0, 0.0};
    s.latitude_deg += 1e-5 * to_seconds(s.time);  // wanders by 1.1 m each second
  };
  run(receiver, kStart + 25'900ms, crawl);
  const auto held = decoded<NavPosllh>();
  ASSERT_EQ(held.size(), 25U);
  for (std::size_t i = 1; i < 18; ++i) {
    EXPECT_EQ(held[i].latitude_e7deg, held[0].latitude_e7deg);
  }
  EXPECT_GT(held[20].latitude_e7deg, held[0].latitude_e7deg + 1'000);  // farther than 20 m: let go
  EXPECT_EQ(decoded<NavVelned>().at(3).ground_speed_cmps, 0U);
  run(receiver, kStart + 27'900ms);  // 1.4 m/s
  EXPECT_EQ(decoded<NavPosllh>().back().latitude_e7deg, 494'240'123);
}

TEST_F(UbloxNavigatorTest, MasksOfNav5DecideWhichSatellitesCount) {
  UbloxReceiver receiver(with({"NAV-SOL"}), calendar_, line_);
  run(receiver, kStart + 500ms);
  CfgNav5 wanted;
  // Elevations are 5.7, 11.5, ... 45.8 deg.
  const auto after = [&](std::uint16_t mask, SimTime until) {
    configure(receiver, mask, wanted);
    line_.clear();
    run(receiver, until);
    return decoded<NavSol>().at(0);
  };
  wanted.minimum_elevation_deg = 20;
  EXPECT_EQ(after(2, kStart + 1500ms).satellites_used, 5);
  wanted.minimum_elevation_deg = 30;
  const NavSol three = after(2, kStart + 2500ms);
  EXPECT_EQ(three.satellites_used, 3);
  EXPECT_EQ(three.fix_type, 2);
  wanted.minimum_elevation_deg = 40;
  EXPECT_EQ(after(2, kStart + 3500ms).fix_type, 0);
  wanted.minimum_elevation_deg = 5;
  wanted.cn0_satellites = 4;
  wanted.cn0_threshold_dbhz = 41;
  EXPECT_EQ(after(0x102, kStart + 4500ms).fix_type, 0);
  wanted.cn0_threshold_dbhz = 40;
  EXPECT_EQ(after(0x100, kStart + 5500ms).fix_type, 3);
}

TEST_F(UbloxNavigatorTest, FixModes) {
  UbloxReceiver receiver(with({"NAV-SOL", "NAV-POSLLH"}), calendar_, line_);
  run(receiver, kStart + 500ms);
  CfgNav5 wanted;
  wanted.fix_mode = 1;
  wanted.fixed_altitude_cm = 12'345;
  configure(receiver, 4, wanted);
  line_.clear();
  run(receiver, kStart + 1500ms);
  EXPECT_EQ(decoded<NavSol>().at(0).fix_type, 2);
  EXPECT_EQ(decoded<NavPosllh>().at(0).mean_sea_level_height_mm, 123'450);
  wanted.fix_mode = 2;
  configure(receiver, 4, wanted);
  line_.clear();
  run(receiver, kStart + 2500ms, [](GnssSample& s) {
    s.fix = GnssFix::two_d;
    s.satellites.resize(3);
  });
  EXPECT_EQ(decoded<NavSol>().at(0).fix_type, 0);
}

TEST_F(UbloxNavigatorTest, DynamicModelBoundsTheFix) {
  UbloxReceiver receiver(with({"NAV-SOL"}), calendar_, line_);
  run(receiver, kStart + 500ms);
  CfgNav5 wanted;
  wanted.dynamic_model = 3;  // pedestrian: 30 m/s
  configure(receiver, 1, wanted);
  line_.clear();
  run(receiver, kStart + 1500ms, [](GnssSample& s) { s.velocity_ned_mps = {31.0, 0.0, 0.0}; });
  run(receiver, kStart + 2500ms);
  EXPECT_EQ(decoded<NavSol>().at(0).flags, 0xDC);
  EXPECT_EQ(decoded<NavSol>().at(1).flags, 0xDD);
}

TEST_F(UbloxNavigatorTest, CountsOfSatellitesAroundTheLimits) {
  UbloxReceiver receiver(with({"NAV-SOL"}), calendar_, line_);
  for (const int count : {0, 1, 2, 3, 4, 5}) {
    run(receiver, now_ + 1s, [&](GnssSample& s) {
      s.satellites.resize(static_cast<std::size_t>(count));
      s.fix = count >= 4   ? GnssFix::three_d
              : count == 3 ? GnssFix::two_d
              : count == 2 ? GnssFix::bad
                           : GnssFix::none;
    });
  }
  run(receiver, now_ + 900ms, [](GnssSample&) {});
  const auto sol = decoded<NavSol>();
  ASSERT_GE(sol.size(), 6U);
  const std::array<int, 6> fixes{0, 0, 0, 2, 3, 3};
  const std::array<int, 6> used{0, 0, 0, 3, 4, 5};
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    EXPECT_EQ(sol[i].fix_type, fixes[i]) << i;
    EXPECT_EQ(sol[i].satellites_used, used[i]) << i;
  }
}

TEST_F(UbloxNavigatorTest, PolesAndDateLine) {
  UbloxReceiver receiver(with({"NAV-PVT", "NAV-SOL"}), calendar_, line_);
  struct Place {
    double latitude_deg, longitude_deg, height_m;
  };
  const std::array<Place, 5> places{{{90.0, 0.0, 0.0},
                                     {-90.0, 12.0, 2800.0},
                                     {0.0, -180.0, -400.0},
                                     {0.0, 179.99999996, 9000.0},
                                     {45.0, -179.99999996, 0.0}}};
  for (const Place& place : places) {
    run(receiver, now_ + 1s, [&](GnssSample& s) {
      s.latitude_deg = place.latitude_deg;
      s.longitude_deg = place.longitude_deg;
      s.ellipsoid_height_m = place.height_m;
    });
  }
  run(receiver, now_ + 500ms);
  const auto pvt = decoded<NavPvt>();
  const auto sol = decoded<NavSol>();
  ASSERT_GE(pvt.size(), places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_NEAR(pvt[i].latitude_e7deg, places[i].latitude_deg * 1e7, 0.5);
    EXPECT_NEAR(pvt[i].longitude_e7deg, places[i].longitude_deg * 1e7, 0.5);
    EXPECT_LE(std::abs(pvt[i].longitude_e7deg), 1'800'000'000);
    const Geodetic back = geodetic_from_ecef(
        {sol[i].position_cm[0] * 0.01, sol[i].position_cm[1] * 0.01, sol[i].position_cm[2] * 0.01});
    EXPECT_NEAR(back.latitude_deg, places[i].latitude_deg, 1e-7);
    EXPECT_NEAR(back.ellipsoid_height_m, places[i].height_m, 0.02);
  }
  EXPECT_EQ(sol[0].position_cm[2], 635'675'231);  // semi-minor axis 6356752.314 m
}

TEST_F(UbloxNavigatorTest, CorrectionsOfSbasAreUsedWhenConfigured) {
  UbloxReceiver receiver(with({"NAV-STATUS", "NAV-PVT"}), calendar_, line_);
  const auto corrected = [](GnssSample& s) { s.differential = true; };
  run(receiver, kStart + 1500ms, corrected);
  EXPECT_EQ(decoded<NavStatus>().at(0).flags, 0xDF);
  EXPECT_EQ(decoded<NavStatus>().at(0).fix_status, 1);
  EXPECT_EQ(decoded<NavPvt>().at(0).flags, 3);
  say(receiver, CfgSbas{1, 1, 3, 0, 0});  // ranging only
  run(receiver, kStart + 2500ms, corrected);
  EXPECT_EQ(decoded<NavStatus>().at(1).flags, 0xDD);
}

TEST_F(UbloxNavigatorTest, AidingGivesTimeAndPositionBeforeTheFix) {
  UbloxSettings settings = with({});
  settings.time_to_first_fix = 30s;
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 500ms);
  Bytes aid(48);
  protocols::store_little(std::span<std::uint8_t>(aid), 0, std::int32_t{494'240'123});
  protocols::store_little(std::span<std::uint8_t>(aid), 4, std::int32_t{-77'510'456});
  protocols::store_little(std::span<std::uint8_t>(aid), 12, std::uint32_t{10'000});
  aid[44] = 0x23;
  say(receiver, {0x0B, 0x01}, aid);
  EXPECT_TRUE(receiver.solution().date_known);
  EXPECT_EQ(receiver.solution().week, 2421);
  EXPECT_NEAR(receiver.solution().latitude_deg, 49.4240123, 1e-9);
  line_.clear();
  say(receiver, {0x0B, 0x01}, {});
  run(receiver, now_ + 100ms);
  EXPECT_EQ(line_.frames().at(0).second.size(), 48U);
  EXPECT_EQ(line_.frames().at(0).second[44], 0x03);
}

}  // namespace
}  // namespace rigwire::emulators
