// Dust of wheels: that of a road, by load and speed.
#include <gtest/gtest.h>

#include "vehicle_rig.h"

namespace rigwire::sim {
namespace {

using namespace test;
using std::chrono::milliseconds;

double dust_kgps(const Machine& machine) {
  double sum = 0.0;
  for (const DustEmitter& emitter : machine.dust_emitters()) {
    sum += emitter.mass_rate_kgps;
  }
  return sum;
}

TEST(WheelDust, AVehicleAtRestMakesNone) {
  BareVehicle vehicle(slope(0.0));
  vehicle.machine.command(braked());
  for (int i = 0; i < 500; ++i) {
    vehicle.machine.step(milliseconds(10));
  }
  EXPECT_LT(dust_kgps(vehicle.machine), 1e-6);
}

TEST(WheelDust, ARollingVehicleMakesThatOfARoad) {
  BareVehicle vehicle(slope(0.0));
  vehicle.machine.command(released());
  vehicle.machine.start_rolling(8.0);
  for (int i = 0; i < 50; ++i) {
    vehicle.machine.step(milliseconds(10));
  }
  const double road_kgpm = road_dust_kgpm(vehicle.machine.parameters().mass_kg());
  EXPECT_NEAR(dust_kgps(vehicle.machine) / (road_kgpm * vehicle.speed()), 1.0, 0.02);
  for (const DustEmitter& emitter : vehicle.machine.dust_emitters()) {
    EXPECT_GT(emitter.mass_rate_kgps, 0.0);
    EXPECT_NEAR(emitter.position_W.z(), 0.0, 0.1);
  }
}

}  // namespace
}  // namespace rigwire::sim
