#include "sim/local_frame.h"

#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

namespace rigwire::sim {
namespace {

void check(const char* name, double value, double lower, double upper) {
  if (!(value >= lower && value <= upper)) {
    throw std::invalid_argument(std::string(name) + " is " + std::to_string(value) +
                                ", allowed are " + std::to_string(lower) + " .. " +
                                std::to_string(upper));
  }
}

GeographicLib::LocalCartesian cartesian(const LocalFrameParameters& parameters) {
  return {parameters.latitude_deg, parameters.longitude_deg, parameters.ellipsoid_height_m};
}

/// Rows east, north, up.
Eigen::Matrix3d enu_from_ecef(double latitude_deg, double longitude_deg) {
  const double latitude = latitude_deg * std::numbers::pi / 180.0;
  const double longitude = longitude_deg * std::numbers::pi / 180.0;
  const double sin_lat = std::sin(latitude);
  const double cos_lat = std::cos(latitude);
  const double sin_lon = std::sin(longitude);
  const double cos_lon = std::cos(longitude);
  Eigen::Matrix3d rotation;
  rotation << -sin_lon, cos_lon, 0.0,                   //
      -sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat,  //
      cos_lat * cos_lon, cos_lat * sin_lon, sin_lat;
  return rotation;
}

}  // namespace

void validate(const LocalFrameParameters& parameters) {
  check("latitude, deg,", parameters.latitude_deg, -90.0, 90.0);
  check("longitude, deg,", parameters.longitude_deg, -180.0, 180.0);
  check("ellipsoid height, m,", parameters.ellipsoid_height_m, -1000.0, 20000.0);
  check("geoid separation, m,", parameters.geoid_separation_m, -120.0, 100.0);
}

LocalFrame::LocalFrame(const LocalFrameParameters& parameters,
                       std::shared_ptr<const GeoidGrid> geoid)
    : parameters_(parameters), geoid_(std::move(geoid)) {
  validate(parameters_);
  if (geoid_) {
    if (!geoid_->covers(parameters_.latitude_deg, parameters_.longitude_deg)) {
      throw std::invalid_argument("the geoid grid does not cover the origin, latitude " +
                                  std::to_string(parameters_.latitude_deg) + " deg, longitude " +
                                  std::to_string(parameters_.longitude_deg) +
                                  " deg; take a grid that does");
    }
    parameters_.geoid_separation_m =
        geoid_->separation_m(parameters_.latitude_deg, parameters_.longitude_deg);
  }
  world_from_ecef_ = enu_from_ecef(parameters_.latitude_deg, parameters_.longitude_deg);
}

GeodeticPoint LocalFrame::to_geodetic(const Eigen::Vector3d& p_W) const {
  GeodeticPoint point;
  cartesian(parameters_)
      .Reverse(p_W.x(), p_W.y(), p_W.z(), point.latitude_deg, point.longitude_deg,
               point.ellipsoid_height_m);
  if (point.longitude_deg >= 180.0) {
    point.longitude_deg -= 360.0;
  }
  return point;
}

Eigen::Vector3d LocalFrame::to_world(const GeodeticPoint& point) const {
  Eigen::Vector3d p_W;
  cartesian(parameters_)
      .Forward(point.latitude_deg, point.longitude_deg, point.ellipsoid_height_m, p_W.x(), p_W.y(),
               p_W.z());
  return p_W;
}

Eigen::Vector3d LocalFrame::to_ecef(const Eigen::Vector3d& p_W) const {
  const GeodeticPoint point = to_geodetic(p_W);
  Eigen::Vector3d p_E;
  GeographicLib::Geocentric::WGS84().Forward(point.latitude_deg, point.longitude_deg,
                                             point.ellipsoid_height_m, p_E.x(), p_E.y(), p_E.z());
  return p_E;
}

Eigen::Matrix3d LocalFrame::ned_from_world(const Eigen::Vector3d& p_W) const {
  const GeodeticPoint point = to_geodetic(p_W);
  // By way of earth-fixed axes; north, east, down exchanges the first two and turns up over.
  const Eigen::Matrix3d enu_from_world =
      enu_from_ecef(point.latitude_deg, point.longitude_deg) * world_from_ecef_.transpose();
  Eigen::Matrix3d ned_from_enu;
  ned_from_enu << 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0;
  return ned_from_enu * enu_from_world;
}

}  // namespace rigwire::sim
