#include "sim/contact/bristle.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigwire::sim {
namespace {

TEST(Bristle, SteadyRollingIsASlipLaw) {
  const BristleParameters p{6e5, 2e4, 0.3};
  for (const double h : {1e-4, 1e-3, 1e-2}) {
    Bristle bristle;
    const double speed = 5.0;
    const double slide = 0.1;
    for (int i = 0; i < 20000; ++i) {
      bristle.slide(p, h, speed, slide);
    }
    // F = -k sigma u / |V|, whatever the step.
    EXPECT_NEAR(bristle.force(p, h, speed).at(slide), -6e5 * 0.3 * 0.1 / 5.0, 1e-6);
  }
}

TEST(Bristle, StandingIsASpringWithDamping) {
  const BristleParameters p{1e5, 1e3, 0.3};
  Bristle bristle;
  bristle.slide(p, 0.01, 0.0, 0.2);
  EXPECT_DOUBLE_EQ(bristle.deflection(), 0.002);
  const ImplicitForce force = bristle.force(p, 0.01, 0.0);
  EXPECT_DOUBLE_EQ(force.at(0.0), -200.0);
  EXPECT_DOUBLE_EQ(force.gain, 1e5 * 0.01 + 1e3);
}

TEST(Bristle, ForceIsThatOfTheStepsEnd) {
  // What force() promises for u is what the deflection after slide(u) gives.
  const BristleParameters p{3e5, 5e3, 0.25};
  for (const double speed : {0.0, 0.3, 3.0}) {
    Bristle bristle;
    bristle.slide(p, 0.005, speed, 0.4);
    const double promised = bristle.force(p, 0.002, speed).at(-0.15);
    const double z_before = bristle.deflection();
    bristle.slide(p, 0.002, speed, -0.15);
    const double rate = (bristle.deflection() - z_before) / 0.002;
    EXPECT_NEAR(promised, -(p.stiffness * bristle.deflection() + p.damping * rate), 1e-8) << speed;
  }
}

TEST(Bristle, YieldingHoldsTheLimit) {
  const BristleParameters p{1e5, 1e3, 0.3};
  Bristle bristle;
  bristle.yield(p, -500.0);
  EXPECT_DOUBLE_EQ(bristle.force(p, 1e-3, 0.0).at(0.0), -500.0);
  bristle.reset();
  EXPECT_EQ(bristle.force(p, 1e-3, 0.0).at(0.0), 0.0);
}

// A bristle that yielded with its whole force, the damper's part too, was bent by more than it had
// slid: what was stopped by it came back faster than it came.
TEST(Bristle, YieldingGivesNothingBackThatWasNotPutIn) {
  constexpr double kMass_kg = 1000.0;
  constexpr double kLimit_n = 500.0;
  const double stiffness = 1e6;
  for (const double ratio : {0.1, 0.7, 2.0}) {
    const BristleParameters p{stiffness, 2.0 * ratio * std::sqrt(stiffness * kMass_kg), 0.3};
    for (const double h : {1e-4, 1e-3, 5e-3}) {
      for (const double start : {0.005, 0.012, 0.02, 0.2}) {
        Bristle bristle;
        double u = start;
        double most = 0.5 * kMass_kg * u * u;
        for (int i = 0; i < static_cast<int>(1.0 / h); ++i) {
          // Clamp last.
          const ImplicitForce law = bristle.force(p, h, 0.0);
          const double before = u;
          u = (kMass_kg * before + h * law.offset) / (kMass_kg + h * law.gain);
          if (std::abs(law.at(u)) > kLimit_n) {
            u = before + h * std::copysign(kLimit_n, law.at(u)) / kMass_kg;
            bristle.slide_within(p, h, 0.0, u, kLimit_n);
          } else {
            bristle.slide(p, h, 0.0, u);
          }
          const double z = bristle.deflection();
          const double energy = 0.5 * kMass_kg * u * u + 0.5 * stiffness * z * z;
          ASSERT_LE(energy, most * (1.0 + 1e-12)) << ratio << " " << h << " " << start << " " << i;
          most = energy;
        }
        if (ratio > 0.5) {
          EXPECT_LT(std::abs(u), 1e-3 * start + 1e-6) << ratio << " " << h << " " << start;
        }
      }
    }
  }
}

TEST(Bristle, NeverPushesTheWayItSlides) {
  // At speeds where the damping would turn the spring round, it is reduced instead.
  const BristleParameters p{1e5, 1e5, 0.1};
  Bristle bristle;
  bristle.slide(p, 1e-3, 50.0, 1.0);
  const ImplicitForce force = bristle.force(p, 1e-3, 50.0);
  EXPECT_LE(force.at(0.0), 0.0);
  EXPECT_GE(force.gain, 0.0);
}

}  // namespace
}  // namespace rigwire::sim
