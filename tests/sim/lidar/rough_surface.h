// How bright a rough surface is that slants, seen from where the light comes from: the qualitative
// model of Oren and Nayar (SIGGRAPH 1994), facets of 30 degrees, 1 head on. Written out for tests.
#pragma once

#include <numbers>

namespace rigwire::sim {

inline double rough_surface(double cosine) {
  constexpr double kSlope2 = std::numbers::pi / 6.0 * std::numbers::pi / 6.0;
  constexpr double kA = 1.0 - 0.5 * kSlope2 / (kSlope2 + 0.33);
  constexpr double kB = 0.45 * kSlope2 / (kSlope2 + 0.09);
  // L = rho / pi cos(theta) (A + B cos(0) sin(theta) tan(theta)), over its value head on.
  return cosine + kB / kA * (1.0 - cosine * cosine);
}

}  // namespace rigwire::sim
