// Whatever is commanded, at whatever step: finite, forward engine, and the energy adds up.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sim/driveline/cvt_driveline.h"
#include "sim/driveline/geared_driveline.h"
#include "spin_bench.h"

namespace rigwire::sim {
namespace {

template <class Parameters>
void drive_at_random(ClutchedDriveline& driveline, const Parameters& p, double wheel_inertia_kgm2,
                     double load_nm, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  test::SpinBench bench(driveline, wheel_inertia_kgm2);
  bench.viscous_nmsprad = 0.02 * load_nm;
  double turned_over_j = 0.0;
  for (int i = 0; i < 20000; ++i) {
    if (i % 200 == 0) {
      VehicleCommand command;
      command.gear = static_cast<int>(std::lround(9.0 * unit(random)));
      command.crawler_group = unit(random) > 0.7;
      command.engine_control = unit(random) > 0.5 ? EngineControl::speed : EngineControl::torque;
      command.engine_torque_share = unit(random);
      command.engine_speed_radps = 300.0 * unit(random);
      command.lock = {unit(random) > 0, unit(random) > 0, unit(random) > 0};
      driveline.command(command);
      for (Eigen::Index wheel = 0; wheel < 4; ++wheel) {
        bench.grip_nm(wheel) = unit(random) > 0.8 ? load_nm * unit(random) * unit(random) : 0.0;
        bench.grip_nm(wheel) = std::max(0.0, bench.grip_nm(wheel));
        bench.load_nm(wheel) = 0.1 * load_nm * unit(random);
      }
    }
    const double h = std::pow(10.0, -3.0 + 1.5 * unit(random));  // 30 us .. 30 ms
    bench.step(h);
    ASSERT_TRUE(bench.rates.allFinite()) << i;
    ASSERT_GE(driveline.engine_speed_radps(), 0.5 * p.engine.idle_radps) << i;
    ASSERT_LE(driveline.engine_speed_radps(), 1e4) << i;
    turned_over_j += std::abs(driveline.clutch_torque_nm()) * driveline.engine_speed_radps() * h;
  }
  const DrivelineEnergy energy = driveline.energy();
  const double idle = p.engine.idle_radps;
  const double engine = driveline.engine_speed_radps();
  const double output = p.axles.ratio() * driveline.shares().dot(bench.rates);
  const double stored = bench.wheel_energy_j() +
                        0.5 * p.engine.inertia_kgm2 * (engine * engine - idle * idle) +
                        0.5 * p.axles.output_inertia_kgm2 * output * output;
  EXPECT_GE(energy.clutch_heat_j, 0.0);
  EXPECT_GE(energy.drag_heat_j, 0.0);
  EXPECT_GE(energy.lock_heat_j, 0.0);
  EXPECT_NEAR(energy.engine_j,
              energy.clutch_heat_j + energy.drag_heat_j + energy.lock_heat_j + bench.load_work_j +
                  bench.pad_heat_j + stored,
              1e-6 * turned_over_j);
}

TEST(RandomCommands, GearedDrivelineStaysFiniteAndBalanced) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const GearedParameters p;
    GearedDriveline driveline{p};
    ASSERT_NO_FATAL_FAILURE(drive_at_random(driveline, p, 33.0, 8000.0, seed)) << seed;
  }
}

TEST(RandomCommands, HeavyVehicleToo) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const GearedParameters p;
    GearedDriveline driveline{p};
    ASSERT_NO_FATAL_FAILURE(drive_at_random(driveline, p, 750.0, 8000.0, seed)) << seed;
  }
}

TEST(RandomCommands, CvtDrivelineStaysFiniteAndBalanced) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const CvtParameters p;
    CvtDriveline driveline{p};
    ASSERT_NO_FATAL_FAILURE(drive_at_random(driveline, p, 30.0, 400.0, seed)) << seed;
  }
}

}  // namespace
}  // namespace rigwire::sim
