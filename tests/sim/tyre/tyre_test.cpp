#include "sim/tyre/tyre.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace rigwire::sim {
namespace {

constexpr double kRoad_pa = 4.5e5;
constexpr double kField_pa = 1.2e5;

WheelContact pressed(double depth_m) {
  WheelContact contact;
  contact.depth_m = depth_m;
  return contact;
}

SoilParameters tyre_soft_soil(double exponent = 1.1) {
  SoilParameters soil;
  soil.soft = true;
  soil.exponent = exponent;
  return soil;
}

/// Vertical stiffness of a radial tyre after T. B. Rhyne (Tire Science and Technology 33, 2005): p
/// in Pa, section width and rim diameter in metres, aspect ratio in per cent. Quoted from memory of
/// the paper in the project's research; plausible, not checked against a tyre.
double rhyne_stiffness_npm(double pressure_pa, double width_m, double aspect_ratio,
                           double rim_diameter_m) {
  // In mm: kg/mm = 0.00028 p[kPa] sqrt((1.03 - 0.004 AR) w (w AR / 50 + D)) + 3.45.
  const double width_mm = 1e3 * width_m;
  const double round = (1.03 - 0.004 * aspect_ratio) * width_mm *
                       (width_mm * aspect_ratio / 50.0 + 1e3 * rim_diameter_m);
  return 1e3 * 9.80665 * (0.00028 * (1e-3 * pressure_pa) * std::sqrt(round) + 3.45);
}

TEST(TyreStiffness, OfThe395Of85R20FollowsRhyne) {
  EXPECT_NEAR(rhyne_stiffness_npm(kRoad_pa, 0.395, 85.0, 0.508), 7.34e5, 1e3);
  EXPECT_NEAR(rhyne_stiffness_npm(kField_pa, 0.395, 85.0, 0.508), 2.21e5, 1e3);
  const Tyre tyre({}, 2200.0);
  for (const double pressure : {kField_pa, 2e5, kRoad_pa}) {
    EXPECT_NEAR(tyre.stiffness_npm(pressure), rhyne_stiffness_npm(pressure, 0.395, 85.0, 0.508),
                1.5e3);
  }
}

TEST(TyreSpring, BottomsOnTheRim) {
  const Tyre tyre({}, 2200.0);
  const double k = tyre.stiffness_npm(kRoad_pa);
  const double to_rim = 0.590 - 0.254;
  EXPECT_DOUBLE_EQ(tyre.spring(0.1, nullptr, kRoad_pa).force_n, 0.1 * k);
  EXPECT_NEAR(tyre.spring(to_rim + 0.01, nullptr, kRoad_pa).force_n,
              k * (to_rim + 0.01) + 5.0 * k * 0.01, 1e-6);
  EXPECT_NEAR(tyre.spring(to_rim + 0.01, nullptr, kRoad_pa).slope_npm, 6.0 * k, 1e-6);
}

TEST(TyreSpring, OnSoftSoilTyreAndSoilCarryTheSameLoad) {
  const Tyre tyre({}, 2200.0);
  for (const double n : {0.3, 0.6, 1.0, 1.1, 1.6, 2.0}) {
    const SoilParameters soil = tyre_soft_soil(n);
    double before = -1.0;
    for (double overlap = 1e-5; overlap < 0.5; overlap *= 1.3) {
      const TyreSpring spring = tyre.spring(overlap, &soil, kRoad_pa);
      const double of_tyre = tyre.spring(overlap - spring.sinkage_m, nullptr, kRoad_pa).force_n;
      EXPECT_NEAR(spring.force_n, of_tyre, 1e-9 + 1e-12 * of_tyre);
      const double of_soil = wheel_sinkage_m(soil, spring.force_n, 0.395, 1.18);
      const double flat = plate_sinkage_m(soil, kRoad_pa + 3.4e4 / 1.555, 0.395);
      EXPECT_NEAR(spring.sinkage_m, std::min(of_soil, flat), 1e-10) << n << ", " << overlap;
      EXPECT_GT(spring.force_n, before);
      before = spring.force_n;
      // The slope is the derivative.
      const double e = 1e-6 * overlap;
      const double secant = (tyre.spring(overlap + e, &soil, kRoad_pa).force_n -
                             tyre.spring(overlap - e, &soil, kRoad_pa).force_n) /
                            (2.0 * e);
      if (overlap > 1e-3 && std::abs(of_soil - flat) > 1e-3) {
        EXPECT_NEAR(spring.slope_npm, secant, 1e-4 * secant) << n << ", " << overlap;
      }
    }
  }
}

TEST(TyreSpring, LowPressureSinksLess) {
  const Tyre tyre({}, 2200.0);
  const SoilParameters soil = tyre_soft_soil();
  // Under the same load.
  const auto sinkage_under = [&](double load, double pressure) {
    double low = 0.0;
    double high = 1.0;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (tyre.spring(middle, &soil, pressure).force_n < load ? low : high) = middle;
    }
    return tyre.spring(low, &soil, pressure).sinkage_m;
  };
  EXPECT_LT(sinkage_under(3e4, kField_pa), 0.7 * sinkage_under(3e4, kRoad_pa));
}

