#include "sim/gnss/nominal_slots.h"
#include "fields/constants.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "sim/gnss/ephemeris.h"

namespace rigwire::sim {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

GpsTime time_of(std::int64_t gps_s) {
  return {static_cast<std::int32_t>(gps_s / 604'800), gps_s % 604'800 * kSecond_ns};
}

constexpr std::int64_t interval_of(std::int32_t week, std::int64_t hour_of_week) {
  return std::int64_t{week} * 84 + hour_of_week / 2;
}

TEST(NominalSlotsTest, SetsAreWhatTheMessageCanHold) {
  for (const std::int64_t interval :
       {interval_of(0, 0), interval_of(703, 100), interval_of(1023, 166), interval_of(2421, 22),
        interval_of(2870, 4)}) {
    for (int prn = 1; prn <= 24; ++prn) {
      const GpsEphemeris set = nominal_gps_set(prn, interval);
      EXPECT_EQ(set, quantised(set));
      EXPECT_EQ(set.clock_time_s, set.ephemeris_time_s);
      EXPECT_EQ(set.issue_of_clock & 0xFF, set.issue_of_ephemeris);
      EXPECT_GE(set.eccentricity, 0.0019);
      EXPECT_LE(set.eccentricity, 0.0101);
      EXPECT_LT(std::abs(set.clock_bias_s), 2e-4);
      // Valid in the middle of its interval.
      EXPECT_EQ(std::int64_t{set.week} * 604'800 + std::llround(set.ephemeris_time_s),
                interval * 7'200 + 3'600);
    }
  }
}

TEST(NominalSlotsTest, ConsecutiveSetsMeet) {
  // Three weeks across the turns of the 10-bit week number, and the corners of the clocks' drift.
  for (const std::int32_t week : {1023, 2047, 2420}) {
    for (std::int64_t interval = interval_of(week, 160); interval < interval_of(week + 1, 8);
         ++interval) {
      const bool week_turns = (interval + 1) % 84 == 0;
      const GpsTime change = time_of((interval + 1) * 7'200);
      for (int prn = 1; prn <= 24; ++prn) {
        const SatelliteState a = satellite_state(nominal_gps_set(prn, interval), change);
        const SatelliteState b = satellite_state(nominal_gps_set(prn, interval + 1), change);
        EXPECT_LT((a.position_E_m - b.position_E_m).norm(), week_turns ? 0.0201 : 2e-6);
        EXPECT_LT((a.velocity_E_mps - b.velocity_E_mps).norm(), 1e-5);
        EXPECT_NEAR(a.clock_s, b.clock_s, 1e-17);
      }
    }
  }
  for (std::int64_t interval = interval_of(2400, 0); interval < interval_of(2427, 0); ++interval) {
    const GpsTime change = time_of((interval + 1) * 7'200);
    EXPECT_NEAR(satellite_state(nominal_gps_set(5, interval), change).clock_s,
                satellite_state(nominal_gps_set(5, interval + 1), change).clock_s, 1e-17);
  }
}

// Once all satellites had one Crs, one Cuc and one delta n. A real receiver's sets are all
// distinct, with delta n between 3.7e-9 and 5.1e-9 rad/s (recordings of a NEO-7P, RXM-SFRB).
TEST(NominalSlotsTest, EverySatelliteStatesItsOrbitInItsOwnFigures) {
  using Member = double GpsEphemeris::*;
  const auto distinct = [](Member member) {
    std::set<double> values;
    for (int prn = 1; prn <= 24; ++prn) {
      values.insert(nominal_gps_set(prn, interval_of(2421, 22)).*member);
    }
    return values.size();
  };
  for (const Member member :
       {&GpsEphemeris::radius_sine_m, &GpsEphemeris::radius_cosine_m,
        &GpsEphemeris::latitude_sine_rad, &GpsEphemeris::latitude_cosine_rad,
        &GpsEphemeris::mean_motion_difference, &GpsEphemeris::sqrt_semi_major_axis}) {
    EXPECT_EQ(distinct(member), 24U);
  }
  // These two span few steps of the message, so that two satellites may have the same value.
  EXPECT_GE(distinct(&GpsEphemeris::inclination_sine_rad), 20U);
  EXPECT_GE(distinct(&GpsEphemeris::inclination_cosine_rad), 20U);
  for (int prn = 1; prn <= 24; ++prn) {
    const GpsEphemeris set = nominal_gps_set(prn, interval_of(2421, 22));
    EXPECT_GT(set.mean_motion_difference, 3.7e-9);
    EXPECT_LT(set.mean_motion_difference, 5.1e-9);
    EXPECT_LT(std::abs(set.radius_sine_m), 116.0);
    EXPECT_NEAR(set.radius_cosine_m, 231.0, 101.0);
    EXPECT_LT(std::abs(set.latitude_cosine_rad), 6.1e-6);
    EXPECT_NEAR(set.latitude_sine_rad, 7.6e-6, 5.3e-6);
    EXPECT_LT(std::abs(set.inclination_cosine_rad), 1.7e-7);
    EXPECT_LT(std::abs(set.inclination_sine_rad), 1.5e-7);
  }
}

TEST(NominalSlotsTest, IssuesDifferForAsLongAsTheStandardAsks) {
  std::set<int> clock_issues;
  for (std::int64_t i = interval_of(2421, 0); i < interval_of(2421, 0) + 84; ++i) {
    const GpsEphemeris set = nominal_gps_set(9, i);
    EXPECT_TRUE(clock_issues.insert(set.issue_of_clock).second);
    EXPECT_LT(set.issue_of_clock, 1024);
    EXPECT_NE(set.issue_of_ephemeris, 0);
    for (int back = 1; back <= 3; ++back) {
      EXPECT_NE(set.issue_of_ephemeris, nominal_gps_set(9, i - back).issue_of_ephemeris);
    }
  }
}

TEST(NominalSlotsTest, SatellitesStandInTheirSlots) {
  // At the epoch: right ascension of the node and mean argument of latitude of the standard.
  const std::int64_t epoch_s = 703LL * 604'800 + 4 * 86'400 + 9;
  const std::array<double, 3> kArgument_deg{268.126, 135.226, 135.346};  // A1, D1, F4
  const std::array<double, 3> kNode_deg{272.847, 92.847, 212.847};
  const std::array<int, 3> kPrn{1, 13, 24};
  for (std::size_t i = 0; i < kPrn.size(); ++i) {
    const GpsEphemeris set = nominal_gps_set(kPrn[i], epoch_s / 7'200);
    const double since_toe_s = seconds_between(set.week, set.ephemeris_time_s, time_of(epoch_s));
    const double motion = std::sqrt(kEarthGravity_m3ps2) / std::pow(set.sqrt_semi_major_axis, 3.0) +
                          set.mean_motion_difference;
    const double argument =
        set.mean_anomaly_rad + set.argument_of_perigee_rad + motion * since_toe_s;
    EXPECT_NEAR(std::remainder(argument - kArgument_deg[i] * kDegree, 2.0 * std::numbers::pi), 0.0,
                2e-9);
    const double node = set.ascending_node_rad - kEarthRate_radps * set.ephemeris_time_s +
                        (set.ascending_node_rate - kEarthRate_radps) * since_toe_s +
                        (18.0 * 3600.0 + 36.0 * 60.0 + 14.4) * 15.0 / 3600.0 * kDegree;
    EXPECT_NEAR(std::remainder(node - kNode_deg[i] * kDegree, 2.0 * std::numbers::pi), 0.0, 2e-9);
  }
}

TEST(NominalSlotsTest, GroundTracksRepeatForYears) {
  // One ground track takes two orbits; the node comes round a little before the sidereal day.
  const double track_s = 2.0 * std::numbers::pi / (kEarthRate_radps + 8.000333245992e-9);
  for (const int days : {1, 365, 3'653}) {
    const GpsTime now = time_of(1'464'000'000);
    const double later_s = days * track_s;
    const GpsTime later = time_of(1'464'000'000 + static_cast<std::int64_t>(later_s));
    const double rest_s = later_s - std::floor(later_s);
    for (int prn = 1; prn <= 24; ++prn) {
      const Eigen::Vector3d p =
          satellite_state(nominal_gps_set(prn, broadcast_interval(now)), now).position_E_m;
      const Eigen::Vector3d q =
          satellite_state(nominal_gps_set(prn, broadcast_interval(later)), later, rest_s)
              .position_E_m;
      EXPECT_LT((p - q).norm() / 26.56e6, (0.001 + 1.2e-4 * days) * kDegree);
    }
  }
}

TEST(NominalSlotsTest, WalkerOrbitsAreCircularAndSmooth) {
  struct Expected {
    GnssSystem system;
    double axis_m;
    double inclination_deg;
  };
  for (const Expected& e : {Expected{GnssSystem::glonass, 25'508e3, 64.8},
                            Expected{GnssSystem::galileo, 29'600.318e3, 56.0},
                            Expected{GnssSystem::beidou, 27'906e3, 55.0}}) {
    const auto orbits = nominal_orbits(e.system);
    ASSERT_EQ(orbits.size(), 24U);
    for (const auto& orbit : orbits) {
      const GpsTime time{2421, 604'799LL * kSecond_ns};
      const SatelliteState state = nominal_state(orbit, time, 0.0);
      EXPECT_NEAR(state.position_E_m.norm(), e.axis_m, 1e-3);
      EXPECT_LE(std::abs(state.position_E_m.z()),
                e.axis_m * std::sin(e.inclination_deg * kDegree) + 1e-3);
      EXPECT_EQ(state.clock_s, 0.0);
      const SatelliteState next = nominal_state(orbit, {2422, 0}, 0.0);
      EXPECT_LT((nominal_state(orbit, time, 1.0).position_E_m - next.position_E_m).norm(), 2e-3);
    }
  }
}

TEST(NominalSlotsTest, StandingSatellitesStand) {
  for (const auto& orbit : nominal_orbits(GnssSystem::sbas)) {
    const GpsTime time{2421, 300'000LL * kSecond_ns};
    const SatelliteState state = nominal_state(orbit, time, 0.0);
    EXPECT_NEAR(state.position_E_m.z(), 0.0, 1e-6);
    EXPECT_NEAR(state.position_E_m.norm(), 42'164.2e3, 1e3);
    EXPECT_LT(state.velocity_E_mps.norm(), 1e-6);
    if (orbit.satellite.number == 123) {
      EXPECT_NEAR(std::atan2(state.position_E_m.y(), state.position_E_m.x()) / kDegree, 31.5, 1e-6);
    }
  }
}

TEST(NominalSlotsTest, QuasiZenithSatellitesDwellInTheNorth) {
  const auto orbits = nominal_orbits(GnssSystem::qzss);
  ASSERT_EQ(orbits.size(), 4U);
  for (std::int64_t t = 0; t < 86'400; t += 1'800) {
    double highest = -90.0;
    for (const auto& orbit : orbits) {
      const Eigen::Vector3d p = nominal_state(orbit, {2421, t * kSecond_ns}, 0.0).position_E_m;
      highest = std::max(highest, std::asin(p.z() / p.norm()) / kDegree);
      const double longitude_deg = std::atan2(p.y(), p.x()) / kDegree;
      EXPECT_NEAR(longitude_deg < 0.0 ? longitude_deg + 360.0 : longitude_deg, 135.0, 25.0);
    }
    EXPECT_GT(highest, 23.0);  // one of them always over Japan
  }
}

TEST(NominalSlotsTest, UtcFollowsTheTableOfLeapSeconds) {
  // 2024-06-01: 18 s since the end of 2016-12-31, the seventh day of week 1929.
  const GpsUtcParameters settled = nominal_utc(interval_of(2316, 144));
  EXPECT_EQ(settled.leap_seconds, 18);
  EXPECT_EQ(settled.leap_seconds_future, 18);
  EXPECT_EQ(settled.leap_week, 1929);
  EXPECT_EQ(settled.leap_day, 7);
  EXPECT_EQ(settled.reference_week, 2316);
  // 2016-12-25: announced. 2015-06-30 ended a Tuesday, the third day of week 1851.
  const GpsUtcParameters announced = nominal_utc(interval_of(1929, 0));
  EXPECT_EQ(announced.leap_seconds, 17);
  EXPECT_EQ(announced.leap_seconds_future, 18);
  EXPECT_EQ(announced.leap_week, 1929);
  EXPECT_EQ(announced.leap_day, 7);
  const GpsUtcParameters before = nominal_utc(interval_of(1880, 0));
  EXPECT_EQ(before.leap_week, 1851);
  EXPECT_EQ(before.leap_day, 3);
  // Before the first leap second.
  EXPECT_EQ(nominal_utc(interval_of(10, 0)).leap_seconds_future, 0);
}

}  // namespace
}  // namespace rigwire::sim
