// Positions of NAV-HPPOSLLH, NAV-HPPOSECEF and NAV-RELPOSNED: a coarse number and a rest of the
// same sign, value = coarse + rest.
//
// Source: ZED-F9P interface description HPG 1.50, UBXDOC-963802114-12815, sections 3.15
// "UBX-NAV-HPPOSLLH" and "UBX-NAV-HPPOSECEF". Splitting a value and joining it again is within half
// a unit of the rest (and the rounding of doubles, 1e-14 of the value).
#pragma once

#include <cstdint>

namespace rigwire::protocols::ubx {

/// Angle: units of 1e-7 and 1e-9 degrees.
struct SplitAngle {
  std::int32_t e7deg = 0;
  std::int8_t rest_e9deg = 0;  ///< -99..99

  friend bool operator==(const SplitAngle&, const SplitAngle&) = default;
};

/// Height: millimetres and tenths of them.
struct SplitHeight {
  std::int32_t mm = 0;
  std::int8_t rest_e4m = 0;  ///< -9..9

  friend bool operator==(const SplitHeight&, const SplitHeight&) = default;
};

/// Coordinate: centimetres and tenths of millimetres.
struct SplitCoordinate {
  std::int32_t cm = 0;
  std::int8_t rest_e4m = 0;  ///< -99..99

  friend bool operator==(const SplitCoordinate&, const SplitCoordinate&) = default;
};

/// Angles of -180..180 degrees; heights and coordinates that 32 bits hold (2147 km, 21474 km).
[[nodiscard]] SplitAngle split_angle(double angle_deg);
[[nodiscard]] SplitHeight split_height(double height_m);
[[nodiscard]] SplitCoordinate split_coordinate(double coordinate_m);

[[nodiscard]] double join(const SplitAngle& angle);            ///< Degrees.
[[nodiscard]] double join(const SplitHeight& height);          ///< Metres.
[[nodiscard]] double join(const SplitCoordinate& coordinate);  ///< Metres.

}  // namespace rigwire::protocols::ubx
