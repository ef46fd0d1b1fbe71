#include "sim/engine/engine_condition.h"

#include <algorithm>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;
using fields::plain;

namespace {

constexpr double kDiesel_jpm3 = 35.8e9;  // lower heating value
constexpr double kWater_jpkgk = 4186.0;

}  // namespace

void visit(fields::Visitor& v, EngineConditionParameters& p) {
  v.number("tank", p.tank_m3, in("l").between(1e-4, 1e5), "Fuel tank's volume.");
  v.number("fuel_level", p.fuel_level, in("%").between(0, 100),
           "Fuel in the tank when a run begins.");
  v.number("indicated_efficiency", p.indicated_efficiency, plain().between(0.05, 0.7),
           "Share of the fuel's power that the cylinders make.");
  v.number("coolant_share", p.coolant_share, plain().between(0, 1),
           "Share of the fuel's power that heats the coolant.");
  v.number("water_equivalent", p.water_equivalent_kg, in("kg").between(0.01, 1e6),
           "Water with the heat capacity of engine and coolant.");
  v.number("closed_resistance", p.closed_kpw, in("K/W").between(1e-6, 1000),
           "Thermal resistance from coolant to air with the thermostat closed.");
  v.number("open_resistance", p.open_kpw, in("K/W").between(1e-6, 1000),
           "Thermal resistance from coolant to air with the thermostat open.");
  v.number("thermostat_opens", p.thermostat_opens_c, in("degC").between(0, 150),
           "Temperature at which the thermostat begins to open.");
  v.number("thermostat_open", p.thermostat_open_c, in("degC").between(0, 150),
           "Temperature from which on the thermostat is open.");
  v.number("initial_temperature", p.initial_c, in("degC").between(-40, 150),
           "Coolant and oil when a run begins.");
  v.number("air_temperature", p.air_c, in("degC").between(-40, 60),
           "Air around engine and radiator.");
  v.number("oil_rise", p.oil_rise_k, in("K").between(0, 100), "Oil above coolant at full load.");
  v.number("oil_lag", p.oil_lag_s, in("s").between(0, 1e5), "Lag of the oil's temperature.");
  v.number("oil_relief", p.oil_relief_pa, in("kPa").between(0, 1000),
           "Relief pressure of the oil pump.");
  v.number("oil_relief_speed", p.oil_relief_radps, in("rpm").between(0.1, 1e5),
           "Engine speed from which on the oil's relief valve is open.");
  v.number("fuel_pressure", p.fuel_pressure_pa, in("kPa").between(0, 1000),
           "Delivery pressure of the fuel while the engine turns.");
  v.number("coolant_level", p.coolant_level, in("%").between(0, 100), "Coolant's level.");
  v.number("oil_level", p.oil_level, in("%").between(0, 100), "Engine oil's level.");
  v.number("charging_voltage", p.charging_v, in("V").between(0, 60),
           "Battery's voltage while the alternator turns.");
  v.number("rest_voltage", p.rest_v, in("V").between(0, 60),
           "Battery's voltage while nothing charges it.");
  v.number("consumers", p.consumers_a, in("A").between(0, 125), "Current of the consumers.");
  v.number("alternator_speed", p.alternator_radps, in("rpm").between(0, 1e5),
           "Engine speed from which on the alternator charges.");
}

void validate(const EngineConditionParameters& p) {
  fields::check(p);
  fields::require(p.thermostat_open_c > p.thermostat_opens_c, "thermostat_open",
                  in("degC").print(p.thermostat_open_c),
                  "above thermostat_opens, " + in("degC").print(p.thermostat_opens_c));
}

EngineCondition::EngineCondition(const EngineConditionParameters& parameters)
    : parameters_(parameters), coolant_c_(parameters.initial_c), oil_c_(parameters.initial_c) {}

void EngineCondition::step(double h, double speed_radps, double indicated_nm, double load_share) {
  const EngineConditionParameters& p = parameters_;
  speed_radps_ = speed_radps;
  // Fuel's power: indicated power over the indicated efficiency.
  const double fuel_w = std::max(0.0, indicated_nm * speed_radps) / p.indicated_efficiency;
  const double left_m3 = std::max(0.0, p.fuel_level * p.tank_m3 - fuel_used_m3_);
  fuel_rate_m3ps_ = fuel_w / kDiesel_jpm3;
  fuel_used_m3_ += std::min(left_m3, h * fuel_rate_m3ps_);

  // C dT/dt = share P - (T - T_air) / R, R between closed and open by the thermostat's way.
  const double way = std::clamp(
      (coolant_c_ - p.thermostat_opens_c) / (p.thermostat_open_c - p.thermostat_opens_c), 0.0, 1.0);
  const double conductance = (1.0 - way) / p.closed_kpw + way / p.open_kpw;
  const double end_c = p.air_c + p.coolant_share * fuel_w / conductance;
  const double rate = conductance / (p.water_equivalent_kg * kWater_jpkgk);
  coolant_c_ += (end_c - coolant_c_) * h * rate / (1.0 + h * rate);

  const double oil_end_c = coolant_c_ + p.oil_rise_k * std::clamp(load_share, 0.0, 1.0);
  oil_c_ += (oil_end_c - oil_c_) * h / (h + p.oil_lag_s);
}

void EngineCondition::read(EngineSample& sample) const {
  const EngineConditionParameters& p = parameters_;
  const bool turns = speed_radps_ > 0.0;
  const bool charges = turns && speed_radps_ >= p.alternator_radps;
  sample.coolant_c = coolant_c_;
  sample.oil_c = oil_c_;
  sample.oil_pressure_pa =
      p.oil_relief_pa * std::clamp(speed_radps_ / p.oil_relief_radps, 0.0, 1.0);
  sample.fuel_pressure_pa = turns ? p.fuel_pressure_pa : 0.0;
  sample.coolant_level_share = p.coolant_level;
  sample.oil_level_share = p.oil_level;
  sample.fuel_level_share = std::max(0.0, p.fuel_level - fuel_used_m3_ / p.tank_m3);
  sample.fuel_rate_m3ps = fuel_rate_m3ps_;
  sample.fuel_used_m3 = fuel_used_m3_;
  sample.battery_v = charges ? p.charging_v : p.rest_v;
  sample.alternator_a = charges ? p.consumers_a : 0.0;
  sample.battery_a = charges ? 0.0 : -p.consumers_a;
}

}  // namespace rigwire::sim
