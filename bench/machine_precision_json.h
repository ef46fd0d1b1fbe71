// The dynamics suite's figures as JSON; keys are in docs/accuracy/README.md.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "bench/machine_precision.h"

namespace rigwire::bench {

[[nodiscard]] nlohmann::json precision_json(const MachineCase& of, const MachinePrecision& found);

}  // namespace rigwire::bench
