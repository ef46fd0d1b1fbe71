// Draws a RigStatus as a table for people.
#pragma once

#include <string>
#include <vector>

#include "hil/executive/truth_source.h"
#include "hil/rig/rig_status.h"

namespace rigwire::hil {

/// Rates are those between `before` and `now` (per simulated second). `colour` adds ANSI colours:
/// red for drops, yellow for a rate more than 10 % off its nominal value. Lines end in '\n'.
[[nodiscard]] std::string draw_status_table(const RigStatus& before, const RigStatus& now,
                                            const std::vector<StateQuantity>& machine, bool colour);

}  // namespace rigwire::hil
