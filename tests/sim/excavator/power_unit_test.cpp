// The excavator's engine and pumps against closed forms: droop, energy, stalling, speed requests.
#include "sim/excavator/power_unit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace rigwire::sim {
namespace {

constexpr double kStep_s = 1e-3;

struct Running {
  explicit Running(const PowerUnitParameters& of = {}) : parameters(of), unit(of, supply) {}

  /// The valves take that much; returns the least speed on the way.
  double run(double power_unit_seconds, double flow_m3ps, double pressure_pa) {
    double least = unit.speed_radps();
    for (int i = 0; i < static_cast<int>(std::lround(power_unit_seconds / kStep_s)); ++i) {
      unit.step(kStep_s, flow_m3ps, pressure_pa);
      least = std::min(least, unit.speed_radps());
    }
    return least;
  }

  /// The valves take all that the pump controller lets them have; returns the least speed on the
  /// way.
  double take_all(double power_unit_seconds, double pressure_pa) {
    double least = unit.speed_radps();
    for (int i = 0; i < static_cast<int>(std::lround(power_unit_seconds / kStep_s)); ++i) {
      const SupplyParameters& now = unit.supply();
      unit.step(kStep_s,
                std::min(now.pump_flow_m3ps, now.power_limit_w * now.efficiency / pressure_pa),
                pressure_pa);
      least = std::min(least, unit.speed_radps());
    }
    return least;
  }

