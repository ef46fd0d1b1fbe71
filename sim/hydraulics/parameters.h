// What a load-sensing valve block, its pump and its actuators are made of: plain parameters with
// the defaults of the REF-18t machine.
//
// All defaults are engineering estimates for an 18 t machine (docs/machines/excavator.md says how
// they were chosen); none is a maker's data sheet. SI units; 1 l/min = 1.6667e-5 m3/s.
#pragma once

#include "fields/rules.h"

namespace rigwire::sim {

/// One valve section's spool.
struct SpoolParameters {
  double time_constant_s = 0.030;      ///< First-order lag of the pilot stage; 0 = none.
  double rate_limit_per_s = 10.0;      ///< Full spool travels per second.
  double dead_band = 0.04;             ///< Overlap: share of the travel without flow, 0 .. 0.5.
  double flow_max_m3ps = 300.0 / 6e4;  ///< Flow request at full travel, pressure compensated.
  double back_share = 1.0;             ///< Share of flow_max at full travel in the other direction.

  friend bool operator==(const SpoolParameters&, const SpoolParameters&) = default;
};

/// Pump, engine and pressures that all sections share.
struct SupplyParameters {
  double pump_flow_m3ps = 400.0 / 6e4;         ///< Two pumps of 200 l/min, summed.
  double power_limit_w = 100e3;                ///< What the engine leaves for the pumps.
  double efficiency = 0.90;                    ///< Shaft power to hydraulic power, 0 .. 1.
  double relief_pressure_pa = 35e6;            ///< Implement relief; also the supply's maximum.
  double swing_relief_pressure_pa = 26e6;      ///< Relief of the swing motor.
  double load_sensing_margin_pa = 2e6;         ///< Supply pressure above the highest load.
  double load_sensing_time_constant_s = 0.05;  ///< Lag of the pump's pressure regulator.
  double tank_pressure_pa = 0.3e6;             ///< Return line.

  friend bool operator==(const SupplyParameters&, const SupplyParameters&) = default;
};

/// One function's cylinder, or several equal ones side by side on the same pins.
struct CylinderParameters {
  int count = 1;
  double bore_m = 0.125;
  double rod_m = 0.090;
  double length_min_m = 1.85;  ///< Pin to pin, retracted.
  double length_max_m = 3.05;  ///< Pin to pin, extended.

  /// Pressurised areas of all `count` cylinders together.
  [[nodiscard]] double bottom_area_m2() const;
  [[nodiscard]] double rod_side_area_m2() const;

  friend bool operator==(const CylinderParameters&, const CylinderParameters&) = default;
};

/// The oil in one actuator's two chambers and hoses (chambers.h).
struct ChamberParameters {
  double bulk_modulus_pa = 1.0e9;  ///< Effective: oil with some air, hoses, tubes.
  double hose_volume_m3 = 1.5e-3;  ///< Per side, with the dead volume of the cylinder's end.
  double inlet_drop_pa = 1.5e6;    ///< Below the load-sensing margin: what the inlet needs.
  double outlet_drop_pa = 0.5e6;   ///< What the outlet needs.
  double port_conductance = 5e-9;  ///< m3/s per Pa: relief, anti-cavitation, float.
  double damping_ratio = 0.10;     ///< Seals and lines, of the oil's mode at the start.

  friend bool operator==(const ChamberParameters&, const ChamberParameters&) = default;
};

void visit(fields::Visitor& v, SpoolParameters& p);
void visit(fields::Visitor& v, SupplyParameters& p);
void visit(fields::Visitor& v, CylinderParameters& p);
void visit(fields::Visitor& v, ChamberParameters& p);

/// Each throws std::invalid_argument that names the key, the value found and what is allowed.
void validate(const SpoolParameters& parameters);
void validate(const SupplyParameters& parameters);
void validate(const CylinderParameters& parameters);
void validate(const ChamberParameters& parameters);

}  // namespace rigwire::sim
