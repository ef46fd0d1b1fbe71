// How fast the roller's equations are at their fastest: what bounds an explicit step.
#pragma once

#include "sim/roller/parameters.h"

namespace rigwire::sim {

/// Greatest size of an eigenvalue of the dynamic level's equations (rad/s), over standstill and top
/// speed, steered straight and to the stops, everything holding, the machine empty; also the rates
/// of swash plate, engine and the pump on its torque limit. Precondition: everything else of
/// `parameters` is valid.
[[nodiscard]] double fastest_rate_radps(const RollerParameters& parameters);

}  // namespace rigwire::sim
