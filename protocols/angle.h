// Degrees of wire formats in SI.
#pragma once

#include <numbers>

namespace rigwire::protocols {

/// Radians in a degree.
inline constexpr double kDegree = std::numbers::pi / 180.0;

}  // namespace rigwire::protocols
