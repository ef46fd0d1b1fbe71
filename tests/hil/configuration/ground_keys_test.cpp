// Keys of tyres, soils and of where soils lie.
#include <gtest/gtest.h>

#include <string>

#include "findings_of.h"
#include "sim/ground/soil.h"
#include "sim/tyre/tyre.h"

namespace rigwire::hil {
namespace {

TEST(TyreKeys, UnitsReachTheMembers) {
  sim::TyreParameters tyre;
  EXPECT_EQ(findings_of("unloaded_radius: 330 mm\nreference_pressure: 1.4 bar\n"
                        "carcass_stiffness: 20 kN/m\nslip_stiffness: 60\nrim_radius: 0.18\n",
                        tyre),
            "");
  EXPECT_EQ(tyre.unloaded_radius_m, 0.33);
  EXPECT_EQ(tyre.reference_pressure_pa, 1.4e5);
  EXPECT_EQ(tyre.carcass_stiffness_npm, 2e4);
  EXPECT_EQ(tyre.slip_stiffness_n, 6e4);
}

TEST(TyreKeys, ARimLargerThanTheTyreIsRefused) {
  sim::TyreParameters tyre;
  EXPECT_NE(findings_of("rim_radius: 0.7\n", tyre).find("rim_radius: found 0.7 m, allowed at most"),
            std::string::npos);
}

TEST(TyreKeys, NegativePressureIsRefusedWithItsKey) {
  sim::TyreParameters tyre;
  EXPECT_NE(findings_of("reference_pressure: -2 bar\n", tyre).find("reference_pressure"),
            std::string::npos);
}

TEST(SoilKeys, AnExponentThatNoSoilHasIsRefusedWithItsKey) {
  sim::SoilParameters soil;
  EXPECT_NE(findings_of("exponent: 3\n", soil).find("exponent"), std::string::npos);
  EXPECT_EQ(findings_of("{name: sand, soft: true, cohesion: 2 kPa}\n", soil), "");
  EXPECT_EQ(soil.cohesion_pa, 2000.0);
}

}  // namespace
}  // namespace rigwire::hil
