// Standing still on slopes for ever, and stopping: dynamics cases 8, 10, 26, 31.
#include <gtest/gtest.h>

#include "bench/machine_files.h"
#include "number_word.h"
#include "vehicle_rig.h"

namespace rigwire::sim::test {
namespace {

using namespace std::chrono_literals;

TEST(VehicleStandstill, LevelLoadsAreTheStatics) {
  const BareVehicle rig(slope(0.0));
  const StaticLoads loads = static_loads(rig.machine.parameters());
  for (std::size_t i = 0; i < kWheels; ++i) {
    EXPECT_NEAR(rig.machine.wheels()[i].load_n, loads.wheel_n[i / 2], 1e-3);
  }
  EXPECT_NEAR(rig.total_load(), 9000.0 * kGravity, 1e-3);
  EXPECT_NEAR(rig.position().z(), 0.0, 1e-9);
}

TEST(VehicleStandstill, GatorStandsInItsDesignPosition) {
  const BareVehicle rig(slope(0.0), bench::gator_855d().vehicle);
  EXPECT_NEAR(rig.total_load(), 1000.0 * kGravity, 1e-3);
  EXPECT_NEAR(rig.position().z(), 0.0, 1e-9);
}

class VehicleOnSlope : public testing::TestWithParam<double> {};

// Once the vehicle's own oscillation has died away, every later step moves it by less than 1e-13 m:
// at 1 ms, 3.6e6 steps of an hour stay below a micrometre.
TEST_P(VehicleOnSlope, ParkedVehicleDoesNotCreep) {
  BareVehicle rig(slope(GetParam() * kDegree));
  rig.machine.step(15s);
  const Eigen::Vector3d at = rig.position();
  rig.machine.step(20s);
  EXPECT_LT((rig.position() - at).norm(), 1e-6 / 180.0);
  EXPECT_LT(rig.machine.links()[0].v_WL_W.norm(), 2e-10);
  double along = 0.0;
  for (const WheelState& wheel : rig.machine.wheels()) {
    along += wheel.longitudinal_n;
    EXPECT_FALSE(wheel.slipping);
    EXPECT_LT(std::abs(wheel.rate_radps), 1e-9);
  }
  EXPECT_NEAR(along, 9000.0 * kGravity * std::sin(GetParam() * kDegree), 60.0);
}

INSTANTIATE_TEST_SUITE_P(Slopes, VehicleOnSlope, testing::Values(5.0, 20.0, 30.0),
                         [](const auto& test) {
                           return "on_" + rigwire::test::number_word(test.param) + "_degrees";
                         });

TEST(VehicleStandstill, HourAtTenMillisecondsOnTwentyDegrees) {
  WheeledVehicleParameters parameters;
  parameters.step_s = 0.01;
  BareVehicle rig(slope(20.0 * kDegree), parameters);
  rig.machine.step(20s);
  const Eigen::Vector3d at = rig.position();
  rig.machine.step(3600s);
  EXPECT_LT((rig.position() - at).norm(), 1e-6);
}

TEST(VehicleStandstill, SlidesWhereTheSlopeIsSteeperThanFriction) {
  // tan 30 deg = 0.577 > 0.4; all wheels locked.
  BareVehicle rig(slope(30.0 * kDegree, 0.4));
  VehicleCommand command;
  command.brake_share = 1.0;
  rig.machine.command(command);
  rig.machine.step(2s);
  const double before = rig.speed();
  rig.machine.step(1s);
  const double expected = -kGravity * (std::sin(30.0 * kDegree) - 0.4 * std::cos(30.0 * kDegree));
  EXPECT_NEAR(rig.speed() - before, expected, 0.03 * std::abs(expected));
}

TEST(VehicleStandstill, BrakedFromTenMetresPerSecondStopsAndStays) {
  // Brakes that lock every wheel: v^2 / (2 mu g).
  WheeledVehicleParameters parameters = nearly_rigid({});
  parameters.air_drag_ns2pm2 = 0.0;
  parameters.brake_lag_s = 0.0;
  parameters.front.brake_torque_nm = 2e5;
  parameters.rear.brake_torque_nm = 2e5;
  BareVehicle rig(slope(0.0), parameters);
  rig.machine.command(released());
  rig.machine.start_rolling(10.0);
  const double from = rig.position().x();
  rig.machine.command(braked());
  rig.machine.step(3s);
  EXPECT_NEAR(rig.position().x() - from, 6.3733, 0.1);
  rig.machine.step(3s);
  const double at = rig.position().x();
  rig.machine.step(5s);
  EXPECT_LT(std::abs(rig.position().x() - at), 1e-7);
  EXPECT_LT(std::abs(rig.speed()), 1e-7);
}

TEST(VehicleStandstill, AccelerometerAtRestFeelsGravityOnly) {
  for (const double angle : {0.0, 12.0}) {
    BareVehicle rig(slope(angle * kDegree));
    rig.machine.step(10s);
    double sum = 0.0;
    for (int i = 0; i < 1000; ++i) {
      rig.machine.step(1ms);
      const LinkMotion& body = rig.machine.links()[0];
      const Eigen::Vector3d expected =
          body.X_WL.linear().transpose() * Eigen::Vector3d(0.0, 0.0, kGravity);
      sum += (specific_force(body) - expected).squaredNorm();
      EXPECT_LT(body.w_WL_W.norm(), 1e-8);
    }
    EXPECT_LT(std::sqrt(sum / 1000.0), 1e-6) << angle;
  }
}

TEST(VehicleStandstill, LowerTyrePressureLowersTheParkedVehicle) {
  WheeledVehicleParameters parameters;
  parameters.tyre_pressure.deflate_time_constant_s = 2.0;
  BareVehicle rig(slope(0.0), parameters);
  VehicleCommand command;
  command.tyre_pressure_pa.fill(1.2e5);
  rig.machine.command(command);
  rig.machine.step(60s);
  EXPECT_NEAR(rig.machine.tyre_pressure_pa(0), 1.2e5, 1.0);
  const TyreParameters& tyre = parameters.front.tyre;
  const auto stiffness = [&](double pressure) {
    return tyre.carcass_stiffness_npm + tyre.stiffness_per_pressure_m * pressure;
  };
  const double by = 1.0 / stiffness(1.2e5) - 1.0 / stiffness(4.5e5);
  for (std::size_t axle = 0; axle < 2; ++axle) {
    const double load = rig.machine.wheels()[2 * axle].load_n;
    const double height = rig.machine.links()[3 + 2 * axle].X_WL.translation().z();
    const double design = static_loads(parameters).wheel_height_m[axle];
    EXPECT_NEAR(height, design - load * by, 2e-4);
  }
}

TEST(VehicleStandstill, LowerTyrePressureSlowsTheRollingVehicle) {
  const auto way = [](double pressure) {
    WheeledVehicleParameters parameters;
    parameters.front.initial_pressure_pa = pressure;
    parameters.rear.initial_pressure_pa = pressure;
    BareVehicle rig(slope(0.0), parameters);
    rig.machine.command(released());
    rig.machine.start_rolling(5.0);
    rig.machine.step(3s);
    return rig.position().x();
  };
  EXPECT_LT(way(1.2e5), way(4.5e5) - 0.1);
}

}  // namespace
}  // namespace rigwire::sim::test
