#include "protocols/gps/broadcast.h"

#include <gtest/gtest.h>

#include <cmath>

#include "protocols/gps/bits.h"

namespace rigwire::protocols::gps {
namespace {

Ephemeris orbit(std::uint8_t prn) {
  return quantised({.prn = prn,
                    .week = 2297,
                    .issue_of_clock = 77,
                    .issue_of_ephemeris = 77,
                    .group_delay_s = -5e-9,
                    .clock_time_s = 295'200.0,
                    .clock_bias_s = 1.2e-4,
                    .clock_drift = -3e-12,
                    .ephemeris_time_s = 295'200.0,
                    .sqrt_semi_major_axis = 5153.65,
                    .eccentricity = 0.011,
                    .mean_anomaly_rad = 0.3 * prn - 3.0,
                    .mean_motion_difference = 4.5e-9,
                    .ascending_node_rad = 1.0,
                    .inclination_rad = 0.96,
                    .argument_of_perigee_rad = -0.7,
                    .ascending_node_rate = -8.1e-9,
                    .inclination_rate = 2e-10});
}

Broadcast example() {
  Broadcast broadcast;
  for (std::uint8_t prn : {std::uint8_t{1}, std::uint8_t{24}, std::uint8_t{25}, std::uint8_t{32}}) {
    broadcast.ephemerides[prn - 1U] = orbit(prn);
  }
  broadcast.ephemerides[24]->health = 1;
  broadcast.ionosphere_utc = {.alpha = {127 * std::ldexp(1.0, -30), -128 * std::ldexp(1.0, -27),
                                        std::ldexp(1.0, -24), -std::ldexp(1.0, -24)},
                              .beta = {-128 * 2048.0, 127 * 16384.0, -65536.0, 65536.0},
                              .utc_a0_s = -std::ldexp(1.0, 1),
                              .utc_a1 = (std::ldexp(1.0, 23) - 1.0) * std::ldexp(1.0, -50),
                              .utc_reference_time_s = 147 * 4096.0,
                              .utc_reference_week = 2297,
                              .leap_seconds = 127,
                              .leap_week = 2185,
                              .leap_day = 7,
                              .leap_seconds_future = -128};
  derive_almanac(broadcast);
  return broadcast;
}

SubframeData sent(const Broadcast& broadcast, std::uint8_t subframe, std::uint8_t page,
                  std::uint8_t prn = 1) {
  const std::uint32_t step = (page - 1U) * 5U + subframe - 1U;
  const auto data = decode_subframe(subframe_at(broadcast, prn, {2297, step}));
  EXPECT_TRUE(data.ok());
  return *data;
}

TEST(GpsSchedule, FiveSubframesTwentyFivePagesFromTheStartOfTheWeek) {
  EXPECT_EQ(scheduled(0), (ScheduledSubframe{1, 1}));
  EXPECT_EQ(scheduled(4), (ScheduledSubframe{5, 1}));
  EXPECT_EQ(scheduled(5), (ScheduledSubframe{1, 2}));
  EXPECT_EQ(scheduled(124), (ScheduledSubframe{5, 25}));
  EXPECT_EQ(scheduled(125), (ScheduledSubframe{1, 1})) << "after 12.5 minutes";
  // 806.4 cycles make a week: the last is cut, and the next week begins with page 1.
  EXPECT_EQ(scheduled(kStepsPerWeek - 1), (ScheduledSubframe{5, 10}));
}

TEST(GpsSchedule, HandOverWordTellsTheStartOfTheNextSubframe) {
  const Broadcast broadcast = example();
  for (const std::uint32_t step : {0U, 1U, 49'999U, kStepsPerWeek - 1U}) {
    const auto data = decode_subframe(subframe_at(broadcast, 1, {2297, step}));
    ASSERT_TRUE(data.ok());
    const auto found = head(*data);
    ASSERT_TRUE(found.ok());
    EXPECT_EQ(found->next_step, (step + 1U) % kStepsPerWeek);
    EXPECT_EQ(found->subframe_id, scheduled(step).subframe_id);
  }
}

TEST(GpsBroadcast, EphemerisComesBackFromTheAir) {
  const Broadcast broadcast = example();
  const auto back = decode_ephemeris(sent(broadcast, 1, 3, 32), sent(broadcast, 2, 3, 32),
                                     sent(broadcast, 3, 3, 32), 32, 2300);
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(*back, *broadcast.ephemerides[31]);
}

TEST(GpsBroadcast, PageIdsAreThoseOfTable20V) {
  const Broadcast broadcast = example();
  constexpr std::array<int, 25> kDocument{57, 25, 26, 27, 28, 57, 29, 30, 31, 32, 57, 62, 52,
                                          53, 54, 57, 55, 56, 58, 59, 57, 60, 61, 62, 63};
  for (std::uint8_t page = 1; page <= 25; ++page) {
    int expected = kDocument[page - 1U];
    if (expected <= 32 && !broadcast.almanacs[static_cast<std::size_t>(expected - 1)]) {
      expected = 0;  // A satellite that is not there.
    }
    EXPECT_EQ(page_id(sent(broadcast, 4, page)), expected) << int{page};
    const bool known = page == 25 || broadcast.almanacs[page - 1U].has_value();
    EXPECT_EQ(page_id(sent(broadcast, 5, page)), page == 25 ? 51 : known ? page : 0);
  }
}

TEST(GpsBroadcast, IonosphereAndUtcComeBackAtTheirLimits) {
  const Broadcast broadcast = example();
  const auto back = decode_ionosphere_utc(sent(broadcast, 4, 18), 2300);
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(*back, broadcast.ionosphere_utc);
  EXPECT_TRUE(decode_ionosphere_utc(sent(broadcast, 4, 17), 2300).malformed());
}

TEST(GpsBroadcast, AlmanacComesBackFromItsPage) {
  const Broadcast broadcast = example();
  const auto in_subframe_5 = decode_almanac(sent(broadcast, 5, 24), 2297);
  ASSERT_TRUE(in_subframe_5.ok());
  EXPECT_EQ(*in_subframe_5, *broadcast.almanacs[23]);
  const auto in_subframe_4 = decode_almanac(sent(broadcast, 4, 10), 2297);
  ASSERT_TRUE(in_subframe_4.ok());
  EXPECT_EQ(*in_subframe_4, *broadcast.almanacs[31]);
  EXPECT_TRUE(decode_almanac(sent(broadcast, 5, 2), 2297).malformed()) << "a dummy";
}

TEST(GpsBroadcast, HealthPagesTellAllSatellites) {
  const Broadcast broadcast = example();
  const auto back = decode_health(sent(broadcast, 5, 25), sent(broadcast, 4, 25), 2300);
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(*back, broadcast.health);
  EXPECT_EQ(back->health[0], 0);
  EXPECT_EQ(back->health[1], 0x3F);
  EXPECT_EQ(back->health[24], 1);
  EXPECT_EQ(back->configuration[31], 0b1001);
}

TEST(GpsAlmanac, EveryFieldComesBackAtItsLimits) {
  const double semi = kSemicircle_rad;
  const Almanac low{.prn = 1,
                    .week = 2297,
                    .health = 0,
                    .almanac_time_s = 0.0,
                    .clock_bias_s = -std::ldexp(1.0, -10),
                    .clock_drift = -std::ldexp(1.0, -28),
                    .mean_anomaly_rad = -semi,
                    .ascending_node_rad = -semi,
                    .inclination_rad = 0.30 * semi - std::ldexp(semi, -4),
                    .argument_of_perigee_rad = -semi,
                    .ascending_node_rate = -std::ldexp(semi, -23)};
  const Almanac high{.prn = 32,
                     .week = 2297,
                     .health = 255,
                     .almanac_time_s = 147 * 4096.0,
                     .clock_bias_s = 1023 * std::ldexp(1.0, -20),
                     .clock_drift = 1023 * std::ldexp(1.0, -38),
                     .sqrt_semi_major_axis = 0xFFFFFF * std::ldexp(1.0, -11),
                     .eccentricity = 0xFFFF * std::ldexp(1.0, -21),
                     .mean_anomaly_rad = 0x7FFFFF * std::ldexp(semi, -23),
                     .ascending_node_rad = 0x7FFFFF * std::ldexp(semi, -23),
                     .inclination_rad = 0.30 * semi + 0x7FFF * std::ldexp(semi, -19),
                     .argument_of_perigee_rad = 0x7FFFFF * std::ldexp(semi, -23),
                     .ascending_node_rate = 0x7FFF * std::ldexp(semi, -38)};
  for (const Almanac& almanac : {low, high}) {
    EXPECT_EQ(quantised(almanac), almanac);
  }
}

// Right ascension minus sidereal rotation, and mean anomaly, must agree between the ephemeris and
// the almanac that was made from it, at any time.
TEST(GpsAlmanac, ReducedOrbitFollowsTheEphemeris) {
  const Ephemeris ephemeris = orbit(1);
  const double earth_rate = 7.2921151467e-5;
  for (const auto& [week, toa] : {std::pair{2297, 294'912.0}, {2297, 0.0}, {2298, 4096.0}}) {
    const Almanac almanac = reduced(ephemeris, week, toa);
    // Node longitude at the almanac's own time: by the almanac, and by the ephemeris.
    const double after_toe = (week - 2297) * 604'800.0 + toa - 295'200.0;
    const double by_almanac = almanac.ascending_node_rad - earth_rate * toa;
    const double by_ephemeris = ephemeris.ascending_node_rad +
                                (ephemeris.ascending_node_rate - earth_rate) * after_toe -
                                earth_rate * 295'200.0;
    EXPECT_NEAR(std::remainder(by_almanac - by_ephemeris, 2 * kSemicircle_rad), 0.0, 2e-7);
    const double motion =
        std::sqrt(3.986005e14 / std::pow(ephemeris.sqrt_semi_major_axis, 6)) + 4.5e-9;
    EXPECT_NEAR(
        std::remainder(almanac.mean_anomaly_rad - ephemeris.mean_anomaly_rad - motion * after_toe,
                       2 * kSemicircle_rad),
        0.0, 1e-5);
    // An almanac has no delta n: its axis alone must say the whole motion.
    EXPECT_NEAR(std::sqrt(3.986005e14) / std::pow(almanac.sqrt_semi_major_axis, 3), motion, 3e-11);
    EXPECT_NEAR(almanac.inclination_rad, 0.96 + 2e-10 * after_toe, 4e-6);
    EXPECT_NEAR(almanac.clock_bias_s, 1.2e-4 - 3e-12 * after_toe, 5e-7);
  }
}

TEST(GpsAlmanac, ExtendedAndReducedAgainIsTheSame) {
  const Almanac almanac = reduced(orbit(1), 2297, 294'912.0);
  EXPECT_EQ(reduced(quantised(extended(almanac)), 2297, 294'912.0), almanac);
}

TEST(GpsAlmanac, TimeIsTheNoonOfTheEarliestEphemeris) {
  const Broadcast broadcast = example();
  // Day 3 begins at 259 200 s; its noon, 302 400 s, lies nearest to 74 x 4096 s.
  EXPECT_EQ(broadcast.health.almanac_time_s, 74 * 4096.0);
  EXPECT_EQ(broadcast.almanacs[0]->almanac_time_s, 74 * 4096.0);
}

}  // namespace
}  // namespace rigwire::protocols::gps
