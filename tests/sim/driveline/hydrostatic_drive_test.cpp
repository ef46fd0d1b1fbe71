#include "sim/driveline/hydrostatic_drive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace rigwire::sim {
namespace {

constexpr double kRadius = 0.61;
constexpr double kStep = 1e-3;

HydrostaticDemand at(double speed_mps, bool divider = false) {
  return {speed_mps, 230.4, divider};
}

// The drive on two drums with inertia each, resisted by constant torques; the machine's part of the
// solve with two unknowns.
struct Bench {
  HydrostaticDrive drive;
  std::array<double, 2> inertia{2000.0, 2000.0};
  std::array<double, 2> resistance{0.0, 0.0};  ///< Viscous, N m s/rad.
  std::array<double, 2> load{0.0, 0.0};        ///< Against forward.
  std::array<double, 2> rate{0.0, 0.0};
  std::array<bool, 2> held{false, false};

  void step(double h) {
    drive.begin(h);
    std::array<double, 2> pressure{};
    std::array<int, 2> side{};
    for (int round = 0; round < 3; ++round) {
      double a = inertia[0] + h * resistance[0];
      double b = 0.0;
      double d = inertia[1] + h * resistance[1];
      double p = inertia[0] * rate[0] - h * load[0];
      double q = inertia[1] * rate[1] - h * load[1];
      for (std::size_t i = 0; i < drive.circuits(); ++i) {
        const HydrostaticCircuit& c = drive.circuit(i);
        const auto& m = c.displacement_m3prad;
        const double gain = side[i] == 0 ? h * c.law.gain : 0.0;
        const double offset =
            h * (side[i] == 0 ? c.law.offset : side[i] * drive.pressure_limit_pa());
        a += gain * m[0] * m[0];
        b += gain * m[0] * m[1];
        d += gain * m[1] * m[1];
        p += offset * m[0];
        q += offset * m[1];
      }
      if (held[0]) {
        a = 1e15;
      }
      const double determinant = a * d - b * b;
      const std::array<double, 2> found{(d * p - b * q) / determinant,
                                        (a * q - b * p) / determinant};
      bool changed = false;
      for (std::size_t i = 0; i < drive.circuits(); ++i) {
        const HydrostaticCircuit& c = drive.circuit(i);
        const double value =
            c.law.at(c.displacement_m3prad[0] * found[0] + c.displacement_m3prad[1] * found[1]);
        const double limit = drive.pressure_limit_pa();
        const int now = value > limit ? 1 : value < -limit ? -1 : 0;
        changed = changed || now != side[i];
        side[i] = now;
        pressure[i] = std::clamp(value, -limit, limit);
      }
      if (!changed || round == 2) {
        rate = found;
        break;
      }
    }
    drive.finish(pressure);
  }

