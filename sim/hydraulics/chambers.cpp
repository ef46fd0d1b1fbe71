#include "sim/hydraulics/chambers.h"

#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

constexpr double kLaminar_pa = 2e5;
constexpr double kOutletReserve = 1.1;  // Outlet's flow over the flow of the speed asked for.

}  // namespace

ActuatorChambers::ActuatorChambers(const ChamberParameters& parameters, const ActuatorSize& size,
                                   double friction, double friction_most)
    : parameters_(parameters),
      size_(size),
      friction_(friction),
      friction_most_(friction_most),
      drag_(friction) {}

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
    flow.guarded = true;
    return flow;
  }
  const Flow in = opening_flow(into_m3ps, demand.supply_pressure_pa - pressure_pa, p.inlet_drop_pa);
  add(in.value, -in.slope);
  const Flow out = opening_flow(out_m3ps, pressure_pa - demand.tank_pressure_pa, p.outlet_drop_pa);
  add(-out.value, -out.slope);
  if (pressure_pa > demand.relief_pressure_pa) {
    add(p.port_conductance * (demand.relief_pressure_pa - pressure_pa), -p.port_conductance);
    flow.guarded = true;
  } else if (pressure_pa < demand.tank_pressure_pa) {
    add(p.port_conductance * (demand.tank_pressure_pa - pressure_pa), -p.port_conductance);
    flow.guarded = true;
  }
  return flow;
}

ImplicitForce ActuatorChambers::law(double h, double x, const ValveDemand& demand) {
  const double a = size_.bottom_area;
  const double b = size_.rod_side_area;
  const auto [volume_a, volume_b] = volumes_m3(x);
  const double flow = demand.flow_m3ps;
  demand_ = demand;
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
          a * a * ease_a_ + b * b * ease_b_ + drag_};
}

std::array<double, 2> ActuatorChambers::limits(const ValveDemand& demand, double rate) const {
  const double a = size_.bottom_area;
  const double b = size_.rod_side_area;
  const auto most_pa = [&](double area) {
    return demand.relief_pressure_pa +
           (std::abs(demand.flow_m3ps) + area * std::abs(rate)) / parameters_.port_conductance;
  };
  return {a * demand.tank_pressure_pa - b * most_pa(b) - drag_ * std::abs(rate),
          a * most_pa(a) - b * demand.tank_pressure_pa + drag_ * std::abs(rate)};
}

double ActuatorChambers::ended_pa(double pressure_pa, const Flow& flow, double ease,
                                  double area_rate) const {
  const double ended = pressure_pa + ease * (flow.value - area_rate);
  const double bound = std::clamp(ended, demand_.tank_pressure_pa, demand_.relief_pressure_pa);
  if (flow.guarded || bound == ended || ease == 0.0) {
    return ended;
  }
  // Repeats the step with the valve's flow G (bound - p) in it: 1 / ease grows by G.
  const double g = parameters_.port_conductance;
  return pressure_pa + (flow.value + g * (bound - pressure_pa) - area_rate) / (1.0 / ease + g);
}

void ActuatorChambers::settle(double rate) {
  // Pressure changes with the rate found; the inlet's flow at the pressure reached.
  const double ended_a = ended_pa(pressures_.a_pa, flow_a_, ease_a_, size_.bottom_area * rate);
  const double ended_b = ended_pa(pressures_.b_pa, flow_b_, ease_b_, -size_.rod_side_area * rate);
  const double change_a = ended_a - pressures_.a_pa;
  const double change_b = ended_b - pressures_.b_pa;
  pressures_ = {ended_a, ended_b};
  // The secant of the step before: never negative, so that friction only takes energy.
  drag_ = friction_ * std::abs(rate) > friction_most_ ? friction_most_ / std::abs(rate) : friction_;
  inlet_flow_ = demand_.flow_m3ps > 0.0   ? flow_a_.value + flow_a_.slope * change_a
                : demand_.flow_m3ps < 0.0 ? -(flow_b_.value + flow_b_.slope * change_b)
                                          : 0.0;
}

}  // namespace rigwire::sim
