// From SI to the integers of a message: rounded, clamped to the field.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "protocols/ubx/navigation.h"

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

[[nodiscard]] inline std::uint32_t unsigned_field(double value, double unit) {
  return to_field<std::uint32_t>(value, unit);
}
[[nodiscard]] inline std::int32_t signed_field(double value, double unit) {
  return to_field<std::int32_t>(value, unit);
}

/// Hundredths; 9999 when there is none.
[[nodiscard]] inline std::uint16_t dilution_field(double dilution) {
  using protocols::ubx::kNoDilution;
  return std::isnan(dilution) ? kNoDilution
                              : std::min(to_field<std::uint16_t>(dilution, 0.01), kNoDilution);
}

[[nodiscard]] inline std::array<std::int32_t, 3> in_centimetres(
    const std::array<double, 3>& metres) {
  return {signed_field(metres[0], 0.01), signed_field(metres[1], 0.01),
          signed_field(metres[2], 0.01)};
}

}  // namespace rigwire::emulators
