// Machines of configs/machines/, where their numbers are.
#pragma once

#include "sim/driveline/parameters.h"
#include "sim/excavator/parameters.h"
#include "sim/vehicle/parameters.h"

namespace rigwire::bench {

struct Gator {
  sim::WheeledVehicleParameters vehicle;
  sim::DrivelineParameters driveline;
};

/// The John Deere Gator XUV 855D. Each function reads its file when it is called first, and throws
/// ConfigurationError when the file is missing or wrong.
[[nodiscard]] const Gator& gator_855d();
[[nodiscard]] const sim::ExcavatorParameters& excavator_ref18t();

}  // namespace rigwire::bench
