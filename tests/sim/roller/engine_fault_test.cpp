// An engine that fails behind the roller's pump.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "roller_rig.h"

namespace rigwire::sim {
namespace {

using namespace test;

double engine_radps(const TandemRoller& machine) {
  return machine.vehicle_sample(machine.time()).engine.speed_radps;
}
double speed_mps(const TandemRoller& machine) {
  return machine.vehicle_sample(machine.time()).odometry.speed_mps;
}

TEST(RollerEngineFault, WithoutFuelItComesToRestAndTravelsOnWithIt) {
  const Ground ground = level();
  TandemRoller machine(bare(), ground, {0.0, 0.0}, 0.0);
  machine.command(travel(1.5));
  machine.step(8s);
  const double usual_radps = engine_radps(machine);
  const double usual_mps = speed_mps(machine);
  machine.fail({.fuel = false});
  machine.step(6s);
  EXPECT_LT(engine_radps(machine), 1e-3 * usual_radps);
  EXPECT_LT(std::abs(speed_mps(machine)), 0.02) << "a pump that stands holds the drums";
  machine.fail({});
  machine.step(8s);
  EXPECT_NEAR(engine_radps(machine), usual_radps, 1e-3 * usual_radps);
  EXPECT_NEAR(speed_mps(machine), usual_mps, 0.01);
}

/// Uphill, where the whole torque makes the speed.
TEST(RollerEngineFault, DeratedItGivesItsShareOfTheTorque) {
  const Ground ground = rising(10.0 * kDegree, 0.9);
  const auto climbs = [&](double share) {
    TandemRoller machine(bare(), ground, {0.0, 0.0}, 0.0);
    machine.fail({.torque_share = share});
    machine.command(travel(3.0));
    machine.step(12s);
    const EngineSample engine = machine.vehicle_sample(machine.time()).engine;
    RecordProperty("at_" + std::to_string(share), std::to_string(speed_mps(machine)) + " m/s, " +
                                                      std::to_string(engine.torque_nm) + " N m");
    return std::pair(speed_mps(machine), engine.torque_nm + engine.friction_nm);
  };
  const double reference_nm =
      HydrostaticDriveParameters{}.engine_torque_nm + HydrostaticDriveParameters{}.engine_drag_nm;
  const auto [well_mps, well_nm] = climbs(1.0);
  const auto [left_mps, left_nm] = climbs(0.5);
  EXPECT_GT(well_nm, 0.6 * reference_nm);
  EXPECT_NEAR(left_nm, 0.5 * reference_nm, 0.02 * reference_nm);
  EXPECT_LT(left_mps, 0.75 * well_mps);
  EXPECT_GT(left_mps, 0.1);
}

}  // namespace
}  // namespace rigwire::sim