TEST(TyreContact, AreaTimesGroundPressureIsTheLoad) {
  const Tyre tyre({}, 2200.0);
  for (const double pressure : {kField_pa, kRoad_pa}) {
    const double deflection = 2.2e4 / tyre.stiffness_npm(pressure);
    EXPECT_NEAR(tyre.contact_area_m2(deflection) * (pressure + 3.4e4 / 1.555), 2.2e4, 1e-6);
  }
}

TEST(TyreLaws, InTheAirThereAreNone) {
  Tyre tyre({}, 2200.0);
  const TyreLaws laws = tyre.laws(1e-3, std::nullopt, {}, kRoad_pa, 3.0);
  EXPECT_FALSE(laws.touching);
  EXPECT_EQ(laws.normal.at(-1.0), 0.0);
  EXPECT_EQ(laws.longitudinal.at(1.0), 0.0);
  EXPECT_EQ(laws.limit_n(1e4), 0.0);
}

TEST(TyreLaws, SlipStiffnessAtReferenceLoadIsTheParameter) {
  const TyreParameters parameters;
  Tyre tyre(parameters, 2200.0);
  const double speed = 8.0;
  for (const double load_share : {0.5, 1.0, 1.5}) {
    const double depth = load_share * 2.2e4 / tyre.stiffness_npm(kRoad_pa);
    TyreLaws laws;
    const double slip = 0.01;
    for (int i = 0; i < 2000; ++i) {
      laws = tyre.laws(1e-3, pressed(depth), {}, kRoad_pa, speed);
      TyreResult result;
      result.longitudinal_slide_mps = slip * speed;
      result.lateral_slide_mps = -slip * speed;
      result.wheel_rate_radps = speed / 0.56;
      tyre.settle(1e-3, laws, result);
    }
    EXPECT_NEAR(laws.longitudinal.at(slip * speed), -load_share * 2e5 * slip, 1e-6);
    // sin(2 atan(N / 55 kN)) against the same at 22 kN.
    const double sensitivity =
        std::sin(2.0 * std::atan(0.4 * load_share)) / std::sin(2.0 * std::atan(0.4));
    EXPECT_NEAR(laws.lateral.at(-slip * speed), sensitivity * 1.5e5 * slip, 1e-6);
  }
}

TEST(TyreLaws, BristlesForgetInTheAir) {
  Tyre tyre({}, 2200.0);
  const TyreLaws laws = tyre.laws(1e-3, pressed(0.03), {}, kRoad_pa, 0.0);
  TyreResult result;
  result.longitudinal_slide_mps = 1.0;
  result.lateral_slide_mps = 1.0;
  tyre.settle(1e-3, laws, result);
  EXPECT_NE(tyre.longitudinal_deflection_m(), 0.0);
  (void)tyre.laws(1e-3, std::nullopt, {}, kRoad_pa, 0.0);
  EXPECT_EQ(tyre.longitudinal_deflection_m(), 0.0);
  EXPECT_EQ(tyre.lateral_deflection_m(), 0.0);
}

