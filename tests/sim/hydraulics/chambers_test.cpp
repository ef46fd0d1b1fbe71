#include "sim/hydraulics/chambers.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigwire::sim {
namespace {

constexpr double kRelief_pa = 35e6;
constexpr double kTank_pa = 0.3e6;
constexpr double kBottom_m2 = 2.077e-2;
constexpr double kRodSide_m2 = 1.072e-2;

ActuatorChambers boom() {
  ActuatorChambers chambers({}, {kBottom_m2, kRodSide_m2, 1.49, 2.54}, 0.0);
  chambers.set_pressures({20e6, 5e6});
  return chambers;
}

const ValveDemand kClosed{0.0, false, 30e6, kTank_pa, kRelief_pa};

// Finding: at 20 ms a chamber reached 60.5 MPa behind a relief valve of 35.
TEST(ActuatorChambers, NoStepLeavesMorePressureThanTheReliefValveLets) {
  for (const double h : {1e-4, 1e-3, 5e-3, 2e-2, 0.1}) {
    for (const double rate : {-0.05, -0.3, -2.0, 0.3, 2.0}) {
      ActuatorChambers chambers = boom();
      for (int i = 0; i < 20; ++i) {
        (void)chambers.law(h, 1.6, kClosed);
        chambers.settle(rate);
        // The valve's own rise: what the piston displaces over its conductance.
        const double rise = kBottom_m2 * std::abs(rate) / 5e-9;
        EXPECT_LE(chambers.pressures().a_pa, kRelief_pa + rise) << h << ", " << rate;
        EXPECT_LE(chambers.pressures().b_pa, kRelief_pa + rise) << h << ", " << rate;
        EXPECT_GE(chambers.pressures().a_pa, kTank_pa - rise) << h << ", " << rate;
        EXPECT_GE(chambers.pressures().b_pa, kTank_pa - rise) << h << ", " << rate;
      }
    }
  }
}

TEST(ActuatorChambers, LongStepsEndWhereShortOnesDo) {
  const auto after = [](double h) {
    ActuatorChambers chambers = boom();
    for (int i = 0; i < std::lround(0.2 / h); ++i) {
      (void)chambers.law(h, 1.6, kClosed);
      chambers.settle(-0.3);
    }
    return chambers.pressures().a_pa;
  };
  // At rest with the valve: relief + A u / G.
  EXPECT_NEAR(after(1e-4), kRelief_pa + kBottom_m2 * 0.3 / 5e-9, 1e3);
  EXPECT_NEAR(after(2e-2), after(1e-4), 1e4);
}

TEST(ActuatorChambers, LimitsHoldTheForceMeanwhile) {
  ActuatorChambers chambers = boom();
  const ImplicitForce law = chambers.law(2e-2, 1.6, kClosed);
  const auto [least, greatest] = chambers.limits(kClosed, -0.3);
  EXPECT_GT(law.at(-2.0), greatest);  // the oil alone would be harder than its valve
  EXPECT_NEAR(greatest,
              kBottom_m2 * (kRelief_pa + kBottom_m2 * 0.3 / 5e-9) - kRodSide_m2 * kTank_pa, 1.0);
  EXPECT_LT(least, -kRodSide_m2 * (kRelief_pa - kTank_pa));
}

}  // namespace
}  // namespace rigwire::sim
