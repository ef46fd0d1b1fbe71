// The John Deere Gator XUV 855D of configs/machines/, where its numbers stand once.
#pragma once

#include "sim/driveline/parameters.h"
#include "sim/vehicle/parameters.h"

namespace rigwire::bench {

struct Gator {
  sim::WheeledVehicleParameters vehicle;
  sim::DrivelineParameters driveline;
};

/// Read when first asked for. Throws ConfigurationError when the file is missing or wrong.
[[nodiscard]] const Gator& gator_855d();

}  // namespace rigwire::bench
