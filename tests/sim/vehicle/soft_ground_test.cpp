// Whole vehicles on the mud of configs/scenes/forest_track.yaml against Bekker's and Wong's
// balances in closed form: resistance, thrust, slope, ruts, borders.
#include <gtest/gtest.h>

#include "sim/ground/soil.h"
#include "vehicle_rig.h"

namespace rigwire::sim::test {
namespace {

using namespace std::chrono_literals;

SoilParameters mud() {
  SoilParameters soil;
  soil.name = "mud";
  soil.friction = 0.4;
  soil.soft = true;
  soil.cohesion_modulus = 13200.0;
  soil.friction_modulus = 692000.0;
  soil.exponent = 0.5;
  soil.cohesion_pa = 4.1e3;
  soil.internal_friction_rad = 13.0 * kDegree;
  soil.shear_modulus_m = 0.02;
  return soil;
}

/// Rises towards +x.
Ground muddy(double angle_rad = 0.0) {
  return Ground::plane({-std::sin(angle_rad), 0.0, std::cos(angle_rad)}, mud());
}

WheeledVehicleParameters at_pressure(double pressure_pa) {
  WheeledVehicleParameters parameters;
  parameters.front.initial_pressure_pa = pressure_pa;
  parameters.rear.initial_pressure_pa = pressure_pa;
  return parameters;
}

/// No wheel in another one's rut.
WheeledVehicleParameters four_tracks(double pressure_pa = 4.5e5) {
  WheeledVehicleParameters parameters = at_pressure(pressure_pa);
  parameters.rear.track_m = parameters.front.track_m + 1.2;
  return parameters;
}

/// Bekker's compaction resistance of a wheel on virgin mud.
double bekker_n(double load_n, double pressure_pa) {
  const TyreParameters tyre;
  const SoilParameters soil = mud();
  const double flat = plate_sinkage_m(
      soil, pressure_pa + tyre.carcass_stiffness_npm / tyre.stiffness_per_pressure_m, tyre.width_m);
  const double rigid = wheel_sinkage_m(soil, load_n, tyre.width_m, 2.0 * tyre.unloaded_radius_m);
  return compaction_resistance_n(soil, std::min(flat, rigid), tyre.width_m);
}

/// Shear of the soil at that slip, in a row with the tyre's own slip.
double thrust_n(double load_n, double length_m, double slip) {
  const TyreParameters tyre;
  const double shear =
      shear_limit_n(mud(), load_n, tyre.width_m * length_m) * shear_share(mud(), slip, length_m);
  return slip / (tyre.reference_load_n / (load_n * tyre.slip_stiffness_n) + slip / shear);
}

double ploughing_n(const BareVehicle& rig, std::size_t first, std::size_t last) {
  double sum = 0.0;
  for (std::size_t i = first; i <= last; ++i) {
    sum += rig.machine.wheels()[i].ploughing_n;
  }
  return sum;
}

void drive(BareVehicle& rig, double torque_nm) {
  rig.equations.torque_nm.setConstant(torque_nm);
  rig.machine.command(released());
}

class InMud : public testing::TestWithParam<double> {};

// Finding: level mud at 4.5 bar has 19.0 kN of resistance, yet there was no slip.
TEST_P(InMud, FourFirstPassesCostBekkersResistance) {
  const double pressure = GetParam();
  BareVehicle rig(muddy(), four_tracks(pressure));
  rig.machine.command(released());
  rig.machine.start_rolling(3.0);
  rig.machine.step(500ms);
  double expected = 0.0;
  for (const WheelState& wheel : rig.machine.wheels()) {
    expected += bekker_n(wheel.load_n, pressure);
  }
  EXPECT_NEAR(-ploughing_n(rig, 0, 3), expected, 0.06 * expected);
  if (pressure == 4.5e5) {
    EXPECT_NEAR(expected, 19.0e3, 1.0e3);
  }
}

TEST_P(InMud, ThrustLessResistanceIsWhatAccelerates) {
  const double pressure = GetParam();
  BareVehicle rig(muddy(), four_tracks(pressure));
  rig.machine.start_rolling(2.0);
  drive(rig, 9000.0);  // every wheel spins
  rig.machine.step(1s);
  const double before = rig.speed();
  double expected = 0.0;
  double count = 0.0;
  for (int k = 0; k < 500; ++k) {
    rig.machine.step(1ms);
    for (const WheelState& wheel : rig.machine.wheels()) {
      EXPECT_TRUE(wheel.slide_mps > 1.0);
      const double deflection = wheel.load_n / (3.4e4 + 1.555 * pressure);
      const double length = Tyre({}, 1.0).contact_length_m(deflection, wheel.sinkage_m);
      const double slip = wheel.slide_mps / (wheel.rate_radps * wheel.rolling_radius_m);
      expected += thrust_n(wheel.load_n, length, slip) - bekker_n(wheel.load_n, pressure);
    }
    count += 1.0;
  }
  expected /= count * rig.machine.parameters().mass_kg();
  EXPECT_NEAR((rig.speed() - before) / 0.5, expected, 0.05 * expected + 0.02);
}

INSTANTIATE_TEST_SUITE_P(Pressures, InMud, testing::Values(4.5e5, 1.2e5), [](const auto& test) {
  return std::string(test.param > 2e5 ? "on_the_road" : "in_the_field");
});

/// What it gains in 4 s at full torque on a slope.
double gained_mps(double angle_rad, const WheeledVehicleParameters& parameters) {
  BareVehicle rig(muddy(angle_rad), parameters);
  rig.machine.start_rolling(3.0);
  drive(rig, 9000.0);
  rig.machine.step(1s);  // until every wheel spins and the body has found its pitch
  const double before = rig.speed();
  rig.machine.step(4s);
  return rig.speed() - before;
}

// Finding: at 4.5 bar it climbed 10.9 degrees, a balance gives less than 3.
TEST(VehicleInMud, ClimbsWhatBekkersBalanceLets) {
  for (const double pressure : {4.5e5, 1.2e5}) {
    const double load = 0.25 * 9000.0 * kGravity;
    const Tyre tyre({}, 1.0);
    const SoilParameters soil = mud();
    const double deflection = load / tyre.stiffness_npm(pressure);
    const double sinkage = tyre.overlap_m(load, &soil, pressure) - deflection;
    const double length = tyre.contact_length_m(deflection, sinkage);
    // Wheels that spin ten times as fast as they travel.
    const double balance =
        std::asin((thrust_n(load, length, 0.9) - bekker_n(load, pressure)) / load);
    EXPECT_GT(balance, 0.0);
    EXPECT_GT(gained_mps(balance - 0.7 * kDegree, four_tracks(pressure)), 0.0);
    EXPECT_LT(gained_mps(balance + 0.7 * kDegree, four_tracks(pressure)), 0.0);
    if (pressure == 4.5e5) {
      EXPECT_LT(balance, 3.0 * kDegree);
    } else {
      EXPECT_GT(balance, 8.0 * kDegree);
    }
  }
}

// Finding: odometry showed no slip in mud.
TEST(VehicleInMud, WhatItTakesShowsAsSlipInOdometry) {
  BareVehicle rig(muddy(), at_pressure(4.5e5));
  rig.machine.start_rolling(1.0);
  drive(rig, 2.6e3);  // about the resistance of the front wheels
  rig.machine.step(3s);
  const double odometry = rig.machine.vehicle_sample(rig.machine.time()).odometry.speed_mps;
  EXPECT_GT(rig.speed(), 0.2);
  EXPECT_GT(odometry, 1.05 * rig.speed());
}

// Finding: a second pass felt no rut.
TEST(VehicleInMud, RearWheelsAndASecondPassRollInTheRut) {
  BareVehicle rig(muddy());
  rig.machine.command(released());
  rig.machine.start_rolling(6.0);
  rig.machine.step(1200ms);
  ASSERT_GT(rig.position().x(), 4.2);
  EXPECT_LT(ploughing_n(rig, 0, 1), -8.0e3);
  EXPECT_GT(ploughing_n(rig, 2, 3), -0.1e3);
  EXPECT_GT(rig.machine.wheels()[2].sinkage_m, 0.07);
  // Back over the same ground.
  rig.machine.start_rolling(-2.0);
  rig.machine.step(2s);
  EXPECT_LT(rig.speed(), -1.0);
  EXPECT_NEAR(ploughing_n(rig, 0, 3), 0.0, 2.0e3);  // of 19 kN; the body still pitches
}

TEST(VehicleInMud, StandsInItsHoleOnASlope) {
  for (const double degrees : {0.0, 8.0}) {
    BareVehicle rig(muddy(degrees * kDegree));
    rig.machine.step(15s);
    const Eigen::Vector3d at = rig.position();
    rig.machine.step(20s);
    EXPECT_LT((rig.position() - at).norm(), 1e-6) << degrees;
  }
}

/// Mud to x = 3 m, hard beyond.
Ground leaving_mud() {
  HeightField field;
  field.origin_m = {-37.0, -40.0};
  field.cell_m = 0.4;
  field.columns = 401;
  field.rows = 201;
  field.heights_m.assign(401 * 201, 0.0);
  SoilMap soils;
  soils.soils.resize(2);
  soils.soils[0].friction = 0.65;
  soils.soils[1] = mud();
  for (std::size_t row = 0; row < 200; ++row) {
    for (std::size_t column = 0; column < 400; ++column) {
      soils.cells.push_back(column < 100 ? 1 : 0);
    }
  }
  return {std::move(field), std::move(soils), {}};
}

double energy_j(const BareVehicle& rig) {
  const VehicleMomentum m = rig.machine.momentum();
  double sum = m.kinetic_j + m.potential_j + m.spring_j;
  for (const WheelState& wheel : rig.machine.wheels()) {
    // Tyre, k d^2 / 2.
    sum += 0.5 * wheel.load_n * wheel.load_n / (3.4e4 + 1.555 * 4.5e5);
  }
  return sum;
}

// Finding: leaving the mud at 1 m/s the load went from 23 to 83 kN, 61 of them within 1 ms, and
// each wheel got about 4 kJ from nothing.
TEST(VehicleInMud, LeavingItLoadsChangeSmoothlyAndNothingIsGained) {
  for (const double speed : {1.0, 3.0}) {
    BareVehicle rig(leaving_mud());
    rig.machine.start_rolling(speed);
    // The torque just keeps it moving; its work is counted.
    drive(rig, 2.9e3);
    double jump = 0.0;
    double greatest = 0.0;
    double gain = 0.0;
    double work = 0.0;
    double lowest = energy_j(rig);
    std::array<double, kWheels> before{};
    for (int i = 0; i < 9000 && rig.position().x() < 8.0; ++i) {
      rig.machine.step(1ms);
      for (std::size_t w = 0; w < kWheels; ++w) {
        const WheelState& wheel = rig.machine.wheels()[w];
        work += 1e-3 * 2.9e3 * wheel.rate_radps;
        if (i > 0) {
          jump = std::max(jump, std::abs(wheel.load_n - before[w]));
        }
        greatest = std::max(greatest, wheel.load_n);
        before[w] = wheel.load_n;
      }
      const double left = energy_j(rig) - work;
      lowest = std::min(lowest, left);
      gain = std::max(gain, left - lowest);
    }
    EXPECT_GT(rig.position().x(), 7.9) << speed;
    EXPECT_LT(jump, 700.0 * speed) << speed;
    EXPECT_LT(greatest, 45e3) << speed;
    // Not counted in energy_j(): what lies in the soil's reloading lines, 60 J per wheel.
    EXPECT_LT(gain, 300.0) << speed;
  }
}

TEST(VehicleInMud, HugeLoadsAndSpeedsStayFinite) {
  for (const double mass : {100.0, 1e5}) {
    WheeledVehicleParameters parameters;
    parameters.body.mass_kg = mass;
    for (VehicleAxleParameters* axle : {&parameters.front, &parameters.rear}) {
      axle->tyre.stiffness_per_pressure_m *= mass / 7600.0 + 0.1;
    }
    BareVehicle rig(muddy(), parameters);
    rig.machine.start_rolling(20.0);
    rig.machine.command(released());
    rig.machine.step(2s);
    EXPECT_FALSE(rig.machine.non_finite()) << mass;
    EXPECT_LT(rig.speed(), 20.0);
    EXPECT_GE(rig.speed(), -0.5);
  }
}

}  // namespace
}  // namespace rigwire::sim::test
