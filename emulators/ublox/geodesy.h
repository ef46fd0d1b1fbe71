// Between geodetic and earth-centred earth-fixed coordinates, WGS-84.
#pragma once

#include <array>

#include "emulators/ublox/solution.h"

namespace rigwire::emulators {

[[nodiscard]] std::array<double, 3> ecef_position(const UbloxSolution& solution);
[[nodiscard]] std::array<double, 3> ecef_velocity(const UbloxSolution& solution);

/// An earth-fixed vector in north, east, down at the solution's place.
[[nodiscard]] std::array<double, 3> ned_from_ecef(const UbloxSolution& solution,
                                                  const std::array<double, 3>& vector_E);

struct Geodetic {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double ellipsoid_height_m = 0.0;
};

/// Bowring's formula once: below 1e-9 deg and 0.1 mm for heights of -10 .. 100 km. The centre of
/// the earth gives the north pole.
[[nodiscard]] Geodetic geodetic_from_ecef(const std::array<double, 3>& position_m);

}  // namespace rigwire::emulators
