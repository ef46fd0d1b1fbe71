// What an inertial measurement unit's sensing elements feel at one instant, in SI units.
#pragma once

#include <limits>

#include "sim/samples/time.h"
#include "sim/samples/vector3.h"

namespace rigwire {

/// Expressed in the sensor's frame (x forward, y left, z up), sensor errors included. At rest and
/// level the specific force is (0, 0, +g).
struct ImuSample {
  SimTime time{};
  Vector3 specific_force_mps2;
  Vector3 angular_rate_radps;
  double temperature_c = 25.0;
  /// Not a number without a magnetometer.
  Vector3 magnetic_field_t{std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::quiet_NaN()};
};

}  // namespace rigwire