  PowerUnitParameters parameters;
  SupplyParameters supply;
  PowerUnit unit;
};

/// Torque of the pumps' standby flow at that pressure, and of the auxiliaries.
double idle_load_nm(const Running& running, double pressure_pa, double speed_radps) {
  return running.parameters.auxiliary_nm + running.parameters.stroke_back *
                                               running.supply.pump_flow_m3ps * pressure_pa /
                                               (running.supply.efficiency * speed_radps);
}

TEST(PowerUnit, SettlesWhereTheDroopPutsIt) {
  for (const double flow_m3ps : {0.0, 1e-3, 2e-3, 3e-3}) {
    Running running;
    constexpr double kPressure_pa = 25e6;
    running.run(20.0, flow_m3ps, kPressure_pa);
    const double speed = running.unit.speed_radps();
    const double load_nm = flow_m3ps == 0.0
                               ? idle_load_nm(running, kPressure_pa, speed)
                               : running.parameters.auxiliary_nm +
                                     flow_m3ps * kPressure_pa / (running.supply.efficiency * speed);
    EXPECT_NEAR(running.unit.torque_nm(), load_nm, 1e-3 * load_nm);
    // w = w_set (1 + droop (1 - T / T_ref))
    const double expected =
        running.parameters.set_radps *
        (1.0 + running.parameters.droop *
                   (1.0 - load_nm / running.parameters.engine.greatest_torque_nm()));
    EXPECT_NEAR(speed, expected, 1e-3 * expected) << flow_m3ps;
  }
}

TEST(PowerUnit, SpeedDropsWhenALoadComesAndRecoversToTheDroop) {
  Running running;
  running.run(10.0, 0.0, 2.3e6);
  const double free = running.unit.speed_radps();
  const double least = running.run(10.0, 3e-3, 28e6);
  const double loaded = running.unit.speed_radps();
  EXPECT_LT(least, loaded - rpm(1)) << "below where it settles, for a moment";
  EXPECT_GT(least, rpm(1500));
  EXPECT_GT(free - loaded, rpm(20));
  EXPECT_LT(free - loaded, running.parameters.droop * running.parameters.set_radps);
  running.run(10.0, 0.0, 2.3e6);
  EXPECT_NEAR(running.unit.speed_radps(), free, 1e-6 * free);
}

TEST(PowerUnit, WorkOfTheEngineIsWorkOfTheLoadAndKineticEnergy) {
  Running running;
  const double inertia = running.parameters.engine.inertia_kgm2;
  const double before_j = 0.5 * inertia * std::pow(running.unit.speed_radps(), 2);
  running.run(0.2, 3e-3, 28e6);
  const double after_j = 0.5 * inertia * std::pow(running.unit.speed_radps(), 2);
  EXPECT_NEAR(running.unit.engine_work_j() - running.unit.load_work_j(), after_j - before_j,
              1e-9 * before_j);
}

TEST(PowerUnit, PumpTorqueIsFlowTimesPressureOverSpeed) {
  Running running;
  running.run(5.0, 2e-3, 20e6);
  EXPECT_NEAR(running.unit.pump_torque_nm() * running.unit.speed_radps(),
              2e-3 * 20e6 / running.supply.efficiency, 50.0);
}

TEST(PowerUnit, LimitsOfTheHydraulicsDoNotChangeAtWorkingSpeed) {
  Running running;
  const double least = running.run(5.0, 3e-3, 30e6);  // 100 kW at the shaft
  EXPECT_GT(least, running.parameters.pump_rated_radps);
  EXPECT_EQ(running.unit.supply().pump_flow_m3ps, running.supply.pump_flow_m3ps);
  EXPECT_EQ(running.unit.supply().power_limit_w, running.supply.power_limit_w);
}

TEST(PowerUnit, RequestedSpeedIsReachedAtTheRampAndCutsThePumpsFlow) {
  Running running;
  running.run(5.0, 0.0, 2.3e6);
  running.unit.command({.time = {}, .speed_radps = rpm(1000)});
  running.run(0.5, 0.0, 2.3e6);
  EXPECT_GT(running.unit.speed_radps(), rpm(1400)) << "600 rpm in each second";
  running.run(10.0, 0.0, 2.3e6);
  EXPECT_NEAR(running.unit.speed_radps(), rpm(1000) * 1.038, rpm(15));
  EXPECT_NEAR(running.unit.supply().pump_flow_m3ps,
              running.supply.pump_flow_m3ps * running.unit.speed_radps() /
                  running.parameters.pump_rated_radps,
              1e-9);
  running.unit.command({});
  running.run(10.0, 0.0, 2.3e6);
  EXPECT_GT(running.unit.speed_radps(), rpm(1900)) << "the dial's again";
}

TEST(PowerUnit, PumpsDoNotStallAnEngineThatTurnsSlowly) {
  Running running;
  running.unit.command({.time = {}, .speed_radps = rpm(900)});
  running.run(10.0, 0.0, 2.3e6);
  const double least = running.take_all(10.0, 30e6);
  EXPECT_GT(least, rpm(750));
  EXPECT_LT(running.unit.supply().power_limit_w, 0.6 * running.supply.power_limit_w);
}

TEST(PowerUnit, TorqueLimitHolds) {
  Running running;
  running.unit.command({.time = {}, .speed_radps = {}, .torque_limit_share = 0.3});
  EXPECT_GT(running.take_all(3.0, 28e6), rpm(1800));
  // The limit holds for the torque of the cylinders: friction counts.
  const EngineData data = running.unit.engine_data();
  const EngineSample engine = running.unit.sample().engine;
  EXPECT_LE(engine.torque_nm + engine.friction_nm, 0.3 * data.reference_torque_nm + 0.1);
  EXPECT_GT(engine.torque_nm + engine.friction_nm, 0.25 * data.reference_torque_nm);
  EXPECT_LT(running.unit.supply().power_limit_w, 40e3);
}

TEST(PowerUnit, WhatIsNoNumberChangesNothing) {
  Running running;
  Running other;
  running.unit.command(
      {.time = {}, .speed_radps = std::nan(""), .torque_limit_share = std::nan("")});
  running.run(1.0, 1e-3, 20e6);
  other.run(1.0, 1e-3, 20e6);
  EXPECT_EQ(running.unit.speed_radps(), other.unit.speed_radps());
}

TEST(PowerUnit, RefusesASetSpeedThatTheEngineHasNot) {
  PowerUnitParameters parameters;
  parameters.set_radps = rpm(3000);
  EXPECT_THROW(validate(parameters), std::invalid_argument);
  parameters.set_radps = rpm(500);
  EXPECT_THROW(validate(parameters), std::invalid_argument);
  EXPECT_NO_THROW(validate(PowerUnitParameters{}));
}

}  // namespace
}  // namespace rigwire::sim
