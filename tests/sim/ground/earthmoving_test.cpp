#include "sim/ground/earthmoving.h"
#include "fields/constants.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace rigwire::sim {
namespace {

double cot(double angle) {
  return std::cos(angle) / std::sin(angle);
}

/// The textbook's form, at any failure angle.
EarthmovingFactors at_angle(double phi, double delta, double rho, double beta) {
  const double den = std::cos(rho + delta) + std::sin(rho + delta) * cot(beta + phi);
  EarthmovingFactors f;
  f.weight = (cot(rho) + cot(beta)) / (2.0 * den);
  f.cohesion = (1.0 + cot(beta) * cot(beta + phi)) / den;
  f.surcharge = 2.0 * f.weight;
  f.adhesion = (1.0 - cot(rho) * cot(beta + phi)) / den;
  f.failure_angle_rad = beta;
  return f;
}

TEST(Earthmoving, SmoothUprightBladeFeelsRankinesPassivePressure) {
  for (const double degrees : {5.0, 15.0, 30.0, 40.0}) {
    const double phi = degrees * kDegree;
    const EarthmovingFactors f = earthmoving_factors(phi, 0.0, 90.0 * kDegree);
    const double tangent = std::tan(45.0 * kDegree + 0.5 * phi);
    EXPECT_NEAR(f.weight, 0.5 * tangent * tangent, 1e-12) << degrees;
    EXPECT_NEAR(f.surcharge, tangent * tangent, 1e-12) << degrees;
    EXPECT_NEAR(f.cohesion, 2.0 * tangent, 1e-12) << degrees;
    EXPECT_NEAR(f.failure_angle_rad, 45.0 * kDegree - 0.5 * phi, 1e-12) << degrees;
  }
}

TEST(Earthmoving, RoughInclinedBladeHasThePublishedFactors) {
  const EarthmovingFactors f = earthmoving_factors(30 * kDegree, 20 * kDegree, 60 * kDegree);
  EXPECT_NEAR(f.weight, 1.555, 5e-4);
  EXPECT_NEAR(f.cohesion, 2.708, 5e-4);
  EXPECT_NEAR(f.failure_angle_rad / kDegree, 29.5, 0.05);
}

TEST(Earthmoving, ClosedFormIsTheLeastOfAFineGridBetweenThePoles) {
  for (double phi = 2.0; phi <= 50.0; phi += 8.0) {
    for (double delta = 0.0; delta <= phi; delta += 7.0) {
      for (double rho = 6.0; rho + delta + phi < 159.0; rho += 11.0) {
        const EarthmovingFactors f =
            earthmoving_factors(phi * kDegree, delta * kDegree, rho * kDegree);
        const double last = (180.0 - rho - delta - phi) * kDegree;  // den = 0 there.
        double least = std::numeric_limits<double>::infinity();
        for (int i = 1; i < 2000; ++i) {
          const EarthmovingFactors g =
              at_angle(phi * kDegree, delta * kDegree, rho * kDegree, last * i / 2000.0);
          least = std::min(least, g.weight);
        }
        const EarthmovingFactors same =
            at_angle(phi * kDegree, delta * kDegree, rho * kDegree, f.failure_angle_rad);
        EXPECT_LE(f.weight, least * (1.0 + 1e-12)) << phi << ' ' << delta << ' ' << rho;
        EXPECT_NEAR(f.weight / least, 1.0, 1e-3) << phi << ' ' << delta << ' ' << rho;
        EXPECT_NEAR(f.weight / same.weight, 1.0, 1e-11);
        EXPECT_NEAR(f.cohesion / same.cohesion, 1.0, 1e-11);
        EXPECT_NEAR(f.adhesion, std::max(0.0, same.adhesion), 1e-10 * (1.0 + f.weight));
      }
    }
  }
}

TEST(Earthmoving, EveryAngleGivesFinitePositiveFactors) {
  for (double phi = -200.0; phi <= 200.0; phi += 12.5) {
    for (double delta = -200.0; delta <= 200.0; delta += 12.5) {
      for (double rho = -200.0; rho <= 400.0; rho += 12.5) {
        const EarthmovingFactors f =
            earthmoving_factors(phi * kDegree, delta * kDegree, rho * kDegree);
        ASSERT_TRUE(std::isfinite(f.weight) && f.weight > 0.0) << phi << ' ' << delta << ' ' << rho;
        ASSERT_TRUE(std::isfinite(f.cohesion) && f.cohesion > 0.0);
        ASSERT_TRUE(std::isfinite(f.adhesion) && f.adhesion >= 0.0);
        ASSERT_GT(f.failure_angle_rad, 0.0);
        ASSERT_LT(f.failure_angle_rad, std::numbers::pi);
      }
    }
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isfinite(earthmoving_factors(nan, nan, nan).weight));
}

TEST(Earthmoving, FactorsDoNotJumpWhereTheRangeEnds) {
  double before = earthmoving_factors(30 * kDegree, 20 * kDegree, 0.0).weight;
  for (double rho = 0.0; rho <= 180.0; rho += 0.05) {
    const double now = earthmoving_factors(30 * kDegree, 20 * kDegree, rho * kDegree).weight;
    EXPECT_LT(std::abs(now - before), 0.02 * before) << rho;
    before = now;
  }
}

TEST(Earthmoving, ForceVanishesWithTheDepthAndGrowsWithIt) {
  SoilParameters soil;
  soil.density_kgpm3 = 1700.0;
  soil.cohesion_pa = 3000.0;
  soil.adhesion_pa = 500.0;
  const EarthmovingFactors f =
      earthmoving_factors(soil.internal_friction_rad, soil.tool_friction_rad, 50 * kDegree);
  EXPECT_EQ(earthmoving_force_n(soil, f, 0.0, 1.1, 0.0, 9.81), 0.0);
  EXPECT_EQ(earthmoving_force_n(soil, f, -0.2, 1.1, 1e4, 9.81), 0.0);
  EXPECT_EQ(earthmoving_force_n(soil, f, std::nan(""), 1.1, 1e4, 9.81), 0.0);
  double before = 0.0;
  for (double depth = 0.05; depth < 2.0; depth += 0.05) {
    const double force = earthmoving_force_n(soil, f, depth, 1.1, 1000.0, 9.81);
    EXPECT_GT(force, before);
    before = force;
  }
  const double expected = (1700.0 * 9.81 * 0.16 * f.weight + 3000.0 * 0.4 * f.cohesion +
                           1000.0 * 0.4 * f.surcharge + 500.0 * 0.4 * f.adhesion) *
                          1.1;
  EXPECT_NEAR(earthmoving_force_n(soil, f, 0.4, 1.1, 1000.0, 9.81), expected, 1e-9 * expected);
}

}  // namespace
}  // namespace rigwire::sim
