// The roller's own controller of its travel speed: reached against load, held at 0, and said where
// it cannot be had.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "roller_rig.h"

namespace rigwire::sim {
namespace {

using namespace test;

RollerParameters controlled() {
  RollerParameters parameters;
  parameters.travel_control = true;
  return parameters;
}

TEST(RollerTravelControl, SpeedThatIsCommandedIsReachedOnSlopesBothWays) {
  for (const double slope_rad : {0.0, 8.0 * kDegree, -8.0 * kDegree}) {
    for (const double wanted_mps : {0.5, 1.5, -1.0}) {
      const Ground ground = rising(slope_rad, 0.8);
      TandemRoller machine(controlled(), ground, {0.0, 0.0}, 0.0);
      machine.command(travel(wanted_mps));
      machine.step(12s);
      double least = 1e9;
      double most = -1e9;
      for (int i = 0; i < 400; ++i) {
        machine.step(10ms);
        const double speed_mps = machine.vehicle_sample(machine.time()).odometry.speed_mps;
        least = std::min(least, speed_mps);
        most = std::max(most, speed_mps);
      }
      EXPECT_NEAR(least, wanted_mps, 0.02) << slope_rad << " rad, " << wanted_mps << " m/s";
      EXPECT_NEAR(most, wanted_mps, 0.02) << slope_rad << " rad, " << wanted_mps << " m/s";
      EXPECT_EQ(machine.vehicle_sample(machine.time()).travel_limit, TravelLimit::none);
    }
  }
}

TEST(RollerTravelControl, ZeroStopsAndHoldsOnASlope) {
  for (const double slope_rad : {10.0 * kDegree, -10.0 * kDegree}) {
    const Ground ground = rising(slope_rad, 0.8);
    TandemRoller machine(controlled(), ground, {0.0, 0.0}, 0.0);
    machine.command(travel(1.0));
    machine.step(6s);
    machine.command(travel(0.0));
    machine.step(6s);
    const double at_m = position(machine).x();
    machine.step(20s);
    EXPECT_LT(std::abs(position(machine).x() - at_m), 5e-3) << slope_rad;
    EXPECT_GT(machine.vehicle_sample(machine.time()).brake_share, 0.99);
  }
}

TEST(RollerTravelControl, ASpeedThatTheEngineCannotHaveIsSaid) {
  const Ground ground = rising(15.0 * kDegree, 0.9);
  TandemRoller machine(controlled(), ground, {0.0, 0.0}, 0.0);
  machine.command(travel(2.5));
  machine.step(10s);
  EXPECT_LT(own_velocity(machine).x(), 2.3);
  EXPECT_GT(own_velocity(machine).x(), 0.1);
  EXPECT_EQ(machine.vehicle_sample(machine.time()).travel_limit, TravelLimit::power);
}

TEST(RollerTravelControl, WithoutItThePumpAloneFollows) {
  const Ground ground = rising(8.0 * kDegree, 0.8);
  RollerParameters parameters = controlled();
  parameters.travel_control = false;
  TandemRoller loose(parameters, ground, {0.0, 0.0}, 0.0);
  TandemRoller held(controlled(), ground, {0.0, 0.0}, 0.0);
  for (TandemRoller* machine : {&loose, &held}) {
    machine->command(travel(1.5));
    machine->step(12s);
  }
  const auto missing = [](const TandemRoller& machine) {
    return std::abs(machine.vehicle_sample(machine.time()).odometry.speed_mps - 1.5);
  };
  EXPECT_LT(missing(held), 0.02);
  EXPECT_GT(missing(loose), missing(held)) << "leakage under load";
}

}  // namespace
}  // namespace rigwire::sim
