#include "sim/hydraulics/parameters.h"

#include <cmath>
#include <numbers>
#include <sstream>
#include <stdexcept>

namespace rigwire::sim {
namespace {

void require(bool allowed_value, const char* where, const char* name, double found,
             const char* allowed) {
  if (allowed_value) {
    return;
  }
  std::ostringstream text;
  text << where << "." << name << ": found " << found << ", allowed " << allowed;
  throw std::invalid_argument(text.str());
}

bool positive(double value) {
  return std::isfinite(value) && value > 0.0;
}
bool non_negative(double value) {
  return std::isfinite(value) && value >= 0.0;
}

}  // namespace

double CylinderParameters::bottom_area_m2() const {
  return count * 0.25 * std::numbers::pi * bore_m * bore_m;
}

double CylinderParameters::rod_side_area_m2() const {
  return count * 0.25 * std::numbers::pi * (bore_m * bore_m - rod_m * rod_m);
}

void validate(const SpoolParameters& p, const char* where) {
  require(non_negative(p.time_constant_s) && p.time_constant_s <= 10.0, where, "time_constant_s",
          p.time_constant_s, "0 .. 10 s");
  require(positive(p.rate_limit_per_s), where, "rate_limit_per_s", p.rate_limit_per_s, "> 0");
  require(non_negative(p.dead_band) && p.dead_band <= 0.5, where, "dead_band", p.dead_band,
          "0 .. 0.5");
  require(positive(p.flow_max_m3ps), where, "flow_max_m3ps", p.flow_max_m3ps, "> 0");
}

void validate(const SupplyParameters& p, const char* where) {
  require(positive(p.pump_flow_m3ps), where, "pump_flow_m3ps", p.pump_flow_m3ps, "> 0");
  require(positive(p.power_limit_w), where, "power_limit_w", p.power_limit_w, "> 0");
  require(positive(p.efficiency) && p.efficiency <= 1.0, where, "efficiency", p.efficiency,
          "above 0, up to 1");
  require(non_negative(p.tank_pressure_pa), where, "tank_pressure_pa", p.tank_pressure_pa, ">= 0");
  require(non_negative(p.load_sensing_margin_pa), where, "load_sensing_margin_pa",
          p.load_sensing_margin_pa, ">= 0");
  require(positive(p.load_sensing_time_constant_s) && p.load_sensing_time_constant_s <= 10.0, where,
          "load_sensing_time_constant_s", p.load_sensing_time_constant_s, "above 0, up to 10 s");
  const double least = p.tank_pressure_pa + p.load_sensing_margin_pa;
  require(std::isfinite(p.relief_pressure_pa) && p.relief_pressure_pa > least, where,
          "relief_pressure_pa", p.relief_pressure_pa,
          "above tank_pressure_pa + load_sensing_margin_pa");
  require(std::isfinite(p.swing_relief_pressure_pa) && p.swing_relief_pressure_pa > least, where,
          "swing_relief_pressure_pa", p.swing_relief_pressure_pa,
          "above tank_pressure_pa + load_sensing_margin_pa");
}

void validate(const CylinderParameters& p, const char* where) {
  require(p.count >= 1 && p.count <= 4, where, "count", p.count, "1 .. 4");
  require(positive(p.bore_m), where, "bore_m", p.bore_m, "> 0 m");
  require(non_negative(p.rod_m) && p.rod_m < p.bore_m, where, "rod_m", p.rod_m,
          ">= 0 m and below bore_m");
  require(positive(p.length_min_m), where, "length_min_m", p.length_min_m, "> 0 m");
  require(std::isfinite(p.length_max_m) && p.length_max_m > p.length_min_m, where, "length_max_m",
          p.length_max_m, "above length_min_m");
}

void validate(const ChamberParameters& p, const char* where) {
  require(positive(p.bulk_modulus_pa), where, "bulk_modulus_pa", p.bulk_modulus_pa, "> 0 Pa");
  require(positive(p.hose_volume_m3), where, "hose_volume_m3", p.hose_volume_m3, "> 0 m3");
  require(positive(p.inlet_drop_pa), where, "inlet_drop_pa", p.inlet_drop_pa, "> 0 Pa");
  require(positive(p.outlet_drop_pa), where, "outlet_drop_pa", p.outlet_drop_pa, "> 0 Pa");
  require(positive(p.port_conductance), where, "port_conductance", p.port_conductance,
          "> 0 m3/s per Pa");
  require(non_negative(p.damping_ratio) && p.damping_ratio <= 10.0, where, "damping_ratio",
          p.damping_ratio, "0 .. 10");
}

}  // namespace rigwire::sim
