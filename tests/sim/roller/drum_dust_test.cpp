// Dust of drums: that of a road, by load and speed.
#include <gtest/gtest.h>

#include "roller_rig.h"

namespace rigwire::sim {
namespace {

using namespace test;

double dust_kgps(const TandemRoller& machine) {
  double sum = 0.0;
  for (const DustEmitter& emitter : machine.dust_emitters()) {
    sum += emitter.mass_rate_kgps;
  }
  return sum;
}

TEST(DrumDust, IsThatOfARoadByTheSpeed) {
  const Ground ground = level();
  TandemRoller machine(bare(), ground, {0.0, 0.0}, 0.0);
  machine.step(100ms);
  EXPECT_LT(dust_kgps(machine), 1e-6);
  machine.command(travel(2.0));
  for (int i = 0; i < 100; ++i) {
    machine.step(100ms);
  }
  const double speed_mps = machine.links()[0].v_WL_W.norm();
  ASSERT_GT(speed_mps, 1.0);
  EXPECT_NEAR(dust_kgps(machine) / (road_dust_kgpm(machine.mass().mass_kg) * speed_mps), 1.0, 0.05);
  const auto drums = machine.dust_emitters();
  EXPECT_NEAR((drums[0].position_W - drums[1].position_W).norm(),
              2.0 * machine.parameters().pivot_x_m, 0.05);
  EXPECT_NEAR(drums[0].position_W.z(), 0.0, 0.05);
}

}  // namespace
}  // namespace rigwire::sim
