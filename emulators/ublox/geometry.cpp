#include "emulators/ublox/geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace rigwire::emulators {
namespace {

// Unknowns: north, east, clock, down; the last one is left out when the height is held.
constexpr std::size_t kMost = 4;
using Matrix = std::array<std::array<double, kMost>, kMost>;

/// Gauss and Jordan with pivots on the diagonal, which suits a positive definite matrix. False when
/// it is (nearly) singular.
bool invert(Matrix& a, std::size_t n) {
  constexpr double kSmallestPivot = 1e-9;
  Matrix inverse{};
  for (std::size_t i = 0; i < n; ++i) {
    inverse[i][i] = 1.0;
  }
  for (std::size_t column = 0; column < n; ++column) {
    const double pivot = a[column][column];
    if (!(pivot > kSmallestPivot)) {
      return false;
    }
    for (std::size_t k = 0; k < n; ++k) {
      a[column][k] /= pivot;
      inverse[column][k] /= pivot;
    }
    for (std::size_t row = 0; row < n; ++row) {
      const double factor = a[row][column];
      for (std::size_t k = 0; row != column && k < n; ++k) {
        a[row][k] -= factor * a[column][k];
        inverse[row][k] -= factor * inverse[column][k];
      }
    }
  }
  a = inverse;
  return true;
}

}  // namespace

std::optional<UbloxGeometry> geometry_of(std::span<const SatelliteView> satellites) {
  const auto used = std::ranges::count_if(satellites, &SatelliteView::used);
  if (used < 3) {
    return std::nullopt;
  }
  const std::size_t unknowns = used == 3 ? 3 : kMost;
  Matrix normal{};
  for (const SatelliteView& view : satellites) {
    if (!view.used) {
      continue;
    }
    const double level = std::cos(view.elevation_rad);
    const std::array<double, kMost> row{-level * std::cos(view.azimuth_rad),
                                        -level * std::sin(view.azimuth_rad), 1.0,
                                        std::sin(view.elevation_rad)};
    for (std::size_t i = 0; i < unknowns; ++i) {
      for (std::size_t k = 0; k < unknowns; ++k) {
        normal[i][k] += row[i] * row[k];
      }
    }
  }
  if (!invert(normal, unknowns)) {
    return std::nullopt;
  }
  return UbloxGeometry{std::sqrt(normal[0][0] + normal[1][1]),
                       unknowns == kMost ? std::sqrt(normal[3][3]) : 0.0, std::sqrt(normal[2][2])};
}

}  // namespace rigwire::emulators
