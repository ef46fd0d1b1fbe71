#include "sim/driveline/geared_driveline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "allocation_counter.h"
#include "sim/driveline/driveline.h"
#include "spin_bench.h"

namespace rigwire::sim {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
/// Wheel and a quarter of 9 t at 0.565 m.
constexpr double kGearedDrivelineVehicleInertia_kgm2 = 33.0 + 2250.0 * 0.565 * 0.565;

VehicleCommand geared_drive(int gear, double share = 1.0, bool crawler = false) {
  VehicleCommand command;
  command.gear = gear;
  command.engine_torque_share = share;
  command.crawler_group = crawler;
  return command;
}

VehicleSample geared_driveline_read(const Driveline& driveline) {
  VehicleSample sample;
  driveline.read(sample);
  return sample;
}

/// Steps and checks the momentum of what is clutched: engine and wheels feel the same torque.
void checked_step(GearedDriveline& driveline, test::SpinBench& bench, double h) {
  const double engine = driveline.engine_speed_radps();
  const WheelVector rates = bench.rates;
  bench.step(h);
  const double ratio = driveline.overall_ratio();
  const GearedParameters p;
  const double torque_nm = geared_driveline_read(driveline).engine.torque_nm;
  const double wheels = kGearedDrivelineVehicleInertia_kgm2 * (bench.rates - rates).sum() +
                        h * (bench.load_nm.sum() + bench.viscous_nmsprad * bench.rates.sum());
  const double output = p.axles.ratio() * bench.rates.mean();
  const double shafts = p.axles.ratio() * (p.axles.output_inertia_kgm2 * p.axles.ratio() *
                                               (bench.rates - rates).mean() +
                                           h * p.axles.output_drag_nmsprad * output);
  const double engine_impulse =
      h * torque_nm - p.engine.inertia_kgm2 * (driveline.engine_speed_radps() - engine);
  // Impulse on the wheels = ratio times what the engine gave away; none in neutral.
  ASSERT_NEAR(wheels + shafts, ratio * engine_impulse,
              1e-9 * (1.0 + std::abs(ratio) * p.engine.inertia_kgm2 * 250.0));
  ASSERT_GE(driveline.engine_speed_radps(), 0.6 * p.engine.idle_radps);
  // No jump beyond what the clutch's capacity can do in a step.
  const double most =
      (std::abs(ratio) * 1400.0 + 4.0 * 5000.0) / (4.0 * kGearedDrivelineVehicleInertia_kgm2);
  ASSERT_LE((bench.rates - rates).cwiseAbs().maxCoeff(), 1.01 * h * most);
}

TEST(GearShift, AllFourteenGearsUpAndDownUnderLoad) {
  GearedDriveline driveline{GearedParameters{}};
  test::SpinBench bench(driveline, kGearedDrivelineVehicleInertia_kgm2);
  const double h = 0.002;
  bench.load_nm.setConstant(150.0);
  const auto run = [&](int gear, double share, double until_radps, bool rising) {
    driveline.command(geared_drive(gear, share));
    for (int i = 0; i < 60000; ++i) {
      ASSERT_NO_FATAL_FAILURE(checked_step(driveline, bench, h));
      const VehicleSample sample = geared_driveline_read(driveline);
      const bool there = rising ? sample.engine.speed_radps >= until_radps
                                : sample.engine.speed_radps <= until_radps;
      if (sample.gear == gear && !sample.shifting && sample.driveline_engaged && there) {
        break;
      }
    }
    const VehicleSample sample = geared_driveline_read(driveline);
    ASSERT_EQ(sample.gear, gear);
    ASSERT_TRUE(sample.driveline_engaged);
    const double steps = std::abs(gear);
    const double expected = std::copysign(5.2 * std::pow(1.44, 8.0 - steps), gear);
    EXPECT_NEAR(driveline.overall_ratio() / expected, 1.0, 1e-12);
    EXPECT_NEAR(sample.engine.speed_radps / bench.rates.mean() / expected, 1.0, 1e-9);
    EXPECT_NEAR(sample.input_shaft_radps / sample.output_shaft_radps, sample.gear_ratio, 1e-12);
  };
  for (int gear = 1; gear <= 8; ++gear) {
    run(gear, 1.0, gear < 8 ? 215.0 : 190.0, true);
  }
  bench.load_nm.setConstant(800.0);
  for (int gear = 7; gear >= 1; --gear) {
    run(gear, 0.1, 130.0, false);
  }
  // Stop, then backwards.
  bench.load_nm.setZero();
  bench.viscous_nmsprad = 2000.0;
  driveline.command(geared_drive(0, 0.0));
  for (int i = 0; i < 4000; ++i) {
    bench.step(h);
  }
  bench.viscous_nmsprad = 0.0;
  bench.load_nm.setConstant(-150.0);
  for (int gear = -1; gear >= -6; --gear) {
    run(gear, 1.0, 215.0, true);
  }
  bench.load_nm.setConstant(-800.0);
  for (int gear = -5; gear <= -1; ++gear) {
    run(gear, 0.1, 130.0, false);
  }
  EXPECT_LE(bench.worst_solves, 4);
}

TEST(GearShift, CrawlerGroupTurnsTheWheelsOnceIn5808TurnsAndHoldsUnderLoad) {
  GearedDriveline driveline{GearedParameters{}};
  test::SpinBench bench(driveline, kGearedDrivelineVehicleInertia_kgm2);
  VehicleCommand command = geared_drive(1, 0.0, true);
  command.engine_control = EngineControl::speed;
  command.engine_speed_radps = rpm(2200);
  driveline.command(command);
  for (int i = 0; i < 8000; ++i) {
    ASSERT_NO_FATAL_FAILURE(checked_step(driveline, bench, 0.002));
    if (i == 2000) {
      bench.load_nm.setConstant(5000.0);
    }
  }
  const VehicleSample sample = geared_driveline_read(driveline);
  EXPECT_TRUE(sample.crawler_group);
  EXPECT_TRUE(sample.driveline_engaged);
  EXPECT_NEAR(driveline.overall_ratio() / (5.2 * std::pow(1.44, 7) * 87.0), 1.0, 1e-12);
  EXPECT_NEAR(sample.engine.speed_radps, rpm(2200), 1e-3);
  // About 80 m/h, as the maker says.
  EXPECT_NEAR(bench.rates.mean() * 0.565 * 3600.0, 80.7, 0.1);
  EXPECT_NEAR(driveline.clutch_torque_nm() * driveline.overall_ratio(),
              4.0 * 5000.0 + 0.05 * 6.5 * 6.5 * bench.rates.mean(), 1e-3);
}

TEST(GearShift, CrawlerGroupWaitsForStandstill) {
  GearedDriveline driveline{GearedParameters{}};
  test::SpinBench bench(driveline, kGearedDrivelineVehicleInertia_kgm2);
  bench.rates.setConstant(2.0);
  driveline.command(geared_drive(1, 0.3));
  for (int i = 0; i < 3000; ++i) {
    bench.step(0.001);
  }
  ASSERT_EQ(geared_driveline_read(driveline).gear, 1);
  driveline.command(geared_drive(1, 0.3, true));
  for (int i = 0; i < 3000; ++i) {
    bench.step(0.001);
  }
  EXPECT_FALSE(geared_driveline_read(driveline).crawler_group);
  EXPECT_FALSE(geared_driveline_read(driveline).shifting);
  driveline.command(geared_drive(0, 0.0, true));
  bench.viscous_nmsprad = 4000.0;
  for (int i = 0; i < 6000; ++i) {
    bench.step(0.001);
  }
  EXPECT_TRUE(geared_driveline_read(driveline).crawler_group);
}

TEST(GearShift, AGearThatWouldOverspeedTheEngineWaits) {
  GearedDriveline driveline{GearedParameters{}};
  test::SpinBench bench(driveline, kGearedDrivelineVehicleInertia_kgm2);
  bench.rates.setConstant(30.0);
  driveline.command(geared_drive(8, 0.5));
  for (int i = 0; i < 2000; ++i) {
    bench.step(0.001);
  }
  ASSERT_EQ(geared_driveline_read(driveline).gear, 8);
  driveline.command(geared_drive(2, 0.0));
  for (int i = 0; i < 2000; ++i) {
    bench.step(0.001);
  }
  EXPECT_EQ(geared_driveline_read(driveline).gear, 8);
  EXPECT_EQ(geared_driveline_read(driveline).gear_requested, 2);
  driveline.command(geared_drive(-1, 0.0));
  for (int i = 0; i < 2000; ++i) {
    bench.step(0.001);
  }
  EXPECT_EQ(geared_driveline_read(driveline).gear, 8);
}

TEST(GearShift, TakesItsTimesWhateverTheStep) {
  for (const double h : {0.0005, 0.001, 0.005, 0.01}) {
    GearedDriveline driveline{GearedParameters{}};
    test::SpinBench bench(driveline, kGearedDrivelineVehicleInertia_kgm2);
    bench.rates.setConstant(8.0);
    driveline.command(geared_drive(4, 0.5));
    for (int i = 0; i < std::lround(2.0 / h); ++i) {
      bench.step(h);
    }
    ASSERT_EQ(geared_driveline_read(driveline).gear, 4);
    driveline.command(geared_drive(5, 0.5));
    int steps = 0;
    do {
      bench.step(h);
      ++steps;
    } while (geared_driveline_read(driveline).shifting);
    EXPECT_NEAR(steps * h, 0.8, 1.01 * h) << h;
  }
}

TEST(BadCommand, AGearThatDoesNotExistIsReportedAndNotEngaged) {
  GearedDriveline driveline{GearedParameters{}};
  test::SpinBench bench(driveline, kGearedDrivelineVehicleInertia_kgm2);
  driveline.command(geared_drive(2, 0.2));
  for (int i = 0; i < 2000; ++i) {
    bench.step(0.001);
  }
  for (const int gear :
       {9, -7, 125, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()}) {
    driveline.command(geared_drive(gear, 0.2));
    for (int i = 0; i < 100; ++i) {
      bench.step(0.001);
    }
    EXPECT_EQ(geared_driveline_read(driveline).gear, 2);
    EXPECT_EQ(geared_driveline_read(driveline).gear_requested, gear);
    EXPECT_FALSE(geared_driveline_read(driveline).shifting);
  }
  GearedParameters without_crawler;
  without_crawler.gearbox.crawler_factor = 0.0;
  GearedDriveline plain{without_crawler};
  EXPECT_FALSE(plain.has({1, true}));
  EXPECT_TRUE(plain.has({1, false}));
}

TEST(BadCommand, WhatIsNoNumberKeepsTheOldValueAndAbsurdOnesAreClamped) {
  GearedDriveline driveline{GearedParameters{}};
  GearedDriveline twin{GearedParameters{}};
  test::SpinBench bench(driveline, kGearedDrivelineVehicleInertia_kgm2);
  test::SpinBench twin_bench(twin, kGearedDrivelineVehicleInertia_kgm2);
  for (int i = 0; i < 6000; ++i) {
    VehicleCommand bad = geared_drive(1, i % 2 == 0 ? 1e300 : 1.0);
    VehicleCommand good = geared_drive(1, 1.0);
    if (i > 0 && i % 3 == 0) {
      bad.engine_torque_share = kNan;
      bad.engine_speed_radps = kNan;
    }
    if (i > 3000) {
      bad.engine_control = good.engine_control = EngineControl::speed;
      bad.engine_speed_radps = i % 2 == 0 ? std::numeric_limits<double>::max() : 1e6;
      good.engine_speed_radps = rpm(2200);
    }
    driveline.command(bad);
    twin.command(good);
    bench.step(0.001);
    twin_bench.step(0.001);
    ASSERT_EQ(bench.rates, twin_bench.rates) << i;
    ASSERT_TRUE(std::isfinite(driveline.engine_speed_radps()));
  }
}

TEST(BadCommand, RatesThatAreNoNumbersLeaveTheEngineFinite) {
  GearedDriveline driveline{GearedParameters{}};
  driveline.command(geared_drive(1, 1.0));
  WheelVector rates = WheelVector::Constant(kNan);
  for (int i = 0; i < 100; ++i) {
    driveline.begin(0.001, 33.0, rates);
    driveline.accept(0.001, rates);
    driveline.finish(0.001, rates);
  }
  EXPECT_TRUE(std::isfinite(driveline.engine_speed_radps()));
  rates.setConstant(1.0);
  test::SpinBench bench(driveline);
  for (int i = 0; i < 1000; ++i) {
    bench.step(0.001);
    ASSERT_TRUE(bench.rates.allFinite());
  }
}

TEST(BadCommand, AStepWithoutDurationChangesNothing) {
  GearedDriveline driveline{GearedParameters{}};
  driveline.command(geared_drive(3, 1.0));
  WheelVector rates = WheelVector::Constant(3.0);
  const SpinEquations before = driveline.equations();
  for (const double h : {0.0, -1.0, kNan}) {
    driveline.begin(h, 33.0, rates);
    EXPECT_TRUE(driveline.accept(h, rates));
    driveline.finish(h, rates);
  }
  EXPECT_EQ(driveline.equations().torque_nm, before.torque_nm);
  EXPECT_EQ(geared_driveline_read(driveline).engine.speed_radps, rpm(700));
  EXPECT_EQ(geared_driveline_read(driveline).gear, 0);
}

TEST(DrivelineCost, AStepDoesNotAllocate) {
  for (const DrivelineParameters& parameters :
       {DrivelineParameters(GearedParameters{}), DrivelineParameters(CvtParameters{})}) {
    const std::unique_ptr<Driveline> driveline = make_driveline(parameters);
    WheelVector rates = WheelVector::Constant(0.1);
    VehicleSample sample;
    const auto before = rigwire::test::allocations();
    for (int i = 0; i < 5000; ++i) {
      VehicleCommand command = geared_drive(1 + i / 1500, 1.0);
      command.lock = {i % 900 > 400, i % 700 > 300, i % 500 > 200};
      driveline->command(command);
      driveline->begin(0.001, 33.0, rates);
      const SpinEquations& e = driveline->equations();
      rates += 0.001 / 500.0 * e.torque_nm;
      driveline->accept(0.001, rates);
      driveline->finish(0.001, rates);
      driveline->read(sample);
    }
    EXPECT_EQ(rigwire::test::allocations(), before);
    EXPECT_TRUE(std::isfinite(sample.engine.speed_radps));
  }
}

}  // namespace
}  // namespace rigwire::sim
