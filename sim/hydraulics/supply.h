// The pump's share for each section, and the pressures that the transducers read.
#pragma once

#include <span>

#include "sim/hydraulics/parameters.h"

namespace rigwire::sim {

/// The factor 0 .. 1 by which every requested flow (signed, m3/s) is reduced so that their sum
/// exceeds neither the pump's flow nor its power at `supply_pressure_pa` (flow sharing: all
/// sections slow down in the same ratio). 1 without requests.
[[nodiscard]] double flow_share(const SupplyParameters& parameters,
                                std::span<const double> requests_m3ps, double supply_pressure_pa);

/// Pressures at the two ports of one actuator.
struct PortPressures {
  double a_pa = 0.0;  ///< Bottom side; on the swing motor the side that turns left.
  double b_pa = 0.0;  ///< Rod side; on the swing motor the side that turns right.
};

/// Ports of an actuator that exerts `force` (N, positive extends; N m on a motor), its other side
/// at tank pressure: F = a_pa A - b_pa B with areas in m2 (m3/rad on a motor). This is the
/// quasi-static estimate of a model without chamber states: it has the loads, not the oil's
/// oscillation.
[[nodiscard]] PortPressures port_pressures(double force, double bottom_area, double rod_side_area,
                                           double tank_pressure_pa);

/// The largest forces that a relief valve lets an actuator exert, pulling (negative) and pushing.
struct ForceLimits {
  double least = 0.0;
  double greatest = 0.0;
};
[[nodiscard]] ForceLimits force_limits(double bottom_area, double rod_side_area,
                                       double relief_pressure_pa, double tank_pressure_pa);

}  // namespace rigwire::sim
