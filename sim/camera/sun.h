// Position of the sun, by place, date and time.
//
// Method: the equations of NOAA's solar calculator, after J. Meeus, "Astronomical Algorithms", 2nd
// ed. 1998, chapters 25 (low accuracy) and 28, with NOAA's refraction for 1013 hPa and 10 degrees
// Celsius. UTC is taken for UT1 (at most 0.9 s, 0.004 degrees) and for dynamical time (a minute of
// the sun's way on the ecliptic, 0.0008 degrees). Error against NREL's SPA below 0.01 degrees for
// 1980 .. 2099 above 5 degrees of elevation; nearer the horizon refraction is uncertain by tenths.
#pragma once

#include <Eigen/Core>

#include "sim/samples/calendar.h"

namespace rigwire::sim {

struct SunPosition {
  double azimuth_rad = 0.0;    ///< Clockwise from north, 0 .. 2 pi.
  double elevation_rad = 0.0;  ///< Apparent, refraction included.
  double geometric_elevation_rad = 0.0;
  double declination_rad = 0.0;
  double equation_of_time_s = 0.0;  ///< Apparent less mean solar time.
  double distance_au = 1.0;
};

/// Latitude north and longitude east positive. Throws std::invalid_argument unless both are finite,
/// latitude within 90 and longitude within 360 degrees.
[[nodiscard]] SunPosition sun_position(const UtcTime& utc, double latitude_deg,
                                       double longitude_deg);

/// Unit vector towards the sun, east-north-up at that place.
[[nodiscard]] Eigen::Vector3d sun_direction(const SunPosition& sun);

}  // namespace rigwire::sim
