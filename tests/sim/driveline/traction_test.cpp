// One wheel on ice: what open and locked differentials pull.

#include <gtest/gtest.h>

#include "sim/driveline/geared_driveline.h"
#include "spin_bench.h"

namespace rigwire::sim {
namespace {

constexpr double kLoad_n = 22e3;
constexpr double kRadius_m = 0.565;
constexpr double kIce_nm = 0.05 * kLoad_n * kRadius_m;
constexpr double kDry_nm = 0.8 * kLoad_n * kRadius_m;
constexpr double kStep_s = 0.002;

VehicleCommand pull(const std::array<bool, 3>& lock) {
  VehicleCommand command;
  command.gear = 1;
  command.engine_torque_share = 1.0;
  command.lock = lock;
  return command;
}

double balance_j(const GearedDriveline& driveline, const test::SpinBench& bench) {
  const GearedParameters p;
  const DrivelineEnergy energy = driveline.energy();
  const double idle = p.engine.idle_radps;
  const double engine = driveline.engine_speed_radps();
  const double output = p.axles.ratio() * driveline.shares().dot(bench.rates);
  const double stored = bench.wheel_energy_j() +
                        0.5 * p.engine.inertia_kgm2 * (engine * engine - idle * idle) +
                        0.5 * p.axles.output_inertia_kgm2 * output * output;
  return energy.engine_j - energy.clutch_heat_j - energy.drag_heat_j - bench.pad_heat_j -
         bench.load_work_j - stored;
}

/// Sum of the pads' torques against the wheels after 8 s at full throttle.
double traction_nm(AxleDrive drive, const std::array<bool, 3>& lock, const WheelVector& grip_nm) {
  GearedParameters p;
  p.axles.drive = drive;
  if (drive == AxleDrive::rear) {
    p.axles.lockable[1] = false;
  }
  GearedDriveline driveline(p);
  driveline.command(pull(lock));
  test::SpinBench bench(driveline);
  bench.grip_nm = grip_nm;
  for (int i = 0; i < 4000; ++i) {
    bench.step(kStep_s);
  }
  EXPECT_NEAR(balance_j(driveline, bench), 0.0, 1e-9 * driveline.energy().engine_j);
  EXPECT_GT(bench.pad_heat_j, 0.0);
  return -bench.pad_nm.sum();
}

TEST(TractionOnIce, OpenAxlePullsTwiceTheIcyWheel) {
  const WheelVector grip(0.0, 0.0, kIce_nm, kDry_nm);
  EXPECT_NEAR(traction_nm(AxleDrive::rear, {}, grip), 2.0 * kIce_nm, 1e-3 * kIce_nm);
}

TEST(TractionOnIce, LockedAxlePullsTheSumOfBoth) {
  const WheelVector grip(0.0, 0.0, kIce_nm, kDry_nm);
  EXPECT_NEAR(traction_nm(AxleDrive::rear, {false, false, true}, grip), kIce_nm + kDry_nm, 1e-6);
}

TEST(TractionOnIce, ThreeOpenDifferentialsPullFourTimesTheIcyWheel) {
  const WheelVector grip(kDry_nm, kDry_nm, kIce_nm, kDry_nm);
  EXPECT_NEAR(traction_nm(AxleDrive::centre_differential, {}, grip), 4.0 * kIce_nm, 1e-3 * kIce_nm);
}

TEST(TractionOnIce, CentreLockAddsTheFrontAxle) {
  // Rear axle gives twice the ice, front axle what it holds: it slides at its grip.
  const WheelVector grip(kDry_nm, kDry_nm, kIce_nm, kDry_nm);
  EXPECT_NEAR(traction_nm(AxleDrive::centre_differential, {false, true, false}, grip),
              2.0 * kDry_nm + 2.0 * kIce_nm, 2e-2 * kIce_nm);
}

TEST(TractionOnIce, AllLocksPullTheSumOfAll) {
  const WheelVector grip(kDry_nm, kDry_nm, kIce_nm, kDry_nm);
  EXPECT_NEAR(traction_nm(AxleDrive::centre_differential, {true, true, true}, grip),
              3.0 * kDry_nm + kIce_nm, 1e-6);
}

TEST(AllLocksOn, RatesAreEqualUnderUnequalLoadsAndPartAgainWhenOpened) {
  GearedDriveline driveline{GearedParameters{}};
  driveline.command(pull({true, true, true}));
  test::SpinBench bench(driveline, 700.0);
  bench.load_nm << 100.0, 900.0, -300.0, 500.0;
  for (int i = 0; i < 3000; ++i) {
    bench.step(kStep_s);
    if (driveline.equations().coordinates == 1) {
      ASSERT_NEAR(bench.rates.maxCoeff(), bench.rates.minCoeff(), 1e-12);
    }
  }
  EXPECT_EQ(driveline.equations().coordinates, 1);

  // Opened: each wheel's deceleration differs from the mean by its own load alone.
  driveline.command(pull({}));
  bench.step(kStep_s);
  EXPECT_EQ(driveline.equations().coordinates, 4);
  const WheelVector first = bench.rates;
  bench.step(kStep_s);
  const WheelVector change = bench.rates - first;
  const double mean_load = bench.load_nm.mean();
  for (Eigen::Index i = 0; i < 4; ++i) {
    EXPECT_NEAR(change(i) - change.mean(), -kStep_s * (bench.load_nm(i) - mean_load) / 700.0,
                1e-12);
  }
}

TEST(LockOnASpinningWheel, WaitsUntilTheDriverLetsItSlow) {
  GearedDriveline driveline{GearedParameters{}};
  driveline.command(pull({}));
  test::SpinBench bench(driveline);
  bench.grip_nm << kDry_nm, kDry_nm, kIce_nm, kDry_nm;
  for (int i = 0; i < 2000; ++i) {
    bench.step(kStep_s);
  }
  ASSERT_GT(bench.rates(2), 5.0);
  driveline.command(pull({false, false, true}));
  VehicleSample sample;
  for (int i = 0; i < 1000; ++i) {
    bench.step(kStep_s);
  }
  driveline.read(sample);
  EXPECT_FALSE(sample.lock[2]);
  VehicleCommand coast = pull({false, false, true});
  coast.engine_torque_share = 0.0;
  coast.gear = 0;
  driveline.command(coast);
  for (int i = 0; i < 3000; ++i) {
    bench.step(kStep_s);
  }
  driveline.read(sample);
  EXPECT_TRUE(sample.lock[2]);
}

}  // namespace
}  // namespace rigwire::sim
