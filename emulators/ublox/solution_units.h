// From SI to the integers of UBX fields, and from geodetic to earth-centred coordinates (WGS-84).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "emulators/ublox/solution.h"
#include "protocols/ubx/navigation_values.h"

namespace rigwire::emulators {

/// Rounded and clamped to the field; not-a-number becomes zero.
template <class Integer>
[[nodiscard]] Integer to_field(double value, double unit) {
  const double scaled = std::round(value / unit);
  if (std::isnan(scaled)) {
    return 0;
  }
  constexpr double kLeast = static_cast<double>(std::numeric_limits<Integer>::min());
  constexpr double kGreatest = static_cast<double>(std::numeric_limits<Integer>::max());
  return static_cast<Integer>(static_cast<std::int64_t>(std::clamp(scaled, kLeast, kGreatest)));
}

/// Hundredths; kNoDilution when it is not a number.
[[nodiscard]] inline std::uint16_t dilution_field(double dilution) {
  return std::isnan(dilution)
             ? protocols::ubx::kNoDilution
             : std::min(to_field<std::uint16_t>(dilution, 0.01), protocols::ubx::kNoDilution);
}

/// Position of the antenna, metres.
[[nodiscard]] std::array<double, 3> ecef_position(const UbloxSolution& solution);

}  // namespace rigwire::emulators
