// Cases of the dynamics suite: every built-in machine at every level, on even ground.
//
// Each has two scenes. "smooth": nothing reaches a limit, slides, stops or breaks away, so that a
// method shows its order. The excavator moves all four functions gently; vehicles coast at 3 m/s in
// neutral with gentle steering, the roller varies its speed smoothly. "switches": the excavator
// demands more than the pump delivers, both ways; vehicles and roller start uphill, swerve and
// brake to a stop. All are on a plane that rises by 5 degrees, except that an excavator's fixed
// carrier is level. Default parameters of each machine.
#pragma once

#include <string>
#include <vector>

#include "bench/machine_precision.h"

namespace rigwire::bench {

[[nodiscard]] std::vector<MachineCase> machine_cases();

/// One parameter changed by 20 %, for its share of the error.
struct MachineVariation {
  std::string quantity;
  MachineCase nominal;
  MachineCase varied;
};
/// Returns variations of estimated parameters (docs/machines/).
[[nodiscard]] std::vector<MachineVariation> machine_variations();

}  // namespace rigwire::bench
