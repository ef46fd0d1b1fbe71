#include "sim/roller/vibration.h"

#include <gtest/gtest.h>

#include <complex>
#include <vector>

#include "roller_rig.h"

namespace rigwire::sim {
namespace {

using namespace test;

// Stands parked and shakes its front drum.
struct Shaking {
  TandemRoller machine;

  Shaking(const Ground& ground, double step_s)
      : machine(with_step(step_s), ground, {0.0, 0.0}, 0.0) {
    VehicleCommand command;
    command.vibration = {true, false};
    machine.command(command);
  }

 private:
  static RollerParameters with_step(double step_s) {
    RollerParameters p = bare();
    p.step_s = step_s;
    return p;
  }
};

// Hard case 27: 49.3 m/s2 for 50 Hz and 0.5 mm, one line in the spectrum.
TEST(RollerVibration, DrumAcceleratesWithAmplitudeTimesOmegaSquaredAndOneLine) {
  const Ground ground = level();
  Shaking shaking(ground, 1e-3);
  TandemRoller& machine = shaking.machine;
  machine.step(2s);
  constexpr int kSamples = 2000;
  std::vector<double> signal(kSamples);
  for (double& value : signal) {
    machine.step(1ms);
    value = machine.links()[3].a_WL_W.z();
  }
  const auto line = [&](int cycles) {
    std::complex<double> sum = 0.0;
    for (int i = 0; i < kSamples; ++i) {
      sum += signal[static_cast<std::size_t>(i)] *
             std::polar(1.0, -2.0 * std::numbers::pi * cycles * i / kSamples);
    }
    return 2.0 * std::abs(sum) / kSamples;
  };
  EXPECT_NEAR(line(100), 0.5e-3 * std::pow(100.0 * std::numbers::pi, 2.0), 1e-6);  // 49.348
  for (int cycles = 1; cycles < 999; cycles += cycles == 99 ? 2 : 7) {
    if (cycles != 100) {
      EXPECT_LT(line(cycles), 1e-6) << cycles;
    }
  }
}

TEST(RollerVibration, PhaseDoesNotDependOnTheStep) {
  const Ground ground = level();
  Shaking shaking_fine(ground, 0.1e-3);
  TandemRoller& fine = shaking_fine.machine;
  Shaking shaking_coarse(ground, 7e-3);
  TandemRoller& coarse = shaking_coarse.machine;
  for (int i = 0; i < 20; ++i) {
    fine.step(101ms);
    coarse.step(101ms);
    EXPECT_NEAR(fine.links()[3].X_WL.translation().z(), coarse.links()[3].X_WL.translation().z(),
                1e-12);
    EXPECT_NEAR(fine.links()[3].a_WL_W.z(), coarse.links()[3].a_WL_W.z(), 1e-7);
  }
}

TEST(RollerVibration, DerivativesAreThoseOfThePositionAlsoOnTheRamp) {
  const double h = 1e-5;
  DrumVibration shaker{VibrationParameters{}};
  shaker.command(true);
  for (const double begin : {0.3, 0.6, 1.5}) {
    DrumVibration before = shaker;
    before.step(begin);
    DrumVibration now = before;
    now.step(h);
    DrumVibration after = now;
    after.step(h);
    const double rate = (after.drum().position_m - before.drum().position_m) / (2.0 * h);
    const double acceleration =
        (after.drum().velocity_mps - before.drum().velocity_mps) / (2.0 * h);
    EXPECT_NEAR(now.drum().velocity_mps, rate, 1e-5) << begin;
    EXPECT_NEAR(now.drum().acceleration_mps2, acceleration, 5e-3) << begin;
  }
}

TEST(RollerVibration, FrameFeelsADampedShareAndEndsAtRest) {
  const Ground ground = level();
  Shaking shaking(ground, 1e-3);
  TandemRoller& machine = shaking.machine;
  machine.step(2s);
  double greatest = 0.0;
  for (int i = 0; i < 100; ++i) {
    machine.step(1ms);
    greatest = std::max(greatest, std::abs(frame(machine).a_WL_W.z()));
  }
  // Half of the front end's 5 % at the frame's origin, half way between the pivots.
  EXPECT_NEAR(greatest, 0.5 * 0.05 * 49.348, 0.01);
  machine.command(VehicleCommand{});
  machine.step(1100ms);
  EXPECT_EQ(machine.links()[3].a_WL_W.z(), frame(machine).a_WL_W.z());
  EXPECT_LT(std::abs(frame(machine).a_WL_W.z()), 1e-9);
}

TEST(RollerVibration, ParkedMachineDoesNotWanderWhileItVibrates) {
  const Ground ground = rising(0.1, 0.8);
  Shaking shaking(ground, 1e-3);
  TandemRoller& machine = shaking.machine;
  machine.step(2s);
  const Eigen::Vector2d before = position(machine).head<2>();
  machine.step(10s);
  EXPECT_LT((position(machine).head<2>() - before).norm(), 1e-5);
}

}  // namespace
}  // namespace rigwire::sim
