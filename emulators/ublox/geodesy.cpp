#include "emulators/ublox/geodesy.h"

#include <cmath>

#include "fields/constants.h"

namespace rigwire::emulators {
namespace {

constexpr double kSemiMajorAxis_m = 6'378'137.0;
constexpr double kFlattening = 1.0 / 298.257223563;
constexpr double kEccentricity2 = kFlattening * (2.0 - kFlattening);

}  // namespace

std::array<double, 3> ecef_position(const UbloxSolution& s) {
  const double sin_lat = std::sin(s.latitude_deg * kDegree);
  const double cos_lat = std::cos(s.latitude_deg * kDegree);
  const double sin_lon = std::sin(s.longitude_deg * kDegree);
  const double cos_lon = std::cos(s.longitude_deg * kDegree);
  // WGS-84 ellipsoid: N = a / sqrt(1 - e^2 sin^2), z with N (1 - e^2).
  const double normal_m = kSemiMajorAxis_m / std::sqrt(1.0 - kEccentricity2 * sin_lat * sin_lat);
  const double h = s.ellipsoid_height_m;
  return {(normal_m + h) * cos_lat * cos_lon, (normal_m + h) * cos_lat * sin_lon,
          (normal_m * (1.0 - kEccentricity2) + h) * sin_lat};
}

std::array<double, 3> ecef_velocity(const UbloxSolution& s) {
  const double sin_lat = std::sin(s.latitude_deg * kDegree);
  const double cos_lat = std::cos(s.latitude_deg * kDegree);
  const double sin_lon = std::sin(s.longitude_deg * kDegree);
  const double cos_lon = std::cos(s.longitude_deg * kDegree);
  const Vector3& v = s.velocity_ned_mps;
  // North, east, down turned into earth-fixed axes.
  return {-sin_lat * cos_lon * v.x - sin_lon * v.y - cos_lat * cos_lon * v.z,
          -sin_lat * sin_lon * v.x + cos_lon * v.y - cos_lat * sin_lon * v.z,
          cos_lat * v.x - sin_lat * v.z};
}

std::array<double, 3> ned_from_ecef(const UbloxSolution& s, const std::array<double, 3>& e) {
  const double sin_lat = std::sin(s.latitude_deg * kDegree);
  const double cos_lat = std::cos(s.latitude_deg * kDegree);
  const double sin_lon = std::sin(s.longitude_deg * kDegree);
  const double cos_lon = std::cos(s.longitude_deg * kDegree);
  // The transpose of ecef_velocity()'s turn.
  return {-sin_lat * cos_lon * e[0] - sin_lat * sin_lon * e[1] + cos_lat * e[2],
          -sin_lon * e[0] + cos_lon * e[1],
          -cos_lat * cos_lon * e[0] - cos_lat * sin_lon * e[1] - sin_lat * e[2]};
}

Geodetic geodetic_from_ecef(const std::array<double, 3>& p) {
  const double axis_m = std::hypot(p[0], p[1]);
  const double semi_minor_m = kSemiMajorAxis_m * (1.0 - kFlattening);
  const double second_eccentricity2 = kEccentricity2 / (1.0 - kEccentricity2);
  // Bowring's formula: parametric latitude first, then tan(lat) from it.
  const double theta = std::atan2(p[2] * kSemiMajorAxis_m, axis_m * semi_minor_m);
  const double latitude =
      std::atan2(p[2] + second_eccentricity2 * semi_minor_m * std::pow(std::sin(theta), 3),
                 axis_m - kEccentricity2 * kSemiMajorAxis_m * std::pow(std::cos(theta), 3));
  const double sin_lat = std::sin(latitude);
  const double w = std::sqrt(1.0 - kEccentricity2 * sin_lat * sin_lat);
  // Good at the equator and at the poles alike.
  const double height_m = axis_m * std::cos(latitude) + p[2] * sin_lat - kSemiMajorAxis_m * w;
  return {latitude / kDegree, std::atan2(p[1], p[0]) / kDegree, height_m};
}

}  // namespace rigwire::emulators
