#include "sim/hydraulics/supply.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {

double flow_share(const SupplyParameters& parameters, std::span<const double> requests_m3ps,
                  double supply_pressure_pa) {
  double sum = 0.0;
  for (const double request : requests_m3ps) {
    sum += std::abs(request);
  }
  if (sum <= 0.0) {
    return 1.0;
  }
  // Flow sharing: pump's flow, and hydraulic power p sum(Q) <= P eta.
  double share = std::min(1.0, parameters.pump_flow_m3ps / sum);
  if (supply_pressure_pa > 0.0) {
    share = std::min(share,
                     parameters.power_limit_w * parameters.efficiency / (supply_pressure_pa * sum));
  }
  return share;
}

PortPressures port_pressures(double force, double bottom_area, double rod_side_area,
                             double tank_pressure_pa) {
  // With both sides at tank pressure a cylinder still pushes by the difference of its areas.
  const double idle = tank_pressure_pa * (bottom_area - rod_side_area);
  if (force >= idle) {
    return {(force + tank_pressure_pa * rod_side_area) / bottom_area, tank_pressure_pa};
  }
  return {tank_pressure_pa, (tank_pressure_pa * bottom_area - force) / rod_side_area};
}

ForceLimits force_limits(double bottom_area, double rod_side_area, double relief_pressure_pa,
                         double tank_pressure_pa) {
  // F = p_a A - p_b B with relief on one side and tank on the other.
  return {-(relief_pressure_pa * rod_side_area - tank_pressure_pa * bottom_area),
          relief_pressure_pa * bottom_area - tank_pressure_pa * rod_side_area};
}

}  // namespace rigwire::sim
