#include "sim/engine/power_unit_fault.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "sim/excavator/power_unit.h"

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;

constexpr double kPressure_pa = 30e6;

/// The valves take all that they get; returns the greatest torque on the way.
double take_all(PowerUnit& unit, double seconds) {
  double greatest_nm = 0.0;
  for (int i = 0; i < static_cast<int>(1000 * seconds); ++i) {
    const SupplyParameters& now = unit.supply();
    unit.step(1e-3, std::min(now.pump_flow_m3ps, now.power_limit_w * now.efficiency / kPressure_pa),
              kPressure_pa);
    greatest_nm = std::max(greatest_nm, unit.torque_nm());
  }
  return greatest_nm;
}

TEST(PowerUnitFault, ADeratedEngineGivesItsShareAndKeepsRunning) {
  const PowerUnitParameters parameters;
  const SupplyParameters supply;
  PowerUnit well(parameters, supply);
  PowerUnit derated(parameters, supply);
  derated.fail({.torque_share = 0.4});
  const double whole_nm = take_all(well, 5.0);
  const double left_nm = take_all(derated, 5.0);
  EXPECT_LE(left_nm, 0.4 * derated.engine_data().reference_torque_nm);
  EXPECT_LT(left_nm, 0.6 * whole_nm);
  EXPECT_GE(derated.speed_radps(), 0.9 * parameters.engine.idle_radps);
  EXPECT_LT(derated.supply().power_limit_w, well.supply().power_limit_w);
}

TEST(PowerUnitFault, WithoutFuelTheEngineRunsDownAndWithItUpAgain) {
  const PowerUnitParameters parameters;
  const SupplyParameters supply;
  PowerUnit unit(parameters, supply);
  unit.fail({.fuel = false});
  take_all(unit, 10.0);
  EXPECT_EQ(unit.speed_radps(), 0.0);
  EXPECT_EQ(unit.supply().pump_flow_m3ps, 0.0);
  unit.fail({});
  PowerUnit well(parameters, supply);
  for (int i = 0; i < 20'000; ++i) {  // with nothing but what the swash plates leave
    unit.step(1e-3, 0.0, 1e6);
    well.step(1e-3, 0.0, 1e6);
  }
  EXPECT_NEAR(unit.speed_radps(), well.speed_radps(), 1e-3 * well.speed_radps());
}

TEST(PowerUnitFault, WeakPumpsGiveTheirShareAtTheSameSpeed) {
  const PowerUnitParameters parameters;
  const SupplyParameters supply;
  PowerUnit unit(parameters, supply);
  const double whole = unit.supply().pump_flow_m3ps;
  unit.fail({.flow_share = 0.25});
  unit.step(1e-3, 0.0, 1e6);
  EXPECT_NEAR(unit.supply().pump_flow_m3ps, 0.25 * whole, 1e-6 * whole);
}

TEST(PowerUnitFault, DefectsAreThoseThatHoldAtTheInstant) {
  const FaultBook<EngineFault> engine(
      {{{1s, 2s}, DerateFault{.share = 0.5, .ramp = 1s}}, {{2s, 1s}, NoFuelFault{}}});
  const FaultBook<PumpFault> pumps({{{2s, 1s}, WeakPumpsFault{.share = 0.2}}});
  EXPECT_EQ(defects_at(kStart, engine, pumps), PowerUnitDefects{});
  EXPECT_EQ(defects_at(kStart + 1500ms, engine, pumps),
            (PowerUnitDefects{.fuel = true, .torque_share = 0.75, .flow_share = 1.0}));
  EXPECT_EQ(defects_at(kStart + 2s, engine, pumps),
            (PowerUnitDefects{.fuel = false, .torque_share = 0.5, .flow_share = 0.2}));
  EXPECT_EQ(defects_at(kStart + 3s, engine, pumps), PowerUnitDefects{});
}

}  // namespace
}  // namespace rigwire::sim
