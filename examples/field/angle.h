// Angles of field programs: rad, left positive from east; compass courses are clockwise from north.
#pragma once

#include <cmath>
#include <numbers>

namespace rigwire::field {

inline constexpr double kDegree = std::numbers::pi / 180.0;

/// The same angle within [-pi, pi].
[[nodiscard]] inline double wrapped(double angle_rad) {
  return std::remainder(angle_rad, 2.0 * std::numbers::pi);
}
/// Between compass and left from east, either way.
[[nodiscard]] inline double turned_compass(double angle_rad) {
  return wrapped(0.5 * std::numbers::pi - angle_rad);
}

}  // namespace rigwire::field
