#include "sim/hydraulics/parameters.h"

#include <numbers>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;
using fields::IntegerRule;
using fields::plain;

double CylinderParameters::bottom_area_m2() const {
  return count * 0.25 * std::numbers::pi * bore_m * bore_m;
}

double CylinderParameters::rod_side_area_m2() const {
  return count * 0.25 * std::numbers::pi * (bore_m * bore_m - rod_m * rod_m);
}

void visit(fields::Visitor& v, SpoolParameters& p) {
  v.number("time_constant", p.time_constant_s, in("ms").between(0, 10000),
           "Lag of the pilot stage; 0 = none.");
  v.number("rate_limit", p.rate_limit_per_s, plain().between(1e-6, 1e6),
           "Full travels of the spool per second.");
  v.number("dead_band", p.dead_band, plain().between(0, 0.5),
           "Share of the spool's travel without flow.");
  v.number("flow_max", p.flow_max_m3ps, in("l/min").between(0.001, 1e6),
           "Flow at full travel of the spool.");
  v.number("back_share", p.back_share, plain().between(0.01, 10),
           "Share of flow_max at full travel the other way: retracting, turning right.");
}

void visit(fields::Visitor& v, SupplyParameters& p) {
  v.number("pump_flow", p.pump_flow_m3ps, in("l/min").between(0.001, 1e6),
           "Flow of all pumps together.");
  v.number("power_limit", p.power_limit_w, in("kW").between(0.001, 1e5),
           "Power that the engine leaves for the pumps.");
  v.number("efficiency", p.efficiency, plain().between(1e-6, 1),
           "Hydraulic power of the pumps per power of their shaft.");
  v.number("relief_pressure", p.relief_pressure_pa, in("MPa").between(0.001, 1000),
           "Relief pressure of the implement.");
  v.number("swing_relief_pressure", p.swing_relief_pressure_pa, in("MPa").between(0.001, 1000),
           "Relief pressure of the swing motor.");
  v.number("load_sensing_margin", p.load_sensing_margin_pa, in("MPa").between(0, 1000),
           "Supply pressure above the highest load.");
  v.number("load_sensing_time_constant", p.load_sensing_time_constant_s,
           in("ms").between(0.001, 10000), "Lag of the pump's pressure regulator.");
  v.number("tank_pressure", p.tank_pressure_pa, in("MPa").between(0, 1000),
           "Pressure of the return line.");
}

void visit(fields::Visitor& v, CylinderParameters& p) {
  v.integer("count", p.count, IntegerRule{1, 4}, "Equal cylinders side by side.");
  v.number("bore", p.bore_m, in("mm").between(0.001, 10'000), "Diameter of the piston.");
  v.number("rod", p.rod_m, in("mm").at_least(0).at_most(10'000), "Diameter of the rod.");
  v.number("length_min", p.length_min_m, in("mm").between(0.001, 10'000), "Pin to pin, retracted.");
  v.number("length_max", p.length_max_m, in("mm").between(0.001, 10'000), "Pin to pin, extended.");
}

void visit(fields::Visitor& v, ChamberParameters& p) {
  v.number("bulk_modulus", p.bulk_modulus_pa, in("MPa").between(1, 1e5),
           "Bulk modulus of oil with some air, and of hoses.");
  v.number("hose_volume", p.hose_volume_m3, in("m3").between(1e-9, 1000),
           "Oil on each side beside the stroke's, dead volume included.");
  v.number("inlet_drop", p.inlet_drop_pa, in("MPa").between(0.001, 1000),
           "Pressure that the valve's inlet needs.");
  v.number("outlet_drop", p.outlet_drop_pa, in("MPa").between(0.001, 1000),
           "Pressure that the valve's outlet needs.");
  v.number("port_conductance", p.port_conductance, in("m3/s/Pa").between(1e-18, 1),
           "Flow per pressure of relief, anti-cavitation and float.");
  v.number("damping_ratio", p.damping_ratio, plain().between(0, 10),
           "Damping ratio of the oil's mode, by seals and lines.");
}

void validate(const SpoolParameters& p) {
  fields::check(p);
}

void validate(const SupplyParameters& p) {
  fields::check(p);
  const double least_pa = p.tank_pressure_pa + p.load_sensing_margin_pa;
  const std::string allowed =
      "above tank_pressure + load_sensing_margin, " + in("MPa").print(least_pa);
  fields::require(p.relief_pressure_pa > least_pa, "relief_pressure",
                  in("MPa").print(p.relief_pressure_pa), allowed);
  fields::require(p.swing_relief_pressure_pa > least_pa, "swing_relief_pressure",
                  in("MPa").print(p.swing_relief_pressure_pa), allowed);
}

void validate(const CylinderParameters& p) {
  fields::check(p);
  fields::require(p.rod_m < p.bore_m, "rod", in("mm").print(p.rod_m),
                  "below bore, " + in("mm").print(p.bore_m));
  fields::require(p.length_max_m > p.length_min_m, "length_max", in("mm").print(p.length_max_m),
                  "above length_min, " + in("mm").print(p.length_min_m));
}

void validate(const ChamberParameters& p) {
  fields::check(p);
}

}  // namespace rigwire::sim
