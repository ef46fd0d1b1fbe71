// The roller at kerbs and walls: climbs what it can, is stopped by what it cannot.
#include <gtest/gtest.h>

#include "../contact/free_body.h"
#include "roller_rig.h"

namespace rigwire::sim::test {
namespace {

Ground road_with(std::vector<Obstacle> obstacles) {
  HeightField field;
  field.origin_m = {-50.0, -50.0};
  field.cell_m = 5.0;
  field.columns = field.rows = 21;
  field.heights_m.assign(21 * 21, 0.0);
  return Ground(field, SoilMap{{surface(0.8)}, {}}, std::move(obstacles));
}

TEST(RollerObstacles, AWallStopsIt) {
  for (const RollerLevel level : {RollerLevel::kinematic, RollerLevel::dynamic}) {
    const Ground ground = road_with({box_obstacle({8.0, 0.0, 1.5}, {0.5, 6.0, 1.5})});
    RollerParameters p;
    p.level = level;
    TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
    machine.command(travel(1.5));
    double lost = 0.0;
    double gain = 0.0;
    for (int i = 0; i < 15000; ++i) {
      machine.step(1ms);
      gain = std::max(gain, lost - machine.contact_report()->lost_j);
      lost = std::max(lost, machine.contact_report()->lost_j);
    }
    // The front drum's rim: pivot and radius ahead.
    EXPECT_LT(position(machine).x(), 7.5 - 1.7 - 0.61 + 0.03);
    EXPECT_GT(position(machine).x(), 4.5);
    EXPECT_GT(machine.contact_report()->touches, 0U);
    EXPECT_EQ(machine.contact_report()->body, "front_drum");
    EXPECT_LT(gain, 50.0);
    machine.command(travel(-1.0));
    machine.step(4s);
    EXPECT_LT(position(machine).x(), 4.5);
    EXPECT_EQ(machine.contact_report()->points, 0U);
  }
}

TEST(RollerObstacles, AKerbIsClimbedOverTheDrumsArcWithoutABlow) {
  const Ground ground = road_with({box_obstacle({8.0, 0.0, 0.0}, {3.0, 6.0, 0.12})});
  TandemRoller machine({}, ground, {0.0, 0.0}, 0.0);
  machine.command(travel(1.2));
  double most = 0.0;
  double highest = 0.0;
  for (int i = 0; i < 8000; ++i) {
    machine.step(1ms);
    most = std::max(most, frame(machine).a_WL_W.norm());
    highest = std::max(highest, position(machine).z());
  }
  EXPECT_FALSE(machine.non_finite());
  // The frame's middle gains the kerb's height, and its acceleration stays within the 8 g of its
  // IMU; from one step to the next it was 217 m/s2.
  EXPECT_GT(highest, 0.1);
  EXPECT_LT(most, 60.0);
}

TEST(RollerObstacles, NothingNearChangesNotOneBit) {
  const Ground empty = road_with({});
  const Ground beside = road_with({trunk_at(6.0, 5.0, 0.3, 8.0)});
  TandemRoller one({}, empty, {0.0, 0.0}, 0.0);
  TandemRoller other({}, beside, {0.0, 0.0}, 0.0);
  one.command(travel(1.2));
  other.command(travel(1.2));
  one.step(6s);
  other.step(6s);
  EXPECT_EQ(frame(one).X_WL.matrix(), frame(other).X_WL.matrix());
}

}  // namespace
}  // namespace rigwire::sim::test
