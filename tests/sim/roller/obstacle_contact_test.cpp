// The roller at kerbs and walls: climbs what it can, is stopped by what it cannot.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "../contact/free_body.h"
#include "roller_rig.h"
#include "sim/contact/closest.h"
#include "sim/contact/loose_bodies.h"
#include "sim/contact/rolling_climb.h"

namespace rigwire::sim::test {
namespace {

Ground road_with(std::vector<Obstacle> obstacles, double friction = 0.8) {
  HeightField field;
  field.origin_m = {-50.0, -50.0};
  field.cell_m = 5.0;
  field.columns = field.rows = 21;
  field.heights_m.assign(21 * 21, 0.0);
  return Ground(field, SoilMap{{surface(friction)}, {}}, std::move(obstacles));
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

struct Road {
  double friction;
  double limit_m;  ///< R (1 - cos t), t = atan(0.75 x 0.7) + atan(0.75 x friction).
};
constexpr std::array<Road, 4> kRoads{{{0.1, 0.0926}, {0.2, 0.1179}, {0.4, 0.1742}, {0.8, 0.2928}}};

/// Drives slowly against a step in the road, for 11 s: a block of friction 0.7, or
/// terrain.
struct Step {
  Step(double friction, double height_m, RollerLevel level)
      : Step(road_with({box_obstacle({9.0, 0.0, 0.0}, {5.0, 6.0, height_m}, 0.7)}, friction),
             level) {}
  Step(Ground with, RollerLevel level)
      : ground(std::move(with)), machine(at_level(level), ground, {1.0, 0.0}, 0.0) {
    VehicleCommand command = travel(0.2);
    command.lock[static_cast<std::size_t>(Differential::centre)] = true;
    machine.command(command);
    for (int i = 0; i < 11000; ++i) {
      machine.step(1ms);
      late_m = i == 9000 ? position(machine).x() : late_m;
      highest_m = std::max(highest_m, machine.links()[3].X_WL.translation().z() - 0.61);
      most_mps2 = std::max(most_mps2, frame(machine).a_WL_W.norm());
    }
  }
  static RollerParameters at_level(RollerLevel level) {
    RollerParameters p;
    p.level = level;
    return p;
  }
  [[nodiscard]] bool climbed() const { return position(machine).x() + 1.7 > 4.2; }

  Ground ground;
  TandemRoller machine;
  double highest_m = 0.0;  ///< Greatest height of the front drum.
  double most_mps2 = 0.0;
  double late_m = 0.0;  ///< Where it was 2 s before the end.
};

/// Terrain that is level, and higher from x = 4 m on.
Ground raised(double rise_m, double friction) {
  HeightField field;
  field.origin_m = {-10.0, -10.0};
  field.cell_m = 0.05;
  field.columns = 401;
  field.rows = 401;
  for (std::size_t i = 0; i < field.columns * field.rows; ++i) {
    field.heights_m.push_back(i % field.columns > 280 ? rise_m : 0.0);
  }
  return Ground(field, SoilMap{{surface(friction)}, {}}, {});
}

// A block of 0.6 m was climbed at 0.3 m/s on a friction of 0.2.
TEST(RollerObstacles, ItStopsBeforeWhatItsDrumsDoNotBringItOver) {
  for (const RollerLevel level : {RollerLevel::dynamic, RollerLevel::kinematic}) {
    for (const Road& road : kRoads) {
      const double t = std::atan(0.75 * 0.7) + std::atan(0.75 * road.friction);
      ASSERT_NEAR(0.61 * (1.0 - std::cos(t)), road.limit_m, 1e-3);
      for (const double height_m : {1.15 * road.limit_m, 0.4, 0.6}) {
        const Step step(road.friction, height_m, level);
        const std::string what = std::to_string(road.friction) + ", " + std::to_string(height_m);
        EXPECT_FALSE(step.machine.non_finite()) << what;
        EXPECT_FALSE(step.climbed()) << what;
        EXPECT_FALSE(step.machine.tipped()) << what;
        EXPECT_LT(step.highest_m, 0.02) << what;
        // The rim is at the block's edge, and not in it.
        const double before_m = std::sqrt(height_m * (2.0 * 0.61 - height_m));
        EXPECT_NEAR(position(step.machine).x() + 1.7 + before_m, 4.0, 0.02) << what;
        // Its drums slip and hold by turns: it shakes on its springs.
        EXPECT_NEAR(position(step.machine).x(), step.late_m, 4e-3) << what;
      }
      for (const double height_m : {0.3, 0.5}) {
        const Step step(raised(height_m, road.friction), level);
        // Both drums have the terrain's friction.
        const double most_m = 0.61 * (1.0 - std::cos(2.0 * std::atan(0.75 * road.friction)));
        EXPECT_EQ(step.climbed(), height_m < most_m) << road.friction << ", terrain " << height_m;
      }
    }
  }
}

TEST(RollerObstacles, ItClimbsWhatBothDrumsFrictionBringsItOver) {
  for (const RollerLevel level : {RollerLevel::dynamic, RollerLevel::kinematic}) {
    for (const Road& road : kRoads) {
      const Step step(road.friction, 0.85 * road.limit_m, level);
      EXPECT_TRUE(step.climbed()) << road.friction;
      EXPECT_NEAR(step.highest_m, 0.85 * road.limit_m, 5e-3) << road.friction;
      EXPECT_LT(step.most_mps2, 8.0 * kGravity) << road.friction;
    }
  }
}

// With v = 1 m/s and t = 35 degrees there are 7 cm more of way up in its motion.
TEST(RollerObstacles, WithARunItComesHigher) {
  const RollingClimb rests{0.61, 0.75, std::atan(0.75 * 0.2), 0.0};
  const RollingClimb runs{0.61, 0.75, std::atan(0.75 * 0.2), 1.0 / kGravity};
  EXPECT_NEAR(rests.height_m(0.7), 0.1179, 1e-3);
  const double c = 1.0 - rests.height_m(0.7) / 0.61;
  EXPECT_NEAR(runs.height_m(0.7) - rests.height_m(0.7), c * c / kGravity, 1e-9);
  EXPECT_EQ(RollingClimb({0.61, 1.0, 2.0, 9.0}).height_m(5.0), 0.7 * 0.61);  // 72 degrees round.
  EXPECT_EQ(RollingClimb({0.61, 1.0, 0.0, 0.0}).height_m(0.0), 0.0);
}

TEST(RollerObstacles, ACrateThatItPushesStaysOutsideOfIt) {
  for (const double step_s : {5e-4, 1e-3, 2e-3}) {
    for (const bool wall : {true, false}) {
      constexpr double kCrate_m = 1.2;
      const double middle_m = 1.7 + 0.61 + 0.5 + 0.5 * kCrate_m;
      Ground ground =
          road_with(wall ? std::vector{box_obstacle({middle_m + 1.12, 0.0, 1.5}, {0.5, 6.0, 1.5})}
                         : std::vector<Obstacle>());
      LooseBody crate{.name = "crate", .shape = ConvexShape::box({0.6, 0.78, 0.6})};
      crate.mass_kg = 2000.0;
      crate.inertia_kgm2.setConstant(560.0);
      crate.X_WB.translation() << middle_m, 0.05, 0.6;
      ground.set_loose({crate});
      ground.loose()->settle(5.0);
      RollerParameters p;
      p.step_s = step_s;
      TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
      machine.command(travel(1.0));
      const auto deepest = [&] {
        double found = 0.0;
        const Mover& mover = ground.loose()->movers()[0];
        for (const ContactBody& body : machine.contact().bodies()) {
          const Eigen::Isometry3d X_WS = machine.links()[body.link].X_WL * body.X_LS;
          found = std::max(found,
                           -separation({&body.shape, X_WS}, {mover.shape, mover.X_WM}, 0.0).gap_m);
        }
        return found;
      };
      double late_m = 0.0;
      const int steps = static_cast<int>(std::lround(60.0 / step_s));
      for (int i = 0; i < steps && position(machine).x() < 40.0; ++i) {
        machine.step(from_seconds(step_s));
        if (i % 50 == 0 && i * step_s > 5.0) {
          late_m = std::max(late_m, deepest());
        }
      }
      EXPECT_LT(late_m, 0.01) << step_s << " " << wall;
      EXPECT_GT(machine.contact_report()->force_n, 5e3) << step_s << " " << wall;
    }
  }
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
