// The dynamics suite's figures as JSON; keys are in docs/accuracy/README.md.
#pragma once

#include <nlohmann/json.hpp>

#include "hil/bench/machine_precision.h"

namespace rigwire::hil {

/// JSON has no infinity and no NaN: null.
[[nodiscard]] nlohmann::json number_or_null(double value);

[[nodiscard]] nlohmann::json precision_json(const MachineCase& of, const MachinePrecision& found);

}  // namespace rigwire::hil
