#include "sim/hydraulics/chambers.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

constexpr double kLaminar_pa = 2e5;
constexpr double kOutletReserve = 1.1;  // Outlet's flow over the flow of the speed asked for.

}  // namespace

ActuatorChambers::ActuatorChambers(const ChamberParameters& parameters, const ActuatorSize& size,
                                   double friction)
    : parameters_(parameters), size_(size), friction_(friction) {}

double ActuatorChambers::force() const {
  return size_.bottom_area * pressures_.a_pa - size_.rod_side_area * pressures_.b_pa;
}

std::array<double, 2> ActuatorChambers::volumes_m3(double x) const {
  const double at = std::clamp(x, size_.x_min, size_.x_max);
  return {parameters_.hose_volume_m3 + size_.bottom_area * (at - size_.x_min),
          parameters_.hose_volume_m3 + size_.rod_side_area * (size_.x_max - at)};
}

double ActuatorChambers::stiffness(double x) const {
  const double a = size_.bottom_area;
  const double b = size_.rod_side_area;
  const auto [volume_a, volume_b] = volumes_m3(x);
  return parameters_.bulk_modulus_pa * (a * a / volume_a + b * b / volume_b);
}

ActuatorChambers::Flow ActuatorChambers::opening_flow(double most, double drop_pa,
                                                      double full_drop_pa) const {
  if (drop_pa <= 0.0 || most <= 0.0) {
    return {};
  }
  if (drop_pa >= full_drop_pa) {
    return {most, 0.0};
  }
  // Orifice Q = Q_max sqrt(dp / dp_full), linear below the laminar limit (Merritt, ch. 3).
  const double laminar = std::min(kLaminar_pa, full_drop_pa);
  if (drop_pa <= laminar) {
    const double slope = most / std::sqrt(laminar * full_drop_pa);
    return {slope * drop_pa, slope};
  }
  const double root = std::sqrt(drop_pa / full_drop_pa);
  return {most * root, 0.5 * most * root / drop_pa};
}

ActuatorChambers::Flow ActuatorChambers::inflow(double pressure_pa, double into_m3ps,
                                                double out_m3ps, const ValveDemand& demand) const {
  const ChamberParameters& p = parameters_;
  Flow flow;
  const auto add = [&flow](double value, double slope) {
    flow.value += value;
    flow.slope += slope;
  };
  if (demand.floating) {
    add(p.port_conductance * (demand.tank_pressure_pa - pressure_pa), -p.port_conductance);
    return flow;
  }
  const Flow in = opening_flow(into_m3ps, demand.supply_pressure_pa - pressure_pa, p.inlet_drop_pa);
  add(in.value, -in.slope);
  const Flow out = opening_flow(out_m3ps, pressure_pa - demand.tank_pressure_pa, p.outlet_drop_pa);
  add(-out.value, -out.slope);
  if (pressure_pa > demand.relief_pressure_pa) {
    add(p.port_conductance * (demand.relief_pressure_pa - pressure_pa), -p.port_conductance);
  } else if (pressure_pa < demand.tank_pressure_pa) {
    add(p.port_conductance * (demand.tank_pressure_pa - pressure_pa), -p.port_conductance);
  }
  return flow;
}

ImplicitForce ActuatorChambers::law(double h, double x, const ValveDemand& demand) {
  const double a = size_.bottom_area;
  const double b = size_.rod_side_area;
  const auto [volume_a, volume_b] = volumes_m3(x);
  const double flow = demand.flow_m3ps;
  demanded_ = flow;
  if (flow >= 0.0) {
    flow_a_ = inflow(pressures_.a_pa, flow, 0.0, demand);
    flow_b_ = inflow(pressures_.b_pa, 0.0, kOutletReserve * flow * b / a, demand);
  } else {
    flow_a_ = inflow(pressures_.a_pa, 0.0, -kOutletReserve * flow * a / b, demand);
    flow_b_ = inflow(pressures_.b_pa, -flow, 0.0, demand);
  }
  // Linearly implicit p' = B / V (Q -+ A u): dp = ease (Q -+ A u), 1 / ease = V / (h B) - dQ/dp.
  const double per_a = h * parameters_.bulk_modulus_pa / volume_a;
  const double per_b = h * parameters_.bulk_modulus_pa / volume_b;
  ease_a_ = per_a / (1.0 - per_a * flow_a_.slope);
  ease_b_ = per_b / (1.0 - per_b * flow_b_.slope);
  return {a * (pressures_.a_pa + ease_a_ * flow_a_.value) -
              b * (pressures_.b_pa + ease_b_ * flow_b_.value),
          a * a * ease_a_ + b * b * ease_b_ + friction_};
}

void ActuatorChambers::settle(double rate) {
  // Pressure changes with the rate found; the inlet's flow at the pressure reached.
  const double change_a = ease_a_ * (flow_a_.value - size_.bottom_area * rate);
  const double change_b = ease_b_ * (flow_b_.value + size_.rod_side_area * rate);
  pressures_.a_pa += change_a;
  pressures_.b_pa += change_b;
  inlet_flow_ = demanded_ > 0.0   ? flow_a_.value + flow_a_.slope * change_a
                : demanded_ < 0.0 ? -(flow_b_.value + flow_b_.slope * change_b)
                                  : 0.0;
}

}  // namespace rigwire::sim
