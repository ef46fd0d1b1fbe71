// The clutch between engine and gearbox: what it loses, and that it does not stall the engine.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/driveline/geared_driveline.h"
#include "spin_bench.h"

namespace rigwire::sim {
namespace {

/// Wheel and a quarter of 9 t at 0.565 m.
constexpr double kVehicleInertia_kgm2 = 33.0 + 2250.0 * 0.565 * 0.565;

VehicleCommand drive(int gear, double share) {
  VehicleCommand command;
  command.gear = gear;
  command.engine_torque_share = share;
  return command;
}

TEST(ClutchEnergy, EngineIsWheelsPlusHeatPlusDragPlusStored) {
  for (const double h : {0.0005, 0.005, 0.02}) {
    const GearedParameters p;
    GearedDriveline driveline{p};
    test::SpinBench bench(driveline, kVehicleInertia_kgm2);
    bench.load_nm.setConstant(140.0);
    for (int i = 0; i < std::lround(20.0 / h); ++i) {
      driveline.command(drive(1 + i / static_cast<int>(std::lround(4.0 / h)), 0.9));
      bench.step(h);
    }
    const DrivelineEnergy energy = driveline.energy();
    const double engine = driveline.engine_speed_radps();
    const double output = p.axles.ratio() * bench.rates.mean();
    const double stored = bench.wheel_energy_j() +
                          0.5 * p.engine.inertia_kgm2 *
                              (engine * engine - p.engine.idle_radps * p.engine.idle_radps) +
                          0.5 * p.axles.output_inertia_kgm2 * output * output;
    EXPECT_GT(energy.clutch_heat_j, 0.0);
    EXPECT_NEAR(energy.engine_j,
                energy.clutch_heat_j + energy.drag_heat_j + bench.load_work_j + stored,
                1e-10 * energy.engine_j)
        << h;
  }
}

TEST(ClutchLaunch, HeatFromRestAtConstantEngineSpeedIsTheEnergyGained) {
  // An engine of very great inertia, hence of constant speed: half of its work is lost.
  GearedParameters p;
  p.engine.inertia_kgm2 = 1e5;
  p.engine.drag_nm = 0.0;
  p.engine.drag_nmsprad = 0.0;
  p.axles.output_inertia_kgm2 = 0.0;
  p.axles.output_drag_nmsprad = 0.0;
  p.clutch.open_radps = 50.0;
  p.clutch.full_radps = 60.0;
  p.engine.torque_lag_s = 0.0;
  GearedDriveline driveline{p};
  test::SpinBench bench(driveline, kVehicleInertia_kgm2);
  driveline.command(drive(3, 0.0));
  for (int i = 0; i < 40000 && !driveline.clutch_sticks(); ++i) {
    bench.step(0.0005);
  }
  ASSERT_TRUE(driveline.clutch_sticks());
  EXPECT_NEAR(driveline.energy().clutch_heat_j / bench.wheel_energy_j(), 1.0, 2e-3);
}

TEST(ClutchStall, BrakingToRestInGearLeavesTheEngineIdling) {
  for (const double h : {0.001, 0.01, 0.05}) {
    GearedDriveline driveline{GearedParameters{}};
    test::SpinBench bench(driveline, kVehicleInertia_kgm2);
    driveline.command(drive(2, 1.0));
    for (int i = 0; i < std::lround(5.0 / h); ++i) {
      bench.step(h);
    }
    ASSERT_TRUE(driveline.clutch_sticks());
    driveline.command(drive(2, 0.0));
    bench.grip_nm.setConstant(12000.0);  // brakes
    for (int i = 0; i < std::lround(4.0 / h); ++i) {
      bench.step(h);
      ASSERT_GT(driveline.engine_speed_radps(), 0.6 * rpm(700));
    }
    EXPECT_NEAR(driveline.engine_speed_radps(), rpm(700), 0.1);
    EXPECT_NEAR(bench.rates.cwiseAbs().maxCoeff(), 0.0, 1e-6);
  }
}

TEST(ClutchStall, AgainstAWallTheEngineSettlesWhereTheClutchTakesItsTorque) {
  // capacity (w - open)/(full - open) = full load, both linear in w: no hum, whatever the step.
  const GearedParameters p;
  const double rise = p.clutch.capacity_nm / (p.clutch.full_radps - p.clutch.open_radps);
  const TorquePoint& low = p.engine.full_load[0];
  const double slope = (p.engine.full_load[1].torque_nm - low.torque_nm) /
                       (p.engine.full_load[1].speed_radps - low.speed_radps);
  const double expected =
      (low.torque_nm - slope * low.speed_radps + rise * p.clutch.open_radps) / (rise - slope);
  for (const double h : {0.0001, 0.001, 0.01, 0.05}) {
    GearedDriveline driveline{p};
    test::SpinBench bench(driveline, kVehicleInertia_kgm2);
    bench.grip_nm.setConstant(1e6);
    driveline.command(drive(1, 1.0));
    for (int i = 0; i < std::lround(6.0 / h); ++i) {
      bench.step(h);
    }
    for (int i = 0; i < 50; ++i) {
      bench.step(h);
      ASSERT_NEAR(driveline.engine_speed_radps(), expected, 1e-6) << h;
    }
  }
}

TEST(ClutchStall, RollingBackwardsInGearDoesNotTurnTheEngineBackwards) {
  GearedDriveline driveline{GearedParameters{}};
  test::SpinBench bench(driveline, kVehicleInertia_kgm2);
  driveline.command(drive(1, 0.0));
  bench.load_nm.setConstant(4000.0);
  for (int i = 0; i < 5000; ++i) {
    bench.step(0.001);
    ASSERT_GT(driveline.engine_speed_radps(), 60.0);
  }
  EXPECT_LT(bench.rates.mean(), -1.0);
}

}  // namespace
}  // namespace rigwire::sim
