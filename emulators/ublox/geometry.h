// How the directions of the satellites that take part in a fix dilute it.
#pragma once

#include <optional>
#include <span>

#include "sim/samples/gnss_sample.h"

namespace rigwire::emulators {

struct UbloxGeometry {
  double horizontal = 0.0;
  double vertical = 0.0;  ///< 0 with three satellites, when the height is held.
  double time = 0.0;
};

/// Q = (G^T G)^-1 with rows [-e, 1] of the used satellites, one clock for all; with three of them
/// the height's column is left out. Nothing with fewer, or when they lie on a cone.
[[nodiscard]] std::optional<UbloxGeometry> geometry_of(std::span<const SatelliteView> satellites);

}  // namespace rigwire::emulators
