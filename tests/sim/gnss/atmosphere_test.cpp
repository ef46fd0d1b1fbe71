#include <gtest/gtest.h>

#include <cmath>

#include "fields/constants.h"
#include "sim/gnss/nominal_slots.h"
#include "sim/gnss/signal_path.h"

namespace rigwire::sim {
namespace {

TEST(KlobucharTest, GivesThePublishedWorkedExample) {
  // 40 N, 100 W, elevation 20, azimuth 210, time of week 593 100 s: 23.784 m on L1.
  const KlobucharParameters k{{3.82e-8, 1.49e-8, -1.79e-7, 0.0}, {1.43e5, 0.0, -3.28e5, 1.13e5}};
  EXPECT_NEAR(klobuchar_delay_m(k, 40.0 * kDegree, -100.0 * kDegree, 210.0 * kDegree,
                                20.0 * kDegree, 593'100.0),
              23.784, 5e-4);
}

TEST(KlobucharTest, NightIsFiveNanosecondsSlanted) {
  const KlobucharParameters k = nominal_ionosphere();
  // Local midnight at the zenith: 5 ns times 1 + 16 (0.53 - 0.5)^3.
  EXPECT_NEAR(klobuchar_delay_m(k, 0.8, 0.0, 0.0, 90.0 * kDegree, 0.0),
              5e-9 * kLightSpeed_mps * (1.0 + 16.0 * std::pow(0.03, 3.0)), 1e-9);
}

TEST(KlobucharTest, DayRepeatsAndIsHighestAtTwoInTheAfternoon) {
  const KlobucharParameters k = nominal_ionosphere();
  const auto zenith_m = [&](double t) {
    return klobuchar_delay_m(k, 0.3, 0.0, 0.0, 90.0 * kDegree, t);
  };
  EXPECT_NEAR(zenith_m(50'400.0), zenith_m(50'400.0 + 3.0 * 86'400.0), 1e-9);
  EXPECT_GT(zenith_m(50'400.0), zenith_m(43'200.0));
  EXPECT_GT(zenith_m(50'400.0), zenith_m(57'600.0));
  EXPECT_GT(zenith_m(50'400.0), 2.5);
  EXPECT_LT(zenith_m(50'400.0), 10.0);
}

TEST(KlobucharTest, IsFiniteAtPolesAndHorizon) {
  const KlobucharParameters k = nominal_ionosphere();
  for (const double latitude_deg : {-90.0, -89.0, 0.0, 90.0}) {
    for (const double longitude_deg : {-180.0, 0.0, 180.0}) {
      for (const double azimuth_deg : {0.0, 90.0, 180.0, 359.0}) {
        const double delay_m = klobuchar_delay_m(k, latitude_deg * kDegree, longitude_deg * kDegree,
                                                 azimuth_deg * kDegree, 1e-6, 345'678.0);
        EXPECT_GE(delay_m, 5e-9 * kLightSpeed_mps);
        EXPECT_LT(delay_m, 60.0);
      }
    }
  }
}

TEST(SaastamoinenTest, ZenithAtSeaLevelIsDryAndWetPart) {
  // Dry: 0.0022768 m/hPa at 1013.25 hPa and 45 degrees (Saastamoinen 1973); wet: 70 % of the
  // saturation pressure at 15 C, 17.0 hPa, with (1255 / T + 0.05).
  const double dry_m = 0.0022768 * 1013.25;
  const double wet_m = 0.002277 * (1255.0 / 288.16 + 0.05) * 0.7 * 17.05;
  EXPECT_NEAR(saastamoinen_delay_m(45.0 * kDegree, 0.0, 90.0 * kDegree), dry_m + wet_m, 2e-3);
}

TEST(SaastamoinenTest, FallsWithHeightAndGrowsTowardsTheHorizon) {
  const double zenith_m = saastamoinen_delay_m(0.8, 200.0, 90.0 * kDegree);
  EXPECT_NEAR(saastamoinen_delay_m(0.8, 200.0, 30.0 * kDegree), 2.0 * zenith_m, 1e-9);
  // At 5500 m half of the air is below; most of the vapour too.
  EXPECT_NEAR(saastamoinen_delay_m(0.8, 5'500.0, 90.0 * kDegree) / zenith_m, 0.49, 0.02);
  // Heavier air at the poles: 0.266 % from the mean either way, of the dry part.
  EXPECT_NEAR(saastamoinen_delay_m(90.0 * kDegree, 0.0, 90.0 * kDegree) -
                  saastamoinen_delay_m(0.0, 0.0, 90.0 * kDegree),
              -2.0 * 0.00266 * 2.307, 2e-4);
}

TEST(SaastamoinenTest, IsNothingWhereTheModelEnds) {
  EXPECT_EQ(saastamoinen_delay_m(0.8, 200.0, 0.0), 0.0);
  EXPECT_EQ(saastamoinen_delay_m(0.8, 200.0, -0.1), 0.0);
  EXPECT_EQ(saastamoinen_delay_m(0.8, -101.0, 1.0), 0.0);
  EXPECT_EQ(saastamoinen_delay_m(0.8, 10'001.0, 1.0), 0.0);
  EXPECT_EQ(saastamoinen_delay_m(0.8, -50.0, 1.0), saastamoinen_delay_m(0.8, 0.0, 1.0));
}

}  // namespace
}  // namespace rigwire::sim
