#include "sim/ground/soil.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace rigwire::sim {
namespace {

constexpr double kTyreWidth_m = 0.395;
constexpr double kTyreDiameter_m = 1.18;

SoilParameters soft_soil(double exponent = 1.1) {
  SoilParameters soil;
  soil.name = "test";
  soil.soft = true;
  soil.exponent = exponent;
  return soil;
}

TEST(Sinkage, IsBekkersRigidWheel) {
  const SoilParameters soil = soft_soil();
  const double expected =
      std::pow(3.0 * 2e4 / (1.9 * (kTyreWidth_m * 2e6) * std::sqrt(kTyreDiameter_m)), 2.0 / 3.2);
  EXPECT_NEAR(wheel_sinkage_m(soil, 2e4, kTyreWidth_m, kTyreDiameter_m), expected, 1e-15);
}

TEST(Sinkage, LoadAndSinkageAreInversesOfEachOther) {
  for (double n = 0.3; n <= 2.0; n += 0.1) {
    const SoilParameters soil = soft_soil(n);
    for (const double load : {1.0, 1e3, 5e4}) {
      const double z = wheel_sinkage_m(soil, load, kTyreWidth_m, kTyreDiameter_m);
      EXPECT_NEAR(wheel_load_n(soil, z, kTyreWidth_m, kTyreDiameter_m), load, 1e-12 * load);
    }
  }
}

TEST(Sinkage, GrowsWithTheLoadForEveryExponent) {
  // Exponents beyond 0.3 .. 2 are used as the nearest of these.
  for (const double n : {0.1, 0.3, 0.6, 1.0, 1.1, 1.6, 2.0, 2.9}) {
    const SoilParameters soil = soft_soil(n);
    double before = 0.0;
    for (double load = 1.0; load < 1e6; load *= 1.5) {
      const double z = wheel_sinkage_m(soil, load, kTyreWidth_m, kTyreDiameter_m);
      EXPECT_GT(z, before) << n << ", " << load;
      before = z;
    }
  }
}

TEST(Sinkage, OfAPlateCarriesItsPressure) {
  SoilParameters soil = soft_soil(0.8);
  soil.cohesion_modulus = 5e4;
  const double z = plate_sinkage_m(soil, 1.4e5, kTyreWidth_m);
  EXPECT_NEAR((5e4 / kTyreWidth_m + 2e6) * std::pow(z, 0.8), 1.4e5, 1e-6);
}

TEST(Sinkage, IsNothingOnHardGroundOrWithoutLoad) {
  EXPECT_EQ(wheel_sinkage_m(SoilParameters{}, 1e5, kTyreWidth_m, kTyreDiameter_m), 0.0);
  EXPECT_EQ(wheel_sinkage_m(soft_soil(), 0.0, kTyreWidth_m, kTyreDiameter_m), 0.0);
  EXPECT_EQ(wheel_sinkage_m(soft_soil(), -1.0, kTyreWidth_m, kTyreDiameter_m), 0.0);
  EXPECT_EQ(compaction_resistance_n(SoilParameters{}, 0.1, kTyreWidth_m), 0.0);
}

TEST(Compaction, IsTheWorkOfTheRutPerMetre) {
  // R_c is the work of pressing a plate of width b down to z, per metre of rut: integrate p b dz.
  const SoilParameters soil = soft_soil(1.3);
  double work = 0.0;
  const int pieces = 20'000;
  for (int i = 0; i < pieces; ++i) {
    work += 2e6 * std::pow(0.1 * (i + 0.5) / pieces, 1.3) * kTyreWidth_m * 0.1 / pieces;
  }
  EXPECT_NEAR(compaction_resistance_n(soil, 0.1, kTyreWidth_m), work, 1e-6 * work);
}

TEST(Shear, ShareGoesOverIntoItsSeriesWithoutAStep) {
  const SoilParameters soil = soft_soil();
  const double length = 0.3;
  EXPECT_EQ(shear_share(soil, 0.0, length), 0.0);
  EXPECT_EQ(shear_share(soil, 0.5, 0.0), 0.0);
  // Limit s l / (2 K).
  EXPECT_NEAR(shear_share(soil, 1e-9, length) / (1e-9 * length / 0.02), 1.0, 1e-7);
  // Both sides of the change of formula at s l / K = 0.01, against extended precision.
  for (const double x : {1e-6, 0.0099, 0.0101, 0.1, 5.0, 100.0}) {
    const long double reference = 1.0L + std::expm1(-static_cast<long double>(x)) / x;
    EXPECT_NEAR(shear_share(soil, -x * 0.01 / length, length), static_cast<double>(reference),
                1e-13)
        << x;
  }
  EXPECT_NEAR(shear_share(soil, 1.0, 1e9), 1.0, 1e-9);
}

TEST(Shear, LimitIsTheLeastOfSoilAndRubber) {
  SoilParameters soil = soft_soil();
  soil.cohesion_pa = 2e4;
  soil.internal_friction_rad = 0.4;
  EXPECT_NEAR(shear_limit_n(soil, 1e4, 0.1), 2e3 + 1e4 * std::tan(0.4), 1e-9);
  EXPECT_NEAR(shear_limit_n(soil, 1e4, 1.0), 0.8e4, 1e-9);
  EXPECT_EQ(shear_limit_n(soil, 0.0, 1.0), 0.0);  // nothing lifts off and still holds
  EXPECT_NEAR(shear_limit_n(SoilParameters{}, 1e4, 0.1), 0.8e4, 1e-9);
}

TEST(SoilParameters, BadOnesAreRefusedByName) {
  EXPECT_NO_THROW(validate(SoilParameters{}));
  const auto refused = [](auto&& spoil, const char* member) {
    SoilParameters soil = soft_soil();
    spoil(soil);
    try {
      validate(soil);
      ADD_FAILURE() << member;
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(std::string(error.what()).find(member), 0u) << error.what();
    }
  };
  refused([](SoilParameters& s) { s.friction = -0.1; }, "friction: found -0.1, allowed 0 .. 2");
  refused([](SoilParameters& s) { s.exponent = 2.5; }, "exponent: found 2.5, allowed 0.3 .. 2");
  refused([](SoilParameters& s) { s.friction_modulus = 0.0; },
          "friction_modulus: found 0, allowed 1e-06 .. 1000000000000");
  refused([](SoilParameters& s) { s.shear_modulus_m = 0.0; },
          "shear_modulus: found 0 mm, allowed 0.001 .. 1000 mm");
  refused([](SoilParameters& s) { s.internal_friction_rad = std::numbers::pi / 2.0; },
          "internal_friction: found 90 deg, allowed 0 .. 89 deg");
  refused([](SoilParameters& s) { s.cohesion_pa = std::numeric_limits<double>::quiet_NaN(); },
          "cohesion: found nan kPa, allowed 0 .. 1000000 kPa");
}

TEST(SinkageCurve, FollowsTheVirginCurveBeyondWhatWasPressed) {
  const SoilParameters soil = soft_soil();
  const double pressed = 0.06;
  const double pressed_load = wheel_load_n(soil, pressed, kTyreWidth_m, kTyreDiameter_m);
  const SinkageCurve curve(soil, kTyreWidth_m, kTyreDiameter_m, 1e9, pressed);
  for (const double load : {1.0001 * pressed_load, 2.0 * pressed_load, 10.0 * pressed_load}) {
    EXPECT_NEAR(curve.at(load).sinkage_m,
                wheel_sinkage_m(soil, load, kTyreWidth_m, kTyreDiameter_m), 1e-12);
  }
  // Less load: Wong's line, k_u = A_u z_u on the wheel's contact.
  const double k = kTyreWidth_m * std::sqrt(kTyreDiameter_m * pressed) * 5e8 * pressed;
  EXPECT_NEAR(curve.at(0.5 * pressed_load).sinkage_m, pressed - 0.5 * pressed_load / k, 1e-12);
  EXPECT_NEAR(curve.at(0.5 * pressed_load).slope_mpn, 1.0 / k, 1e-18);
  EXPECT_NEAR(curve.at(0.0).sinkage_m, pressed - pressed_load / k, 1e-12);
}

TEST(SinkageCurve, GrowsWithTheLoadFromARutThatIsNeverAboveTheGround) {
  for (const double n : {0.3, 0.5, 1.1, 2.0}) {
    SoilParameters soil = soft_soil();
    soil.exponent = n;
    soil.reload_growth = 0.0;  // as weak as may be
    for (const double flat_pa : {5e4, 1e9}) {
      for (const double pressed : {0.0, 1e-6, 0.05, 0.5}) {
        const SinkageCurve curve(soil, kTyreWidth_m, kTyreDiameter_m, flat_pa, pressed);
        double before = curve.at(0.0).sinkage_m;
        EXPECT_GE(before, 0.0);
        for (double load = 1.0; load < 1e6; load *= 1.1) {
          const SinkageCurve::Point point = curve.at(load);
          EXPECT_GE(point.sinkage_m, before - 1e-15);
          EXPECT_GE(point.slope_mpn, 0.0);
          before = point.sinkage_m;
        }
      }
    }
  }
}

TEST(CompactionResistance, OfASecondPassIsWhatTheFirstLeft) {
  const SoilParameters soil = soft_soil();
  const double whole = compaction_resistance_n(soil, 0.1, kTyreWidth_m);
  EXPECT_EQ(compaction_resistance_n(soil, 0.1, 0.0, kTyreWidth_m), whole);
  EXPECT_NEAR(compaction_resistance_n(soil, 0.1, 0.06, kTyreWidth_m),
              whole - compaction_resistance_n(soil, 0.06, kTyreWidth_m), 1e-9 * whole);
  EXPECT_EQ(compaction_resistance_n(soil, 0.1, 0.1, kTyreWidth_m), 0.0);
  EXPECT_EQ(compaction_resistance_n(soil, 0.1, 0.2, kTyreWidth_m), 0.0);
}

}  // namespace
}  // namespace rigwire::sim
