// What the dynamics suite drives: every machine of the house at every level, with every method that
// the level has, on ground without surprises.
#pragma once

#include <vector>

#include "hil/bench/machine_precision.h"

namespace rigwire::hil {

/// Excavators move all four functions; vehicles and roller start, turn and brake on a plane that
/// falls by 5 degrees. The default parameters of each machine.
[[nodiscard]] std::vector<MachineCase> machine_cases();

}  // namespace rigwire::hil
