// The world frame W on the earth: east-north-up in the tangent plane of the WGS-84 ellipsoid at the
// scene's map origin.
//
// Method: GeographicLib::LocalCartesian (C. Karney), exact to rounding: under 1e-8 m within 1000 km
// of the origin. The geoid is one constant separation over the whole scene, or looked up in a grid
// at every point (sim/geoid.h).
#pragma once

#include <Eigen/Core>
#include <memory>

#include "sim/geoid.h"

namespace rigwire::sim {

struct LocalFrameParameters {
  double latitude_deg = 49.4240;      ///< WGS-84 geodetic, [-90, 90].
  double longitude_deg = 7.7510;      ///< [-180, 180].
  double ellipsoid_height_m = 280.0;  ///< Above the ellipsoid, [-1000, 20000].
  double geoid_separation_m = 48.0;   ///< Geoid above the ellipsoid, [-120, 100]; without a grid.
};

/// Throws std::invalid_argument naming the parameter, its value and what is allowed.
void validate(const LocalFrameParameters& parameters);

struct GeodeticPoint {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;  ///< [-180, 180).
  double ellipsoid_height_m = 0.0;
};

class LocalFrame {
 public:
  /// Throws as validate(). With a `geoid` the separation comes from it, and it must cover the
  /// origin; otherwise this throws std::invalid_argument.
  explicit LocalFrame(const LocalFrameParameters& parameters,
                      std::shared_ptr<const GeoidGrid> geoid = nullptr);

  /// `p_W` in metres, east-north-up from the origin.
  [[nodiscard]] GeodeticPoint to_geodetic(const Eigen::Vector3d& p_W) const;
  [[nodiscard]] Eigen::Vector3d to_world(const GeodeticPoint& point) const;
  /// Earth-centred earth-fixed, m.
  [[nodiscard]] Eigen::Vector3d to_ecef(const Eigen::Vector3d& p_W) const;

  /// Rotation that turns components in W into north-east-down at the point itself (not at the
  /// origin: the plumb line turns by 1 arc minute per nautical mile).
  [[nodiscard]] Eigen::Matrix3d ned_from_world(const Eigen::Vector3d& p_W) const;
  /// Rotation that turns earth-centred earth-fixed components into W.
  [[nodiscard]] const Eigen::Matrix3d& world_from_ecef() const { return world_from_ecef_; }

  /// At the origin.
  [[nodiscard]] double geoid_separation_m() const { return parameters_.geoid_separation_m; }
  [[nodiscard]] double geoid_separation_m(double latitude_deg, double longitude_deg) const {
    return geoid_ ? geoid_->separation_m(latitude_deg, longitude_deg)
                  : parameters_.geoid_separation_m;
  }
  [[nodiscard]] const LocalFrameParameters& parameters() const { return parameters_; }

 private:
  LocalFrameParameters parameters_;
  Eigen::Matrix3d world_from_ecef_;
  std::shared_ptr<const GeoidGrid> geoid_;
};

}  // namespace rigwire::sim