TEST(TyreLaws, RollingResistanceGrowsAsThePressureFalls) {
  Tyre tyre({}, 2200.0);
  const double load = 2.2e4;
  const auto coefficient = [&](double pressure, const SoilParameters& soil) {
    const TyreLaws laws =
        tyre.laws(1e-3, pressed(load / tyre.stiffness_npm(pressure)), soil, pressure, 5.0);
    return laws.rolling_arm_m / laws.rolling_radius_m;
  };
  EXPECT_NEAR(coefficient(kRoad_pa, {}), 0.012, 1e-12);
  EXPECT_NEAR(coefficient(kField_pa, {}), 0.012 * (0.5 + 0.5 * 4.5 / 1.2), 1e-12);
  EXPECT_NEAR(coefficient(0.5 * kRoad_pa, {}), 0.012 * 1.5, 1e-12);
}

// Finding: compaction was a moment on the wheel alone, hidden from slip.
TEST(TyreLaws, SoftSoilTakesCompactionFromTheCentreNotFromTheSpin) {
  SoilParameters soil = tyre_soft_soil();
  soil.cohesion_pa = 1e4;
  soil.internal_friction_rad = 0.5;
  Tyre tyre({}, 2200.0);
  const TyreLaws laws = tyre.laws(1e-3, pressed(0.15), soil, kRoad_pa, 5.0);
  const TyreSpring spring = tyre.spring(0.15, &soil, kRoad_pa);
  EXPECT_EQ(laws.sinkage_m, spring.sinkage_m);
  const double length = tyre.contact_length_m(0.15 - spring.sinkage_m, spring.sinkage_m);
  EXPECT_NEAR(laws.limit_n(spring.force_n), shear_limit_n(soil, spring.force_n, 0.395 * length),
              1e-9);
  const double compaction = compaction_resistance_n(soil, spring.sinkage_m, 0.395);
  EXPECT_NEAR(laws.ploughing_n, compaction, 1e-9 * compaction);
  EXPECT_NEAR(laws.rolling_arm_m, 0.012 * laws.rolling_radius_m, 1e-12);
}

// Finding: the footprint in a rut was as long as on asphalt.
TEST(TyreContact, SinkageLengthensIt) {
  const Tyre tyre({}, 2200.0);
  const double on_hard = tyre.contact_length_m(0.03, 0.0);
  EXPECT_NEAR(on_hard * 0.395, tyre.contact_area_m2(0.03), 1e-12);
  // The circle of 0.59 m enters a rut of 85 mm so far ahead of its lowest point.
  EXPECT_NEAR(tyre.contact_length_m(0.03, 0.085) - on_hard, std::sqrt(0.59 * 0.59 - 0.505 * 0.505),
              1e-9);
  EXPECT_TRUE(std::isfinite(tyre.contact_length_m(0.03, 1e3)));
}

TEST(TyreSpring, OverlapIsTheInverse) {
  const Tyre tyre({}, 2200.0);
  for (const double n : {0.3, 0.5, 1.1, 2.0}) {
    const SoilParameters soil = tyre_soft_soil(n);
    SoftSoils soils(&soil);
    for (const double pressed : {0.0, 0.05, 0.3}) {
      soils.pressed_m = pressed;
      for (const double pressure : {kField_pa, kRoad_pa}) {
        for (const double overlap : {0.06, 0.15, 0.4, 0.7}) {
          const TyreSpring spring = tyre.spring(overlap, soils, pressure);
          if (spring.force_n > 0.0) {
            EXPECT_NEAR(tyre.overlap_m(spring.force_n, soils, pressure), overlap, 1e-9)
                << n << " " << pressed << " " << overlap;
          } else {
            EXPECT_EQ(spring.sinkage_m, overlap);
          }
        }
      }
    }
  }
}

TEST(TyreSpring, BetweenSoftAndHardNothingJumps) {
  const Tyre tyre({}, 2200.0);
  SoilParameters soil = tyre_soft_soil(0.5);
  soil.cohesion_modulus = 13200;
  soil.friction_modulus = 692000;
  const double hard = tyre.spring(0.115, nullptr, kRoad_pa).force_n;
  double before = tyre.spring(0.115, &soil, kRoad_pa).force_n;
  EXPECT_GT(hard, 3.0 * before);
  for (int i = 999; i >= 0; --i) {
    SoftSoils soils;
    soils.add(soil, 1e-3 * i);
    const double now = tyre.spring(0.115, soils, kRoad_pa).force_n;
    EXPECT_GE(now, before);
    EXPECT_LT(now - before, 4e-3 * hard);
    before = now;
  }
  EXPECT_NEAR(before, hard, 1e-9 * hard);
}

