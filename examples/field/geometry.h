// Angles, places and paths of field programs, in a plane: metres east and north, angles in rad,
// left positive from east; compass courses are clockwise from north.
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <vector>

namespace rigwire::field {

inline constexpr double kDegree = std::numbers::pi / 180.0;

/// Returns the angle within [-pi, pi].
[[nodiscard]] inline double wrapped(double angle_rad) {
  return std::remainder(angle_rad, 2.0 * std::numbers::pi);
}
/// Converts between compass and left from east, in either direction.
[[nodiscard]] inline double turned_compass(double angle_rad) {
  return wrapped(0.5 * std::numbers::pi - angle_rad);
}

struct LatLon {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
};

struct PlanePosition {
  double east_m = 0.0;
  double north_m = 0.0;
};

/// Latitude and longitude as metres east and north of a reference point: radii of curvature of the
/// WGS-84 ellipsoid at the reference, the parallel's at the point itself. Within 2 km the error
/// stays below 1 cm at heights up to 500 m.
class LocalPlane {
 public:
  /// `height_m` above the ellipsoid.
  explicit LocalPlane(const LatLon& reference, double height_m = 0.0);

  [[nodiscard]] PlanePosition to_plane(const LatLon& point) const;
  [[nodiscard]] LatLon to_geodetic(const PlanePosition& position) const;

 private:
  LatLon reference_;
  double height_m_;
  double metres_per_degree_north_;

  [[nodiscard]] double metres_per_degree_east(double latitude_deg) const;
};

/// A path as a chain of points in the plane: place along it, direction and curvature.
class Polyline {
 public:
  /// Throws std::invalid_argument with fewer than two points (three when closed), points that are
  /// not finite, or neighbours closer than 1 mm.
  Polyline(std::vector<PlanePosition> points, bool closed);

  struct Place {
    double along_m = 0.0;   ///< From the first point, 0 .. length.
    double offset_m = 0.0;  ///< Offset of the given position, left of the path positive.
  };
  /// The nearest place; with `near_m`, only within `window_m` along the path on both sides of it.
  [[nodiscard]] Place nearest(const PlanePosition& position,
                              std::optional<double> near_m = std::nullopt,
                              double window_m = 10.0) const;

  /// Beyond the ends of an open path the first and last piece go on straight.
  [[nodiscard]] PlanePosition at(double along_m) const;
  /// Direction, left from east, averaged over 2 m.
  [[nodiscard]] double direction_rad(double along_m) const;
  /// Returns the change of direction per way, left positive, over 4 m.
  [[nodiscard]] double curvature_1pm(double along_m) const;

  [[nodiscard]] double length_m() const { return length_m_; }
  [[nodiscard]] bool closed() const { return closed_; }
  /// Returns the place within 0 .. length on a closed path; unchanged on an open one.
  [[nodiscard]] double normalised(double along_m) const;

 private:
  [[nodiscard]] std::size_t pieces() const { return closed_ ? points_.size() : points_.size() - 1; }

  std::vector<PlanePosition> points_;
  std::vector<double> along_m_;  ///< Distance of each point along the path.
  bool closed_;
  double length_m_ = 0.0;
};

}  // namespace rigwire::field
