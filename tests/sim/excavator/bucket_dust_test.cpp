// Dust of a bucket: where soil goes in or out, as much as its flow and its fall make.
#include <gtest/gtest.h>

#include <cmath>

#include "digging_site.h"

namespace rigwire::sim {
namespace {

using namespace test;
using std::chrono::milliseconds;

/// Mass stirred up while the valves are open so.
double stirred_kg(Site& site, double seconds, double stick, double bucket) {
  ValveCommand command;
  command.opening = {0.0, 0.0, stick, bucket};
  site.machine.valve_port()->command(command);
  double mass_kg = 0.0;
  for (int i = 0; i < static_cast<int>(std::lround(seconds * 500.0)); ++i) {
    site.machine.step(milliseconds(2));
    mass_kg += 2e-3 * site.machine.dust_emitters()[0].mass_rate_kgps;
  }
  return mass_kg;
}

TEST(BucketDust, NothingIsStirredUpWhileNoSoilMoves) {
  Site site;
  EXPECT_EQ(stirred_kg(site, 1.0, 0.0, 0.0), 0.0);
}

TEST(BucketDust, DumpingStirsUpByVolumeAndFall) {
  Site site;
  site.dig();
  const double load_m3 = site.machine.bucket().volume_m3();
  ASSERT_GT(load_m3, 0.5);
  site.run(1.0, 0.0, 0.0, 0.0, 0.0);
  const Eigen::Vector3d before_W = site.machine.dust_emitters()[0].position_W;
  const double mass_kg = stirred_kg(site, 8.0, 0.0, -0.9);
  ASSERT_EQ(site.machine.bucket().units(), 0);
  const DustEmitter& emitter = site.machine.dust_emitters()[0];
  // The lip turns while it empties: the fall is somewhere between a bucket's length and its height.
  EXPECT_GT(mass_kg, load_m3 * dropped_soil_dust_kgpm3(0.3));
  EXPECT_LT(mass_kg, load_m3 * dropped_soil_dust_kgpm3(6.0));
  EXPECT_LT((emitter.position_W - before_W).norm(), 6.0);
  EXPECT_EQ(emitter.mass_rate_kgps, 0.0);
}

TEST(BucketDust, DiggingStirsUpLess) {
  Site digging;
  digging.run(0.75, 0.0, -0.35, 0.0, 0.0);
  const double before_m3 = digging.machine.bucket().volume_m3();
  const double mass_kg = stirred_kg(digging, 4.0, 0.6, 0.1);
  const double volume_m3 = digging.machine.bucket().volume_m3() - before_m3;
  ASSERT_GT(volume_m3, 0.1);
  // What runs over the lip again counts twice.
  EXPECT_GT(mass_kg, 0.9 * volume_m3 * dropped_soil_dust_kgpm3(0.3));
  EXPECT_LT(mass_kg, 4.0 * volume_m3 * dropped_soil_dust_kgpm3(0.3));
}

}  // namespace
}  // namespace rigwire::sim