TEST(TyreLaws, SteadySlipOnSoftSoilIsJanosisCurve) {
  const SoilParameters soil = tyre_soft_soil();
  TyreParameters parameters;
  parameters.slip_stiffness_n = 1e9;  // the soil alone
  for (const double slip : {1e-6, 1e-3, 0.05, 0.3, 1.0}) {
    Tyre tyre(parameters, 2200.0);
    const double speed = 3.0;
    TyreLaws laws;
    for (int i = 0; i < 4000; ++i) {
      laws = tyre.laws(1e-3, pressed(0.15), soil, kRoad_pa, speed);
      TyreResult result;
      result.longitudinal_slide_mps = slip * speed;
      result.wheel_rate_radps = 5.0;
      tyre.settle(1e-3, laws, result);
    }
    const TyreSpring spring = tyre.spring(0.15, &soil, kRoad_pa);
    const double length = tyre.contact_length_m(0.15 - spring.sinkage_m, spring.sinkage_m);
    const double expected = shear_limit_n(soil, spring.force_n, length * parameters.width_m) *
                            shear_share(soil, slip, length);
    EXPECT_NEAR(-laws.longitudinal.at(slip * speed), expected, 1e-3 * expected) << slip;
  }
}

TEST(TyreLaws, AreFiniteAtEveryExtreme) {
  const SoilParameters soft = tyre_soft_soil();
  for (const double depth : {1e-12, 1e-3, 0.5, 2.0}) {
    for (const double pressure : {0.0, -1e5, 1e3, 1e7}) {
      for (const double speed : {0.0, 1e-12, 50.0}) {
        for (const double h : {1e-9, 1e-3, 0.1}) {
          for (const bool on_soft : {false, true}) {
            Tyre tyre({}, 2200.0);
            const SoilParameters& soil = on_soft ? soft : SoilParameters{};
            for (int i = 0; i < 3; ++i) {
              const TyreLaws laws = tyre.laws(h, pressed(depth), soil, pressure, speed);
              for (const ImplicitForce& law :
                   {laws.normal, laws.longitudinal, laws.lateral, laws.rolling, laws.ploughing}) {
                ASSERT_TRUE(std::isfinite(law.offset) && std::isfinite(law.gain))
                    << depth << " " << pressure << " " << speed << " " << h << " " << on_soft;
                ASSERT_GE(law.gain, 0.0);
              }
              ASSERT_TRUE(std::isfinite(laws.limit_n(laws.normal.offset)));
              ASSERT_GT(laws.rolling_radius_m, 0.0);
              TyreResult result;
              result.longitudinal_slide_mps = 0.5;
              result.lateral_slide_mps = -0.1;
              result.wheel_rate_radps = 1.0;
              tyre.settle(h, laws, result);
            }
          }
        }
      }
    }
  }
}

TEST(TyreParameters, BadOnesAreRefusedByName) {
  EXPECT_NO_THROW(validate(TyreParameters{}));
  const auto refused = [](auto&& spoil, const char* member) {
    TyreParameters parameters;
    spoil(parameters);
    try {
      validate(parameters);
      ADD_FAILURE() << member;
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(std::string(error.what()).find(member), 0u) << error.what();
    }
  };
  refused([](TyreParameters& p) { p.unloaded_radius_m = 0.0; },
          "unloaded_radius: found 0 m, allowed 0.001 .. 100 m");
  refused([](TyreParameters& p) { p.rim_radius_m = 0.7; },
          "rim_radius: found 0.7 m, allowed at most unloaded_radius, 0.59 m");
  refused([](TyreParameters& p) { p.width_m = -1.0; }, "width: found -1 m, allowed 0.001 .. 100 m");
  refused([](TyreParameters& p) { p.carcass_stiffness_npm = p.stiffness_per_pressure_m = 0.0; },
          "carcass_stiffness: found 0 kN/m, allowed > 0 kN/m where");
  refused([](TyreParameters& p) { p.rolling_resistance = 1.5; },
          "rolling_resistance: found 1.5, allowed 0 .. 0.99");
  refused([](TyreParameters& p) { p.slip_stiffness_n = std::numeric_limits<double>::infinity(); },
          "slip_stiffness: found inf");
  EXPECT_THROW(Tyre(TyreParameters{}, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
