// What a magnetometer's elements read at one instant.
#pragma once

#include "sim/samples/time.h"
#include "sim/samples/vector3.h"

namespace rigwire {

/// Expressed in the sensor's frame (x forward, y left, z up), sensor errors and the iron of the
/// machine included.
struct MagnetometerSample {
  SimTime time{};
  Vector3 field_t;  ///< Tesla.
};

}  // namespace rigwire
