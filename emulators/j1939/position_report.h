// Position messages of a node: VP, VDS and VP2 from a satellite fix.
#pragma once

#include "protocols/vehicle/position.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::emulators {

struct PositionReport {
  protocols::vehicle::VehiclePosition position;
  protocols::vehicle::VehicleDirectionSpeed direction;
  protocols::vehicle::VehiclePosition2 quality;

  /// Without a fix everything is not available but the number of satellites. Below 0.1 m/s the
  /// course says nothing: the last bearing stays.
  void take(const GnssSample& sample);
};

}  // namespace rigwire::emulators