  void run(double seconds, double h = kStep) {
    const int steps = static_cast<int>(std::lround(seconds / h));
    for (int i = 0; i < steps; ++i) {
      step(h);
    }
  }
};

Bench bench(HydrostaticDriveParameters p = {}) {
  return Bench{.drive = HydrostaticDrive(p, kRadius)};
}

TEST(HydrostaticDrive, ReachesItsSetPointLessDroopAndLeakage) {
  HydrostaticDriveParameters p;
  p.leakage_m3pspa = 0.0;
  p.engine_droop = 0.0;
  Bench b = bench(p);
  b.resistance = {500.0, 500.0};
  b.drive.command(at(1.5));
  b.run(60.0);
  EXPECT_NEAR(b.rate[0] * kRadius, 1.5, 1e-4);
  EXPECT_NEAR(b.rate[1], b.rate[0], 1e-12);
  EXPECT_NEAR(b.drive.pressure_pa(), 500.0 * b.rate[0] / p.motor_displacement_m3prad, 1e3);
}

TEST(HydrostaticDrive, SetPointRampsWhateverTheStep) {
  for (const double h : {1e-3, 2e-2}) {
    Bench b = bench();
    b.drive.command(at(2.0));
    b.run(1.0, h);
    EXPECT_NEAR(b.drive.set_point_mps(), 0.8, 1e-12) << h;
    b.run(3.0, h);
    EXPECT_EQ(b.drive.set_point_mps(), 2.0) << h;
  }
}

TEST(HydrostaticDrive, EqualPressureLetsTheDrumThatSlipsTakeTheFlow) {
  HydrostaticDriveParameters p;
  p.leakage_m3pspa = 0.0;
  Bench b = bench(p);
  b.held = {true, false};
  b.resistance = {0.0, 400.0};
  b.drive.command(at(1.0));
  b.run(30.0);
  EXPECT_NEAR(b.rate[0], 0.0, 1e-6);
  EXPECT_NEAR(b.rate[1], b.drive.pump_flow_m3ps() / p.motor_displacement_m3prad, 1e-3);
}

TEST(HydrostaticDrive, FlowDividerHoldsBothDrumsAtOneSpeed) {
  HydrostaticDriveParameters p;
  p.leakage_m3pspa = 0.0;
  Bench b = bench(p);
  b.resistance = {4000.0, 400.0};
  b.drive.command(at(1.0, true));
  b.run(30.0);
  EXPECT_TRUE(b.drive.divided());
  EXPECT_NEAR(b.rate[0], b.rate[1], 1e-3);
  EXPECT_GT(b.rate[0], 0.9 / kRadius);
  b.drive.command(at(1.0, false));
  b.run(30.0);
  EXPECT_NEAR(b.rate[0] * 4000.0, b.rate[1] * 400.0, 1.0);  // Equal torque again.
  EXPECT_GT(b.rate[1], 1.7 / kRadius);
}

TEST(HydrostaticDrive, ReliefValveLimitsTorqueAndLeavesNoWindUp) {
  HydrostaticDriveParameters p;
  p.engine_torque_nm = 1e4;
  Bench b = bench(p);
  b.inertia = {1e7, 1e7};  // Against a wall.
  b.drive.command(at(2.0));
  b.run(60.0);
  EXPECT_EQ(b.drive.pressure_pa(), p.relief_pressure_pa);
  // The wall goes and the lever is put back: no more is stored than the relief pressure holds.
  b.inertia = {2000.0, 2000.0};
  b.rate = {0.0, 0.0};
  b.drive.command(at(0.0));
  double greatest = 0.0;
  for (int i = 0; i < 20000; ++i) {
    b.step(kStep);
    greatest = std::max(greatest, b.rate[0]);
    EXPECT_LE(std::abs(b.drive.pressure_pa()), p.relief_pressure_pa);
  }
  EXPECT_NEAR(b.rate[0], 0.0, 1e-3);
  EXPECT_LT(greatest, 2.0 * 2.0 / kRadius);
}

TEST(HydrostaticDrive, EngineLosesSpeedWithTorqueAndThePumpNeverOverloadsIt) {
  HydrostaticDriveParameters p;
  Bench b = bench(p);
  b.drive.command(at(3.2));
  b.resistance = {2500.0, 2500.0};
  b.run(40.0);
  EXPECT_NEAR(b.drive.engine_torque_share(), 1.0, 1e-2);
  EXPECT_NEAR(b.drive.engine_speed_radps(), p.engine_rated_radps * (1.0 - p.engine_droop), 0.5);
  EXPECT_LT(b.rate[0] * kRadius, 3.0);
  // Power in is power out and leakage.
  const double power = b.drive.pressure_pa() * b.drive.pump_flow_m3ps();
  EXPECT_NEAR(power,
              2.0 * 2500.0 * b.rate[0] * b.rate[0] +
                  p.leakage_m3pspa * std::pow(b.drive.pressure_pa(), 2.0),
              1e-2 * power);
}

TEST(HydrostaticDrive, StiffOilIsNoReasonForASmallStep) {
  HydrostaticDriveParameters p;
  p.bulk_modulus_pa *= 1e4;
  for (const double h : {1e-3, 20e-3}) {
    Bench b = bench(p);
    b.resistance = {300.0, 300.0};
    b.drive.command(at(1.0));
    b.run(20.0, h);
    EXPECT_NEAR(b.rate[0] * kRadius, 1.0, 0.02) << h;
  }
}

TEST(HydrostaticDrive, CreepsUnderLoadByLeakageAlone) {
  const HydrostaticDriveParameters p;
  Bench b = bench(p);
  b.load = {3000.0, 3000.0};
  b.drive.command(at(0.0));
  b.run(60.0);
  const double pressure = 3000.0 / p.motor_displacement_m3prad;
  EXPECT_NEAR(b.rate[0], -p.leakage_m3pspa * pressure / (2.0 * p.motor_displacement_m3prad), 1e-6);
}

TEST(HydrostaticDrive, OpenBypassLetsTheDrumsGo) {
  HydrostaticDriveParameters p;
  p.bypass = true;
  Bench b = bench(p);
  b.load = {-100.0, -100.0};
  b.drive.command(at(-2.0));
  b.run(1.0);
  EXPECT_NEAR(b.rate[0], 100.0 / 2000.0, 1e-12);
  EXPECT_EQ(b.drive.pressure_pa(), 0.0);
}

TEST(HydrostaticDrive, RefusesNumbersThatMakeNoDrive) {
  HydrostaticDriveParameters p;
  p.oil_volume_m3 = 0.0;
  EXPECT_THROW(validate(p), std::invalid_argument);
  p = {};
  p.engine_idle_radps = 300.0;
  EXPECT_THROW(validate(p), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
