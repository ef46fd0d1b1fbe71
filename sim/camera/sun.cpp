#include "sim/camera/sun.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace rigwire::sim {
namespace {

constexpr double kRadian = std::numbers::pi / 180.0;

/// Julian day of a proleptic Gregorian date and time (Meeus, chapter 7).
double julian_day(const UtcTime& utc) {
  int year = utc.year;
  int month = utc.month;
  if (month <= 2) {
    --year;
    month += 12;
  }
  const int century = year / 100;
  const int leap_century = century / 4;
  const double day =
      utc.day +
      (utc.hour + (utc.minute + (utc.second + 1e-9 * utc.nanosecond) / 60.0) / 60.0) / 24.0;
  return std::floor(365.25 * (year + 4716)) + std::floor(30.6001 * (month + 1)) + day + 2 -
         century + leap_century - 1524.5;
}

/// NOAA's fit to refraction, in radians, by the geometric elevation.
double refraction(double elevation_rad) {
  const double h = elevation_rad / kRadian;
  const double tangent = std::tan(elevation_rad);
  double seconds = 0.0;
  if (h > 85.0) {
    return 0.0;
  }
  if (h > 5.0) {
    seconds = 58.1 / tangent - 0.07 / std::pow(tangent, 3) + 0.000086 / std::pow(tangent, 5);
  } else if (h > -0.575) {
    seconds = 1735.0 + h * (-518.2 + h * (103.4 + h * (-12.79 + h * 0.711)));
  } else {
    seconds = -20.774 / tangent;
  }
  return seconds / 3600.0 * kRadian;
}

}  // namespace

SunPosition sun_position(const UtcTime& utc, double latitude_deg, double longitude_deg) {
  if (!(std::abs(latitude_deg) <= 90.0) || !(std::abs(longitude_deg) <= 360.0)) {
    throw std::invalid_argument("sun: found latitude " + std::to_string(latitude_deg) +
                                " and longitude " + std::to_string(longitude_deg) +
                                " degrees, allowed -90 .. 90 and -360 .. 360");
  }
  // Centuries since 2000-01-01 12:00, then Meeus 25.2 to 25.8.
  const double t = (julian_day(utc) - 2451545.0) / 36525.0;
  const double mean_longitude = std::fmod(280.46646 + t * (36000.76983 + t * 0.0003032), 360.0);
  const double anomaly = (357.52911 + t * (35999.05029 - 0.0001537 * t)) * kRadian;
  const double eccentricity = 0.016708634 - t * (0.000042037 + 0.0000001267 * t);
  const double equation_of_centre = std::sin(anomaly) * (1.914602 - t * (0.004817 + 0.000014 * t)) +
                                    std::sin(2.0 * anomaly) * (0.019993 - 0.000101 * t) +
                                    std::sin(3.0 * anomaly) * 0.000289;
  const double true_anomaly = anomaly + equation_of_centre * kRadian;
  const double node = (125.04 - 1934.136 * t) * kRadian;
  const double apparent_longitude =
      (mean_longitude + equation_of_centre - 0.00569 - 0.00478 * std::sin(node)) * kRadian;
  const double mean_obliquity =
      23.0 + (26.0 + (21.448 - t * (46.815 + t * (0.00059 - t * 0.001813))) / 60.0) / 60.0;
  const double obliquity = (mean_obliquity + 0.00256 * std::cos(node)) * kRadian;

  SunPosition sun;
  sun.distance_au = 1.000001018 * (1.0 - eccentricity * eccentricity) /
                    (1.0 + eccentricity * std::cos(true_anomaly));
  sun.declination_rad = std::asin(std::sin(obliquity) * std::sin(apparent_longitude));
  // Equation of time: Meeus 28.3.
  const double y = std::pow(std::tan(0.5 * obliquity), 2);
  const double l = mean_longitude * kRadian;
  const double equation_rad = y * std::sin(2.0 * l) - 2.0 * eccentricity * std::sin(anomaly) +
                              4.0 * eccentricity * y * std::sin(anomaly) * std::cos(2.0 * l) -
                              0.5 * y * y * std::sin(4.0 * l) -
                              1.25 * eccentricity * eccentricity * std::sin(2.0 * anomaly);
  sun.equation_of_time_s = equation_rad / kRadian * 240.0;

  // Hour angle by true solar time; then the spherical triangle of zenith, pole and sun.
  const double seconds = utc.hour * 3600.0 + utc.minute * 60.0 + utc.second + 1e-9 * utc.nanosecond;
  const double solar_seconds = seconds + sun.equation_of_time_s + longitude_deg * 240.0;
  const double hour_angle = (solar_seconds / 240.0 - 180.0) * kRadian;
  const double latitude = latitude_deg * kRadian;
  const double east = -std::cos(sun.declination_rad) * std::sin(hour_angle);
  const double north = std::cos(latitude) * std::sin(sun.declination_rad) -
                       std::sin(latitude) * std::cos(sun.declination_rad) * std::cos(hour_angle);
  const double up = std::sin(latitude) * std::sin(sun.declination_rad) +
                    std::cos(latitude) * std::cos(sun.declination_rad) * std::cos(hour_angle);
  sun.geometric_elevation_rad = std::asin(std::clamp(up, -1.0, 1.0));
  sun.elevation_rad = sun.geometric_elevation_rad + refraction(sun.geometric_elevation_rad);
  sun.azimuth_rad = std::atan2(east, north);
  if (sun.azimuth_rad < 0.0) {
    sun.azimuth_rad += 2.0 * std::numbers::pi;
  }
  return sun;
}

Eigen::Vector3d sun_direction(const SunPosition& sun) {
  const double level = std::cos(sun.elevation_rad);
  return {level * std::sin(sun.azimuth_rad), level * std::cos(sun.azimuth_rad),
          std::sin(sun.elevation_rad)};
}

}  // namespace rigwire::sim
