// The two oil volumes of one actuator, their valve, and the resulting force, with pressures as
// states.
//
//     p1' = B / V1 (Q1 - A1 u)        V1 = V_hose + A1 (x - x_min)
//     p2' = B / V2 (Q2 + A2 u)        V2 = V_hose + A2 (x_max - x)        F = A1 p1 - A2 p2 - c u
//
// u: rate of the actuator's coordinate x. The valve is pressure compensated on both edges: the
// inlet delivers the commanded flow while `inlet_drop_pa` is available, and less by the orifice law
// below that; the outlet passes the flow of the commanded speed, plus a tenth, as soon as it has
// `outlet_drop_pa` (so that an overrunning load does not run away). The friction c u is limited to
// a maximum force if one is given: the drag of gears and seals does not grow beyond it. An
// orifice's flow goes with the root of the pressure drop, and linearly below 2 bar, where the
// root's slope would be infinite. Check valves: no oil flows back into the supply, and a chamber
// below tank pressure draws from the tank. Each port has a relief valve.
//
// A step is linearly implicit in pressure and rate: the force at its end is F = offset - gain u
// (sim/contact/bristle.h), for the machine's own solve; settle() then takes the rate found. A valve
// that opens only at this rate is open in settle(), and limits() bounds the force meanwhile, so
// that no step, however long, leaves more pressure than a relief valve allows. Stable for every
// step; order 1. The standard lumped model, for example H. E. Merritt, Hydraulic Control Systems,
// 1967, chapters 3 and 6.
#pragma once

#include <array>
#include <limits>

#include "sim/contact/bristle.h"
#include "sim/hydraulics/parameters.h"
#include "sim/hydraulics/supply.h"

namespace rigwire::sim {

/// An actuator between its ends. Areas in m2 (m3/rad for a motor, whose ends are equal: no
/// stroke).
struct ActuatorSize {
  double bottom_area = 0.0;
  double rod_side_area = 0.0;
  double x_min = 0.0;
  double x_max = 0.0;
};

/// What the valve is asked for during a step.
struct ValveDemand {
  double flow_m3ps = 0.0;  ///< Into the driving chamber; positive extends.
  bool floating = false;   ///< Both chambers to tank.
  double supply_pressure_pa = 0.0;
  double tank_pressure_pa = 0.0;
  double relief_pressure_pa = 0.0;
};

class ActuatorChambers {
 public:
  ActuatorChambers() = default;
  /// `friction`: c, N s/m or N m s/rad. `friction_most`: N or N m, which its force does not pass.
  ActuatorChambers(const ChamberParameters& parameters, const ActuatorSize& size, double friction,
                   double friction_most = std::numeric_limits<double>::infinity());

  void set_pressures(const PortPressures& pressures) { pressures_ = pressures; }
  [[nodiscard]] const PortPressures& pressures() const { return pressures_; }
  /// What the chambers exert at rest.
  [[nodiscard]] double force() const;
  /// The oil's stiffness at x with closed valves, B (A1^2 / V1 + A2^2 / V2).
  [[nodiscard]] double stiffness(double x) const;

  /// The force of a step of h seconds that starts at x; remembered for settle().
  [[nodiscard]] ImplicitForce law(double h, double x, const ValveDemand& demand);
  /// Returns the minimum and maximum force of the chambers, with one of them at its relief valve,
  /// which passes the demand and the piston's displacement at `rate`, and the other at tank
  /// pressure.
  [[nodiscard]] std::array<double, 2> limits(const ValveDemand& demand, double rate) const;
  /// Ends the step with the rate found there.
  void settle(double rate);
  /// Into the driving chamber in the last step, signed as the demand.
  [[nodiscard]] double inlet_flow_m3ps() const { return inlet_flow_; }

 private:
  /// Inflow of a chamber and its slope by the chamber's pressure.
  struct Flow {
    double value = 0.0;
    double slope = 0.0;
    bool guarded = false;  ///< Relief, anti-cavitation or float is in it.
  };
  /// Returns the pressure at the end of a step that moved `area` at `rate` out of the chamber.
  /// Where it would exceed the limits of relief or anti-cavitation, these valves have opened within
  /// the step.
  [[nodiscard]] double ended_pa(double pressure_pa, const Flow& flow, double ease,
                                double area_rate) const;
  /// Returns the volumes between the piston and each end, hoses included.
  [[nodiscard]] std::array<double, 2> volumes_m3(double x) const;
  [[nodiscard]] Flow opening_flow(double most, double drop_pa, double full_drop_pa) const;
  [[nodiscard]] Flow inflow(double pressure_pa, double into_m3ps, double out_m3ps,
                            const ValveDemand& demand) const;

  ChamberParameters parameters_;
  ActuatorSize size_;
  double friction_ = 0.0;
  double friction_most_ = std::numeric_limits<double>::infinity();
  double drag_ = 0.0;  ///< Friction's force over the rate, of the step that comes.
  PortPressures pressures_;
  // Values of the step between law() and settle(): pressure change = ease (flow - area u).
  Flow flow_a_;
  Flow flow_b_;
  double ease_a_ = 0.0;
  double ease_b_ = 0.0;
  ValveDemand demand_;
  double inlet_flow_ = 0.0;
};

}  // namespace rigwire::sim
