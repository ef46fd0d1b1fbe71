// What soil carries, against the tables of the textbooks.
#include "sim/contact/soil_bearing.h"
#include "fields/constants.h"

#include <gtest/gtest.h>

namespace rigwire::sim {
namespace {

SoilParameters soil(double cohesion_pa, double friction_rad) {
  SoilParameters parameters;
  parameters.soft = true;
  parameters.cohesion_pa = cohesion_pa;
  parameters.internal_friction_rad = friction_rad;
  parameters.density_kgpm3 = 1800.0;
  return parameters;
}

// Factors of Vesic's table for 30 degrees: N_c 30.14, N_q 18.40, N_gamma 22.40.
TEST(SoilBearing, SandBearsByCohesionDepthAndWidth) {
  const SoilBearing sand(soil(5e3, 30.0 * kDegree));
  const double weight = 1800.0 * kGravity_mps2;
  EXPECT_NEAR(sand.pressure_pa(0.0, 0.0), 5e3 * 30.14, 50.0);
  EXPECT_NEAR(sand.pressure_pa(0.5, 0.0) - sand.pressure_pa(0.0, 0.0), 0.5 * weight * 18.40, 50.0);
  EXPECT_NEAR(sand.pressure_pa(0.0, 0.8) - sand.pressure_pa(0.0, 0.0), 0.4 * weight * 22.40, 50.0);
}

// Prandtl: 2 + pi times the undrained strength.
TEST(SoilBearing, ClayWithoutFrictionBearsFiveTimesItsCohesion) {
  EXPECT_NEAR(SoilBearing(soil(20e3, 0.0)).pressure_pa(0.0, 1.0), 102.8e3, 50.0);
}

TEST(SoilBearing, HardGroundBearsWhereverItIsPressed) {
  SoilParameters hard;
  EXPECT_EQ(SoilBearing(hard).pressure_pa(0.0, 0.0), 2e6);
  EXPECT_EQ(SoilBearing(hard).pressure_pa(1.0, 3.0), 2e6);
}

// Steeper than any soil is: no factor grows beyond all bounds.
TEST(SoilBearing, StaysFiniteForWhateverAngleTheConfigurationAllows) {
  EXPECT_LT(SoilBearing(soil(1e3, 89.0 * kDegree)).pressure_pa(1.0, 1.0), 20e6);
}

}  // namespace
}  // namespace rigwire::sim
