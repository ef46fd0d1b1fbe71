// The tyre in motion: standstill, sliding, braking, falling, soft soil, on the smallest vehicle.
#include "quarter_vehicle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <tuple>

#include "allocation_counter.h"
#include "number_word.h"

namespace rigwire::sim {
namespace {

using rigwire::test::number_word;
using Vector = Eigen::Vector3d;
constexpr double kMass_kg = 2200.0;
constexpr double kGravity = QuarterVehicle::kGravity;

Ground slope(double degrees, const SoilParameters& soil = {}) {
  const double angle = degrees * std::numbers::pi / 180.0;
  return Ground::plane(Vector(-std::sin(angle), 0.0, std::cos(angle)), soil);
}

class SlipDisturbance : public testing::TestWithParam<std::tuple<double, double>> {};

// A wheel that turns 0.3 m/s too fast settles at every speed and step; explicit slip laws and
// clamping before the solve change the sign of the slip at each step, for ever.
TEST_P(SlipDisturbance, SettlesWithoutHum) {
  const auto [speed, h] = GetParam();
  const Ground ground = slope(0.0);
  TyreParameters parameters;
  parameters.rolling_resistance = 0.0;
  QuarterVehicle vehicle(ground, parameters, kMass_kg);
  vehicle.place(0.0, 0.0, kMass_kg * kGravity);
  vehicle.v_W.x() = speed;
  vehicle.wheel_radps = (speed + 0.3) / vehicle.p_W.z();
  int changes = 0;
  double before = 0.0;
  for (int i = 0; i < std::lround(2.0 / h); ++i) {
    vehicle.step(h);
    changes += vehicle.slide_mps * before < 0.0 ? 1 : 0;
    before = vehicle.slide_mps;
  }
  EXPECT_LE(changes, 2);
  EXPECT_NEAR(vehicle.slide_mps, 0.0, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(SpeedsAndSteps, SlipDisturbance,
                         testing::Combine(testing::Values(10.0, 1.0, 0.1, 0.0),
                                          testing::Values(1e-4, 1e-3, 2e-3, 1e-2)),
                         [](const auto& test) {
                           const double speed = std::get<0>(test.param);
                           const double h = std::get<1>(test.param);
                           return "at_" + number_word(speed) + "_mps_by_" + number_word(1e3 * h) +
                                  "_ms";
                         });

class StandingOnASlope : public testing::TestWithParam<std::tuple<double, double>> {};

TEST_P(StandingOnASlope, StopsAndStaysForAnHour) {
  const auto [degrees, h] = GetParam();
  const double angle = degrees * std::numbers::pi / 180.0;
  const Ground ground = slope(degrees);
  QuarterVehicle vehicle(ground, {}, kMass_kg);
  vehicle.locked = true;
  vehicle.place(0.0, 0.0, kMass_kg * kGravity * std::cos(angle));
  vehicle.run(10.0, h);
  // The bristles carry the weight along the slope: deflection m g sin / k.
  const double k = 6e5 * vehicle.normal_n / 2.2e4;
  EXPECT_NEAR(std::abs(vehicle.tyre.longitudinal_deflection_m()),
              kMass_kg * kGravity * std::sin(angle) / k, 1e-9);
  const Vector rest = vehicle.p_W;
  vehicle.run(h < 5e-3 ? 60.0 : 3600.0, h);
  EXPECT_LT((vehicle.p_W - rest).norm(), 1e-9);
  EXPECT_LT(vehicle.v_W.norm(), 1e-12);
}

INSTANTIATE_TEST_SUITE_P(AnglesAndSteps, StandingOnASlope,
                         testing::Combine(testing::Values(5.0, 20.0, 30.0),
                                          testing::Values(1e-3, 1e-2)),
                         [](const auto& test) {
                           const double degrees = std::get<0>(test.param);
                           const double h = std::get<1>(test.param);
                           return "on_" + number_word(degrees) + "_degrees_by_" +
                                  number_word(1e3 * h) + "_ms";
                         });

TEST(Sliding, BeyondTheAngleOfFrictionIsCoulombs) {
  const double angle = 40.0 * std::numbers::pi / 180.0;
  const Ground ground = slope(40.0);
  QuarterVehicle vehicle(ground, {}, kMass_kg);
  vehicle.locked = true;
  vehicle.place(0.0, 0.0, kMass_kg * kGravity * std::cos(angle));
  vehicle.run(5.0, 1e-3);
  const double before = vehicle.v_W.norm();
  vehicle.run(5.0, 1e-3);
  EXPECT_NEAR((vehicle.v_W.norm() - before) / 5.0,
              kGravity * (std::sin(angle) - 0.8 * std::cos(angle)), 1e-9);
}

TEST(Sliding, SidewaysToTheSlopeStandsToo) {
  const Ground ground = slope(20.0);
  QuarterVehicle vehicle(ground, {}, kMass_kg);
  vehicle.axis_W = -Vector::UnitX();  // across the slope; the wheel is free to turn
  vehicle.place(0.0, 0.0, kMass_kg * kGravity * std::cos(0.349));
  vehicle.run(30.0, 1e-3);
  const Vector rest = vehicle.p_W;
  vehicle.run(60.0, 1e-3);
  EXPECT_LT((vehicle.p_W - rest).norm(), 1e-8);
}

TEST(Braking, StopsAfterTheDistanceOfCoulombAndStaysStopped) {
  const Ground ground = slope(0.0);
  for (const double h : {1e-4, 1e-3, 1e-2}) {
    QuarterVehicle vehicle(ground, {}, kMass_kg);
    vehicle.locked = true;
    vehicle.place(0.0, 0.0, kMass_kg * kGravity);
    vehicle.v_W.x() = 10.0;
    double furthest = 0.0;
    for (int i = 0; i < std::lround(5.0 / h); ++i) {
      vehicle.step(h);
      furthest = std::max(furthest, vehicle.p_W.x());
    }
    // v^2 / (2 mu g) = 6.3733 m, less half a step's way of an implicit rule.
    EXPECT_NEAR(furthest, 6.3733 - 0.5 * h * 10.0, 1e-3) << h;
    EXPECT_LT(vehicle.v_W.norm(), 1e-12);
    // The tyre springs back from its bristles' greatest deflection, mu N / k.
    EXPECT_NEAR(furthest - vehicle.p_W.x(), 0.8 * 2.2e4 / 6e5, 2e-3);
    // All that the vehicle had became heat.
    EXPECT_NEAR(vehicle.slip_heat_j, 0.5 * kMass_kg * 100.0, 1e-3 * 0.5 * kMass_kg * 100.0);
  }
}

TEST(Braking, FreeWheelRollsOutAndNeverBackwards) {
  const Ground ground = slope(0.0);
  QuarterVehicle vehicle(ground, {}, kMass_kg);
  vehicle.place(0.0, 0.0, kMass_kg * kGravity);
  vehicle.v_W.x() = 1.0;
  const double r = 0.59 - (0.59 - vehicle.p_W.z()) / 3.0;
  vehicle.wheel_radps = 1.0 / r;
  vehicle.run(1.0, 1e-3);
  // Rolling resistance f N against mass and spin: a = f g / (1 + J / (m r^2)).
  const double a = 0.012 * kGravity / (1.0 + 25.0 / (kMass_kg * r * r));
  EXPECT_NEAR(vehicle.v_W.x(), 1.0 - a, 2e-3);
  double slowest = 1.0;
  for (int i = 0; i < 60'000; ++i) {
    vehicle.step(1e-3);
    slowest = std::min(slowest, vehicle.v_W.x());
  }
  EXPECT_GT(slowest, -0.02);  // the tyre unwinds, no more
  EXPECT_NEAR(vehicle.v_W.norm(), 0.0, 1e-6);
}

TEST(RollingRadius, OfASoftTyreIsNotItsHeightAboveTheGround) {
  const Ground ground = slope(0.0);
  for (const double pressure : {4.5e5, 1.2e5}) {
    TyreParameters parameters;
    parameters.rolling_resistance = 0.0;
    QuarterVehicle vehicle(ground, parameters, kMass_kg);
    vehicle.pressure_pa = pressure;
    vehicle.place(0.0, 0.0, kMass_kg * kGravity);
    vehicle.v_W.x() = 2.0;
    vehicle.wheel_radps = 2.0 / 0.55;
    vehicle.run(5.0, 1e-3);
    const double deflection = 0.59 - vehicle.p_W.z();
    EXPECT_NEAR(vehicle.v_W.x() / vehicle.wheel_radps, 0.59 - deflection / 3.0, 1e-6);
    // The exact arc of a belt that does not stretch, R sin(phi) / phi.
    const double phi = std::acos(1.0 - deflection / 0.59);
    EXPECT_NEAR(vehicle.v_W.x() / vehicle.wheel_radps, 0.59 * std::sin(phi) / phi, 5e-4);
  }
}

// With another lever than the rolling radius a shaft would give more, or less, than the road gets.
TEST(RollingRadius, TheShaftGivesWhatTheRoadGets) {
  const Ground ground = slope(0.0);
  TyreParameters parameters;
  parameters.rolling_resistance = 0.0;
  QuarterVehicle vehicle(ground, parameters, kMass_kg);
  vehicle.pressure_pa = 1.2e5;
  vehicle.place(0.0, 0.0, kMass_kg * kGravity);
  vehicle.run(1.0, 1e-3);
  vehicle.drive_nm = 2000.0;
  double shaft_j = 0.0;
  vehicle.slip_heat_j = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const double before = vehicle.wheel_radps;
    vehicle.step(1e-3);
    shaft_j += 0.5e-3 * vehicle.drive_nm * (before + vehicle.wheel_radps);
  }
  const double moving = 0.5 * kMass_kg * vehicle.v_W.squaredNorm() +
                        0.5 * 25.0 * vehicle.wheel_radps * vehicle.wheel_radps;
  EXPECT_NEAR(shaft_j, moving + vehicle.slip_heat_j, 2e-3 * shaft_j);
}

TEST(Lifting, TheTyreNeverPullsAndForgetsInTheAir) {
  const Ground ground = slope(0.0);
  QuarterVehicle vehicle(ground, {}, kMass_kg);
  vehicle.place(0.0, 0.0, kMass_kg * kGravity);
  vehicle.v_W = Vector(3.0, 0.5, 2.0);
  bool flew = false;
  for (int i = 0; i < 2000; ++i) {
    const bool was_in_air = vehicle.normal_n == 0.0 && vehicle.p_W.z() > 0.6;
    const double before = vehicle.v_W.z();
    vehicle.step(1e-3);
    ASSERT_GE(vehicle.normal_n, 0.0);
    if (was_in_air && vehicle.p_W.z() > 0.6) {
      flew = true;
      EXPECT_NEAR((vehicle.v_W.z() - before) / 1e-3, -kGravity, 1e-9);
      EXPECT_EQ(vehicle.tyre.longitudinal_deflection_m(), 0.0);
      EXPECT_EQ(vehicle.tyre.lateral_deflection_m(), 0.0);
    }
  }
  EXPECT_TRUE(flew);
}

TEST(Dropping, FromHalfAMetreDeflectsAsTheSpringSays) {
  const Ground ground = slope(0.0);
  TyreParameters parameters;
  parameters.carcass_stiffness_npm = 4e5;
  parameters.stiffness_per_pressure_m = 0.0;
  parameters.vertical_damping_nspm = 0.0;
  const double sink = 2000.0 * kGravity / 4e5;
  const double expected = sink * (1.0 + std::sqrt(1.0 + 2.0 * 0.5 / sink));
  EXPECT_NEAR(expected, 0.2758, 1e-3);
  for (const double h : {1e-4, 1e-3, 1e-2}) {
    QuarterVehicle vehicle(ground, parameters, 2000.0);
    vehicle.p_W.z() = 0.590 + 0.5;
    double lowest = 9.0;
    double rebound = 0.0;
    bool down = false;
    for (int i = 0; i < std::lround(2.0 / h); ++i) {
      vehicle.step(h);
      lowest = std::min(lowest, vehicle.p_W.z());
      down = down || vehicle.p_W.z() < 0.59;
      rebound = down ? std::max(rebound, vehicle.p_W.z() - 0.59) : 0.0;
    }
    // The implicit rule damps with zeta = h omega / 2 and never adds energy, whatever the step.
    EXPECT_LE(0.590 - lowest, expected);
    EXPECT_GT(0.590 - lowest, expected * (1.0 - 14.2 * h));
    EXPECT_LE(rebound, 0.5);
    EXPECT_GT(lowest, 0.254);  // no tunnelling
  }
}

TEST(TyrePressure, ChangedAtRestLowersTheVehicleAndTurnsTheWorkToHeat) {
  const Ground ground = slope(0.0);
  QuarterVehicle vehicle(ground, {}, kMass_kg);
  vehicle.place(0.0, 0.0, kMass_kg * kGravity);
  vehicle.run(1.0, 1e-3);
  const double weight = kMass_kg * kGravity;
  const double before = vehicle.p_W.z();
  const double k1 = vehicle.tyre.stiffness_npm(4.5e5);
  const double k2 = vehicle.tyre.stiffness_npm(1.2e5);
  vehicle.pressure_pa = 1.2e5;
  vehicle.normal_heat_j = 0.0;
  vehicle.run(20.0, 1e-4);
  const double drop = weight * (1.0 / k2 - 1.0 / k1);
  EXPECT_NEAR(before - vehicle.p_W.z(), drop, 1e-6);
  EXPECT_LT(vehicle.v_W.norm(), 1e-5);
  // What gravity gave and the softer tyre did not store went through the damper.
  const double d1 = weight / k1;
  const double d2 = weight / k2;
  const double heat = weight * drop - 0.5 * k2 * (d2 * d2 - d1 * d1);
  EXPECT_NEAR(vehicle.normal_heat_j, heat, 0.03 * heat);
}

TEST(TyrePressure, LetDownWhileRollingMakesItHeavierToRoll) {
  const Ground ground = slope(0.0);
  QuarterVehicle vehicle(ground, {}, kMass_kg);
  vehicle.place(0.0, 0.0, kMass_kg * kGravity);
  vehicle.v_W.x() = 10.0;
  vehicle.wheel_radps = 10.0 / vehicle.p_W.z();
  vehicle.run(1.0, 1e-3);
  const double road = vehicle.v_W.x();
  for (int i = 0; i < 3000; ++i) {
    vehicle.pressure_pa = 4.5e5 - 1.1e2 * i;
    vehicle.step(1e-3);
  }
  const double before = vehicle.v_W.x();
  vehicle.run(1.0, 1e-3);
  EXPECT_GT((before - vehicle.v_W.x()) / (10.0 - road), 2.0);
  EXPECT_NEAR(vehicle.p_W.z(), 0.590 - kMass_kg * kGravity / vehicle.tyre.stiffness_npm(1.2011e5),
              1e-3);
}

SoilParameters soft_soil(double exponent) {
  SoilParameters soil;
  soil.soft = true;
  soil.exponent = exponent;
  return soil;
}

class OnSoftSoil : public testing::TestWithParam<double> {};

TEST_P(OnSoftSoil, StandsAtItsStaticSinkage) {
  const SoilParameters soil = soft_soil(GetParam());
  const Ground ground = slope(0.0, soil);
  QuarterVehicle vehicle(ground, {}, kMass_kg);
  vehicle.leaves_ruts = false;  // else it stays as deep as its fall pressed it
  vehicle.p_W.z() = 0.59;
  vehicle.run(20.0, 2e-3);
  EXPECT_NEAR(vehicle.normal_n, kMass_kg * kGravity, 1.0);
  EXPECT_NEAR(vehicle.sinkage_m, wheel_sinkage_m(soil, kMass_kg * kGravity, 0.395, 1.18), 1e-4);
  EXPECT_LT(vehicle.v_W.norm(), 1e-4);
}

TEST_P(OnSoftSoil, SpinsWithoutHumAndAlikeAtEveryStep) {
  double speed_at[2] = {0.0, 0.0};
  int which = 0;
  for (const double h : {1e-3, 1e-2}) {
    const Ground ground = slope(0.0, soft_soil(GetParam()));  // without the other one's rut
    QuarterVehicle vehicle(ground, {}, kMass_kg);
    vehicle.pressure_pa = 1.2e5;
    vehicle.p_W.z() = 0.5;
    vehicle.run(2.0, h);
    vehicle.drive_nm = 7000.0;
    int changes = 0;
    double before = 0.0;
    for (int i = 0; i < std::lround(2.0 / h); ++i) {
      vehicle.step(h);
      changes += vehicle.along_n * before < 0.0 ? 1 : 0;
      before = vehicle.along_n;
      ASSERT_TRUE(vehicle.p_W.allFinite());
    }
    EXPECT_LE(changes, 4) << h;
    EXPECT_GT(vehicle.wheel_radps, 1.0);
    speed_at[which++] = vehicle.v_W.x();
  }
  EXPECT_NEAR(speed_at[0], speed_at[1], 0.03 * std::abs(speed_at[0]) + 0.02);
}

INSTANTIATE_TEST_SUITE_P(Exponents, OnSoftSoil, testing::Values(0.6, 1.1, 1.6),
                         [](const auto& test) { return "exponent_" + number_word(test.param); });

TEST(OnAStep, ClimbsAndFallsWithoutGainingEnergy) {
  HeightField field;
  field.origin_m = {-20.0, -20.0};
  field.cell_m = 1.0;
  field.columns = field.rows = 61;
  field.heights_m.assign(61 * 61, 0.0);
  Obstacle step;
  step.X_WO.translation() = Vector(5.0, 0.0, 0.05);
  step.half_lengths_m = Vector(1.0, 1.0, 0.05);
  step.friction = 0.8;
  const Ground ground(field, {}, {step});
  TyreParameters parameters;
  parameters.rolling_resistance = 0.0;
  QuarterVehicle vehicle(ground, parameters, kMass_kg);
  vehicle.place(0.0, 0.0, kMass_kg * kGravity);
  vehicle.v_W.x() = 3.0;
  vehicle.wheel_radps = 3.0 / vehicle.p_W.z();
  double greatest = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const double before = vehicle.normal_n;
    vehicle.step(1e-3);
    greatest = std::max(greatest, i > 0 ? std::abs(vehicle.normal_n - before) : 0.0);
  }
  EXPECT_GT(vehicle.p_W.x(), 8.0);
  EXPECT_LT(vehicle.v_W.x(), 3.0);
  // Closing at 3 m/s on 735 kN/m is 2.2 kN per millisecond, and the damper sets in over the first 7
  // mm.
  EXPECT_LT(greatest, 3.5e3);
}

TEST(OnAStep, NoStepAllocates) {
  SoilMap soils;
  soils.soils = {soft_soil(1.1)};
  HeightField field;
  field.columns = field.rows = 21;
  field.heights_m.assign(21 * 21, 0.0);
  Obstacle rock;
  rock.shape = ObstacleShape::sphere;
  rock.X_WO.translation() = Vector(5.0, 5.0, 0.0);
  rock.half_lengths_m.x() = 0.1;
  const Ground ground(field, soils, {rock});
  QuarterVehicle vehicle(ground, {}, kMass_kg);
  vehicle.place(3.0, 5.0, kMass_kg * kGravity);
  vehicle.v_W.x() = 2.0;
  vehicle.step(1e-3);
  const auto before = rigwire::test::allocations();
  vehicle.run(1.5, 1e-3);
  EXPECT_EQ(rigwire::test::allocations(), before);
  EXPECT_GT(vehicle.p_W.x(), 3.1);
}

}  // namespace
}  // namespace rigwire::sim
