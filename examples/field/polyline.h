// A path as a chain of points in the plane: place along it, direction and curvature.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "field/local_plane.h"

namespace rigwire::field {

class Polyline {
 public:
  /// Throws std::invalid_argument with fewer than two points (three when closed), points that are
  /// not finite, or neighbours closer than 1 mm.
  Polyline(std::vector<PlanePosition> points, bool closed);

  struct Place {
    double along_m = 0.0;   ///< From the first point, 0 .. length.
    double offset_m = 0.0;  ///< Of the asked position, left of the path positive.
  };
  /// The nearest place; with `near_m`, only within `window_m` along the path on both sides of it.
  [[nodiscard]] Place nearest(const PlanePosition& position,
                              std::optional<double> near_m = std::nullopt,
                              double window_m = 10.0) const;

  /// Beyond the ends of an open path the first and last piece go on straight.
  [[nodiscard]] PlanePosition at(double along_m) const;
  /// Direction, left from east, averaged over 2 m.
  [[nodiscard]] double direction_rad(double along_m) const;
  /// Change of direction by way, left positive, over 4 m.
  [[nodiscard]] double curvature_1pm(double along_m) const;

  [[nodiscard]] double length_m() const { return length_m_; }
  [[nodiscard]] bool closed() const { return closed_; }
  /// Within 0 .. length on a closed path; unchanged on an open one.
  [[nodiscard]] double normalised(double along_m) const;

 private:
  [[nodiscard]] std::size_t pieces() const { return closed_ ? points_.size() : points_.size() - 1; }

  std::vector<PlanePosition> points_;
  std::vector<double> along_m_;  ///< Of each point.
  bool closed_;
  double length_m_ = 0.0;
};

}  // namespace rigwire::field
