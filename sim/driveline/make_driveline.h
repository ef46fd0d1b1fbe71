// A drive line from its parameters.
#pragma once

#include <memory>

#include "sim/driveline/driveline.h"
#include "sim/driveline/parameters.h"

namespace rigwire::sim {

/// In neutral, engine at idle. Throws as validate() does.
[[nodiscard]] std::unique_ptr<Driveline> make_driveline(const DrivelineParameters& parameters);

}  // namespace rigwire::sim
