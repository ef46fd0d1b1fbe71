#include "field/local_plane.h"

#include <cmath>

#include "field/angle.h"

namespace rigwire::field {
namespace {

constexpr double kSemiMajor_m = 6378137.0;
constexpr double kFlattening = 1.0 / 298.257223563;
constexpr double kEccentricity2 = kFlattening * (2.0 - kFlattening);

}  // namespace

LocalPlane::LocalPlane(const LatLon& reference, double height_m)
    : reference_(reference), height_m_(height_m) {
  const double sine = std::sin(reference.latitude_deg * kDegree);
  const double w2 = 1.0 - kEccentricity2 * sine * sine;
  const double meridian_m = kSemiMajor_m * (1.0 - kEccentricity2) / (w2 * std::sqrt(w2));
  metres_per_degree_north_ = (meridian_m + height_m) * kDegree;
}

double LocalPlane::metres_per_degree_east(double latitude_deg) const {
  const double sine = std::sin(latitude_deg * kDegree);
  const double normal_m = kSemiMajor_m / std::sqrt(1.0 - kEccentricity2 * sine * sine);
  return (normal_m + height_m_) * std::cos(latitude_deg * kDegree) * kDegree;
}

PlanePosition LocalPlane::to_plane(const LatLon& point) const {
  return {
      (point.longitude_deg - reference_.longitude_deg) * metres_per_degree_east(point.latitude_deg),
      (point.latitude_deg - reference_.latitude_deg) * metres_per_degree_north_};
}

LatLon LocalPlane::to_geodetic(const PlanePosition& position) const {
  const double latitude_deg = reference_.latitude_deg + position.north_m / metres_per_degree_north_;
  return {latitude_deg,
          reference_.longitude_deg + position.east_m / metres_per_degree_east(latitude_deg)};
}

}  // namespace rigwire::field
