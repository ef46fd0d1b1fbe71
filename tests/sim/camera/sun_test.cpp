#include "sim/camera/sun.h"
#include "fields/constants.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace rigwire::sim {
namespace {

// I. Reda, A. Andreas, "Solar position algorithm for solar radiation applications", NREL/TP-560-
// 34302, 2008, table A5.1: Golden, 2003-10-17 12:30:30 at UTC - 7 h.
TEST(SunPosition, AgreesWithNrelsExample) {
  const SunPosition sun =
      sun_position({.year = 2003, .month = 10, .day = 17, .hour = 19, .minute = 30, .second = 30},
                   39.742476, -105.1786);
  EXPECT_NEAR(90.0 - sun.elevation_rad / kDegree, 50.11162, 0.01);
  EXPECT_NEAR(sun.azimuth_rad / kDegree, 194.34024, 0.01);
}

// Meeus, "Astronomical Algorithms", example 25.a: 1992-10-13 0h TD, apparent declination.
TEST(SunPosition, HasMeeussDeclination) {
  const SunPosition sun = sun_position({.year = 1992, .month = 10, .day = 13}, 0.0, 0.0);
  EXPECT_NEAR(sun.declination_rad / kDegree, -7.78507, 0.001);
  EXPECT_NEAR(sun.distance_au, 0.99766, 1e-5);
  // Example 28.a, 28.b: equation of time 13 m 42.7 s, by the smaller formula 13 m 43 s.
  EXPECT_NEAR(sun.equation_of_time_s, 822.6, 1.5);
}

// Astronomical Almanac 2024: equinox 20 March 03:06 UTC, solstice 20 June 20:51 UTC, when the
// declination is the true obliquity: 23.43929 degrees less 0.01300 a century since 2000, and 9.2
// seconds of arc of nutation.
TEST(SunPosition, TurnsAtTheSeasons) {
  const SunPosition equinox =
      sun_position({.year = 2024, .month = 3, .day = 20, .hour = 3, .minute = 6}, 0.0, 0.0);
  EXPECT_NEAR(equinox.declination_rad / kDegree, 0.0, 0.003);
  const SunPosition solstice =
      sun_position({.year = 2024, .month = 6, .day = 20, .hour = 20, .minute = 51}, 0.0, 0.0);
  EXPECT_NEAR(solstice.declination_rad / kDegree, 23.4386, 0.001);
}

TEST(SunPosition, LiesInTheSouthAtTrueNoonAndMovesWest) {
  // Kaiserslautern, 7.75 degrees east: true noon at 11:29 UTC less the equation of time.
  const UtcTime noon{.year = 2026, .month = 6, .day = 1, .hour = 11, .minute = 26, .second = 50};
  const SunPosition sun = sun_position(noon, 49.42, 7.75);
  EXPECT_NEAR(sun.azimuth_rad / kDegree, 180.0, 0.2);
  EXPECT_NEAR(sun.elevation_rad / kDegree, 90.0 - 49.42 + 22.1, 0.2);
  const Eigen::Vector3d direction = sun_direction(sun);
  EXPECT_NEAR(direction.norm(), 1.0, 1e-12);
  EXPECT_LT(direction.y(), 0.0);
  UtcTime later = noon;
  later.hour = 15;
  EXPECT_LT(sun_direction(sun_position(later, 49.42, 7.75)).x(), -0.5);
}

TEST(SunPosition, RefractionLiftsItAtTheHorizon) {
  // 34 minutes of arc at the horizon; nothing much at the zenith.
  for (int minute = 0; minute < 60; ++minute) {
    const SunPosition sun =
        sun_position({.year = 2026, .month = 3, .day = 20, .hour = 6, .minute = minute}, 0.0, 0.0);
    if (std::abs(sun.geometric_elevation_rad) < 0.3 * kDegree) {
      EXPECT_NEAR((sun.elevation_rad - sun.geometric_elevation_rad) / kDegree, 0.5, 0.12);
      return;
    }
  }
  FAIL() << "the sun did not rise";
}

TEST(SunPosition, RefusesPlacesThatDoNotExist) {
  const UtcTime time{};
  EXPECT_THROW((void)sun_position(time, 90.1, 0.0), std::invalid_argument);
  EXPECT_THROW((void)sun_position(time, std::numeric_limits<double>::quiet_NaN(), 0.0),
               std::invalid_argument);
  EXPECT_THROW((void)sun_position(time, 0.0, std::numeric_limits<double>::infinity()),
               std::invalid_argument);
  EXPECT_TRUE(sun_direction(sun_position(time, 90.0, 0.0)).allFinite());
}

}  // namespace
}  // namespace rigwire::sim
