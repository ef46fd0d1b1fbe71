// Heat, fuel and battery against their balances.
#include "sim/engine/engine_condition.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigwire::sim {
namespace {

EngineSample after(EngineCondition& condition, double seconds, double speed_radps,
                   double indicated_nm, double load_share = 0.5) {
  constexpr double kEngineConditionStep_s = 0.1;
  for (int i = 0; i < std::lround(seconds / kEngineConditionStep_s); ++i) {
    condition.step(kEngineConditionStep_s, speed_radps, indicated_nm, load_share);
  }
  EngineSample sample;
  condition.read(sample);
  return sample;
}

TEST(EngineCondition, FuelIsIndicatedPowerOverEfficiencyAndHeatingValue) {
  EngineConditionParameters p;
  EngineCondition condition(p);
  const EngineSample sample = after(condition, 100.0, 200.0, 500.0);
  const double rate_m3ps = 500.0 * 200.0 / p.indicated_efficiency / 35.8e9;
  EXPECT_NEAR(sample.fuel_rate_m3ps, rate_m3ps, 1e-12);
  EXPECT_NEAR(sample.fuel_used_m3, 100.0 * rate_m3ps, 1e-7);
  EXPECT_NEAR(sample.fuel_level_share, p.fuel_level - 100.0 * rate_m3ps / p.tank_m3, 1e-6);
}

TEST(EngineCondition, TankIsNeverLessThanEmpty) {
  EngineConditionParameters p;
  p.tank_m3 = 1e-5;
  EngineCondition condition(p);
  const EngineSample sample = after(condition, 100.0, 200.0, 500.0);
  EXPECT_EQ(sample.fuel_level_share, 0.0);
}

TEST(EngineCondition, ThermostatHoldsTheCoolantWithinItsRange) {
  EngineConditionParameters p;
  p.initial_c = 20.0;
  EngineCondition condition(p);
  EXPECT_LT(after(condition, 60.0, 150.0, 600.0).coolant_c, p.thermostat_opens_c);
  const double warm_c = after(condition, 4000.0, 150.0, 600.0).coolant_c;
  EXPECT_GT(warm_c, p.thermostat_opens_c);
  EXPECT_LT(warm_c, p.thermostat_open_c);
  // Balance at that temperature: heat in is heat out.
  const double way = (warm_c - p.thermostat_opens_c) / (p.thermostat_open_c - p.thermostat_opens_c);
  const double conductance = (1.0 - way) / p.closed_kpw + way / p.open_kpw;
  const double heat_w = p.coolant_share * 150.0 * 600.0 / p.indicated_efficiency;
  EXPECT_NEAR(conductance * (warm_c - p.air_c) / heat_w, 1.0, 1e-3);
}

TEST(EngineCondition, StandingEngineDoesNotCharge) {
  EngineConditionParameters p;
  EngineCondition condition(p);
  const EngineSample off = after(condition, 1.0, 0.0, 0.0);
  EXPECT_EQ(off.battery_v, p.rest_v);
  EXPECT_EQ(off.battery_a, -p.consumers_a);
  EXPECT_EQ(off.oil_pressure_pa, 0.0);
  const EngineSample on = after(condition, 1.0, 100.0, 100.0);
  EXPECT_EQ(on.battery_v, p.charging_v);
  EXPECT_EQ(on.alternator_a, p.consumers_a);
  EXPECT_NEAR(on.oil_pressure_pa, p.oil_relief_pa * 100.0 / p.oil_relief_radps, 1e-6);
}

}  // namespace
}  // namespace rigwire::sim
