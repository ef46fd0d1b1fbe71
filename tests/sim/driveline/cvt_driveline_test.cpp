#include "sim/driveline/cvt_driveline.h"

#include <gtest/gtest.h>

#include <cmath>

#include "spin_bench.h"

namespace rigwire::sim {
namespace {

/// Wheel and a quarter of 1 t at 0.33 m.
constexpr double kCvtDrivelineVehicleInertia_kgm2 = 2.0 + 250.0 * 0.33 * 0.33;

VehicleCommand cvt_driveline_drive(int gear, double share) {
  VehicleCommand command;
  command.gear = gear;
  command.engine_torque_share = share;
  command.lock[1] = true;  // front axle coupled
  return command;
}

VehicleSample read(const Driveline& driveline) {
  VehicleSample sample;
  driveline.read(sample);
  return sample;
}

TEST(BeltVariator, OverallRatioGoesFrom40InLowToSevenPointSixInHigh) {
  CvtDriveline driveline{CvtParameters{}};
  test::SpinBench bench(driveline, kCvtDrivelineVehicleInertia_kgm2);
  driveline.command(cvt_driveline_drive(1, 0.0));
  for (int i = 0; i < 500; ++i) {
    bench.step(0.001);
  }
  EXPECT_NEAR(driveline.overall_ratio(), 40.0, 1e-9);
  EXPECT_EQ(bench.rates.norm(), 0.0);  // the centrifugal clutch is open at idle

  driveline.command(cvt_driveline_drive(2, 0.0));
  for (int i = 0; i < 500; ++i) {
    bench.step(0.001);
  }
  driveline.command(cvt_driveline_drive(2, 1.0));
  bench.load_nm.setConstant(5.0);
  for (int i = 0; i < 20000; ++i) {
    bench.step(0.001);
  }
  EXPECT_NEAR(driveline.overall_ratio(), 7.6, 1e-6);
  EXPECT_TRUE(driveline.clutch_sticks());
  EXPECT_NEAR(read(driveline).engine.speed_radps, 7.6 * bench.rates.mean(), 1e-6);
}

TEST(BeltVariator, TopSpeedIsReachedWhereTheTopRatioMeetsRatedSpeed) {
  // 52 km/h at 3200 rpm on 0.33 m.
  EXPECT_NEAR(rpm(3200) / 7.6 * 0.33 * 3.6, 52.0, 0.5);
}

TEST(BeltVariator, EnergyBalanceHoldsWhileTheRatioMoves) {
  const CvtParameters p;
  CvtDriveline driveline{p};
  test::SpinBench bench(driveline, kCvtDrivelineVehicleInertia_kgm2);
  const double h = 0.001;
  for (int i = 0; i < 15000; ++i) {
    bench.load_nm.setConstant(i < 400 ? 0.0 : 10.0);  // the front axle is in by then, at rest
    driveline.command(cvt_driveline_drive(2, i < 300 ? 0.0 : i < 9000 ? 1.0 : 0.0));
    bench.step(h);
  }
  const DrivelineEnergy energy = driveline.energy();
  const double idle = p.engine.idle_radps;
  const double engine = driveline.engine_speed_radps();
  const double output = p.axles.ratio() * driveline.shares().dot(bench.rates);
  const double stored = bench.wheel_energy_j() +
                        0.5 * p.engine.inertia_kgm2 * (engine * engine - idle * idle) +
                        0.5 * p.axles.output_inertia_kgm2 * output * output;
  EXPECT_NEAR(energy.engine_j,
              energy.clutch_heat_j + energy.drag_heat_j + bench.load_work_j + stored,
              1e-9 * std::abs(energy.engine_j) + 1e-6);
}

TEST(BeltVariator, RangesChangeAtRestWithTheEngineIdlingOnly) {
  CvtDriveline driveline{CvtParameters{}};
  test::SpinBench bench(driveline, kCvtDrivelineVehicleInertia_kgm2);
  driveline.command(cvt_driveline_drive(1, 0.5));
  for (int i = 0; i < 4000; ++i) {
    bench.step(0.001);
  }
  ASSERT_GT(bench.rates.mean(), 1.0);
  for (const int gear : {2, -1}) {
    driveline.command(cvt_driveline_drive(gear, 0.5));
    for (int i = 0; i < 1000; ++i) {
      bench.step(0.001);
    }
    EXPECT_EQ(read(driveline).gear, 1);
    EXPECT_EQ(read(driveline).gear_requested, gear);
    EXPECT_TRUE(read(driveline).shifting);
  }
  driveline.command(cvt_driveline_drive(-1, 0.0));
  bench.grip_nm.setConstant(300.0);
  for (int i = 0; i < 6000; ++i) {
    bench.step(0.001);
  }
  EXPECT_EQ(read(driveline).gear, -1);
  bench.grip_nm.setZero();
  driveline.command(cvt_driveline_drive(-1, 1.0));
  for (int i = 0; i < 2000; ++i) {
    bench.step(0.001);
  }
  EXPECT_LT(bench.rates.mean(), -0.5);
  EXPECT_GT(driveline.engine_speed_radps(), 0.0);
}

TEST(BeltVariator, FrontAxleTurnsWithTheRearWhenSwitchedIn) {
  CvtDriveline driveline{CvtParameters{}};
  test::SpinBench bench(driveline, kCvtDrivelineVehicleInertia_kgm2);
  for (int i = 0; i < 3000; ++i) {
    driveline.command(cvt_driveline_drive(1, i < 400 ? 0.0 : 1.0));
    bench.step(0.001);
    if (i == 400) {
      bench.load_nm << 20.0, 5.0, 5.0, 5.0;
    }
    if (driveline.equations().coordinates == 3) {
      ASSERT_NEAR(bench.rates(0) + bench.rates(1), bench.rates(2) + bench.rates(3), 1e-10);
    }
  }
  EXPECT_TRUE(read(driveline).lock[1]);
  EXPECT_GT(bench.rates(0), 1.0);
}

}  // namespace
}  // namespace rigwire::sim
