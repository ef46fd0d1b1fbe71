// Vehicles of every level against trunks, walls and posts: stopped or pushing, never through.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "../contact/free_body.h"
#include "allocation_counter.h"
#include "bench/machine_files.h"
#include "sim/driveline/parameters.h"
#include "sim/random.h"
#include "vehicle_rig.h"

namespace rigwire::sim::test {
namespace {

using Vector = Eigen::Vector3d;

Ground firm_with(std::vector<Obstacle> obstacles) {
  HeightField field;
  field.origin_m = {-100.0, -100.0};
  field.cell_m = 5.0;
  field.columns = field.rows = 41;
  field.heights_m.assign(41 * 41, 0.0);
  SoilParameters soil;
  soil.friction = 0.8;
  return Ground(field, SoilMap{{soil}, {}}, std::move(obstacles));
}

/// Level, and beyond x = 6 m higher by this.
Ground bank(double rise_m) {
  HeightField field;
  field.origin_m = {-10.0, -10.0};
  field.cell_m = 0.1;
  field.columns = 401;
  field.rows = 201;
  for (std::size_t i = 0; i < field.columns * field.rows; ++i) {
    field.heights_m.push_back(i % field.columns > 160 ? rise_m : 0.0);
  }
  SoilParameters soil;
  soil.friction = 0.8;
  return Ground(field, SoilMap{{soil}, {}}, {});
}

struct Drive {
  explicit Drive(Ground with, VehicleLevel level, double speed_mps, bool engine = false,
                 const VehiclePlace& place = {}, WheeledVehicleParameters parameters = {})
      : ground(std::move(with)) {
    parameters.level = level;
    std::unique_ptr<Driveline> driveline;
    if (engine) {
      driveline = make_driveline(DrivelineParameters{});
    } else {
      driveline = std::make_unique<BareDriveline>(&equations);
    }
    machine = make_wheeled_vehicle(parameters, ground, std::move(driveline), place);
    machine->command(released());
    machine->start_rolling(speed_mps);
  }

  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds / 1e-3); ++i) {
      machine->step(std::chrono::milliseconds(1));
      const ContactReport& report = *machine->contact_report();
      gain_j = std::max(gain_j, lost_j - report.lost_j);
      lost_j = std::max(lost_j, report.lost_j);
      deepest_m = std::max(deepest_m, report.deepest_m);
      const LinkMotion& body = machine->links()[0];
      fastest_mps = std::max(fastest_mps, body.v_WL_W.norm());
      farthest_m = std::max(farthest_m, body.X_WL.translation().x());
    }
  }
  [[nodiscard]] double x_m() const { return machine->links()[0].X_WL.translation().x(); }

  SpinEquations equations;
  Ground ground;
  std::unique_ptr<WheeledVehicle> machine;
  double gain_j = 0.0;
  double lost_j = 0.0;
  double deepest_m = 0.0;
  double fastest_mps = 0.0;
  double farthest_m = -1e9;
};

constexpr double kFront_m = 4.75;  // Front of the cab, before the rear axle.

class EveryLevel : public testing::TestWithParam<VehicleLevel> {};

TEST_P(EveryLevel, AThickTrunkIsNotDrivenThrough) {
  for (const double speed : {0.5, 5.0, 13.9}) {
    for (const double aside : {0.0, 0.6, -1.0}) {
      Drive run(firm_with({trunk_at(5.5, aside, 0.4, 12.0)}), GetParam(), speed);
      bool entered = false;
      for (int i = 0; i < 400; ++i) {
        run.run(10e-3);
        const Vector p = run.machine->links()[0].X_WL.inverse() * Vector(5.5, aside, 1.5);
        entered = entered || (p.x() > -0.9 && p.x() < 3.9 && std::abs(p.y()) < 0.7);
      }
      const std::string what = std::to_string(speed) + " m/s, " + std::to_string(aside) + " m";
      ASSERT_FALSE(run.machine->non_finite()) << what;
      EXPECT_GT(run.machine->contact_report()->touches, 0U) << what;
      EXPECT_FALSE(entered) << what;
      // The front, bent in by what 14 m/s do to it, and not a trunk's width farther; one that is
      // hit off its middle turns about the trunk.
      if (aside == 0.0) {
        EXPECT_LT(run.farthest_m, 5.5 - 0.4 - kFront_m + 0.75) << what;
      }
      EXPECT_LT(run.fastest_mps, 1.01 * speed + 0.01) << what;
      EXPECT_LT(run.gain_j, 0.02 * 0.5 * 5600.0 * speed * speed) << what;
    }
  }
}

TEST_P(EveryLevel, AWallStopsIt) {
  Drive run(firm_with({box_obstacle({15.0, 0.0, 1.5}, {1.0, 8.0, 1.5})}), GetParam(), 13.9);
  run.run(4.0);
  EXPECT_LT(run.farthest_m, 14.0 - kFront_m + 0.6);
  EXPECT_GT(run.lost_j, 0.3 * 0.5 * 5000.0 * 13.9 * 13.9);
}

// Levels that are carried by the ground under their wheels were lifted onto it.
TEST_P(EveryLevel, ABankStopsItAndItDrivesBack) {
  for (const auto& [rise_m, speeds_mps] :
       {std::pair{0.7, std::vector{1.0, 3.0}}, {1.0, {1.0, 3.0}}, {3.0, {1.0, 3.0, 13.9}}}) {
    for (const double speed_mps : speeds_mps) {
      Drive run(bank(rise_m), GetParam(), speed_mps);
      bool met = false;
      for (int i = 0; i < 300; ++i) {
        run.run(10e-3);
        met = met || run.machine->contact_report()->terrain;
      }
      const std::string what = std::to_string(rise_m) + " m, " + std::to_string(speed_mps) + " m/s";
      ASSERT_FALSE(run.machine->non_finite()) << what;
      EXPECT_TRUE(met) << what;
      EXPECT_LT(run.farthest_m, 6.0 - kFront_m + 0.9) << what;
      EXPECT_LT(run.deepest_m, 0.02) << what;
      EXPECT_LT(run.gain_j, 0.02 * 0.5 * 5600.0 * speed_mps * speed_mps) << what;
      EXPECT_LT(run.fastest_mps, 1.01 * speed_mps + 0.01) << what;
      run.machine->start_rolling(-1.0);
      const double stood_m = run.x_m();
      run.run(2.0);
      EXPECT_LT(run.x_m(), stood_m - 1.0) << what;
    }
  }
}

// 171 mm in trunks, 234 mm in a wall: what does not give is not entered.
TEST_P(EveryLevel, ABodyIsBentAndOverlapsByLessThanTwoCentimetres) {
  struct Case {
    const char* what;
    Obstacle obstacle;
    double speed_mps;
  };
  const Obstacle wall = box_obstacle({15.0, 0.0, 1.5}, {1.0, 8.0, 1.5});
  for (const Case& each : {Case{"wall", wall, 13.9}, Case{"wall, slow", wall, 2.0},
                           Case{"trunk", trunk_at(15.0, 0.3, 0.4, 12.0), 13.9},
                           Case{"trunk at a wheel", trunk_at(15.0, -1.0, 0.4, 12.0), 13.9}}) {
    Drive run(firm_with({each.obstacle}), GetParam(), each.speed_mps);
    double greatest_n = 0.0;
    for (int i = 0; i < 700; ++i) {
      run.run(10e-3);
      greatest_n = std::max(greatest_n, run.machine->contact_report()->force_n);
    }
    const ContactReport& report = *run.machine->contact_report();
    EXPECT_GT(report.touches, 0U) << each.what;
    EXPECT_LT(report.deepest_ever_m, 0.02) << each.what;
    EXPECT_LT(run.gain_j, 1.0) << each.what;
    EXPECT_LT(report.dent_m, 0.9) << each.what;
    if (each.speed_mps > 10.0) {
      EXPECT_GT(report.dent_m, 0.3) << each.what;
      // A frontal barrier gives 20 to 40 g.
      EXPECT_LT(greatest_n, 42.0 * 9.81 * WheeledVehicleParameters{}.mass_kg()) << each.what;
    }
  }
}

TEST_P(EveryLevel, ATrunkBesideTheFrameIsMetByTheTyre) {
  // Outside the cab's width, within the tyre's.
  WheeledVehicleParameters parameters;
  const double outside = 0.5 * parameters.front.track_m + 0.5 * parameters.front.tyre.width_m;
  const ContactBox& cab = parameters.solid.boxes.front();
  const double beside = outside + 0.05;
  ASSERT_LT(cab.position_m.y() + 0.5 * cab.size_m.y(), beside - 0.1);
  Drive run(firm_with({trunk_at(8.0, beside, 0.1, 8.0)}), GetParam(), 2.0);
  for (int i = 0; i < 40 && run.machine->contact_report()->touches == 0; ++i) {
    run.run(0.1);
  }
  ASSERT_GT(run.machine->contact_report()->touches, 0U);
  EXPECT_EQ(run.machine->contact_report()->body, "front_left_wheel");
}

TEST_P(EveryLevel, AYoungTreeIsRunOver) {
  Obstacle tree = trunk_at(10.0, 0.2, 0.05, 8.0);
  tree.strength_nm = 2.9e3;
  tree.stiffness_npm = 1e5;
  Drive run(firm_with({tree}), GetParam(), 5.0);
  run.run(3.0);
  EXPECT_EQ(run.machine->contact_report()->felled, 1U);
  EXPECT_GT(run.x_m(), 11.0);
  EXPECT_LT(run.machine->links()[0].v_WL_W.norm(), 5.0);
}

TEST_P(EveryLevel, NothingNearChangesNotOneBit) {
  Drive alone(firm_with({}), GetParam(), 5.0, true);
  Drive beside(firm_with({trunk_at(10.0, 3.0, 0.4, 12.0), trunk_at(14.0, -2.5, 0.2, 12.0)}),
               GetParam(), 5.0, true);
  alone.run(3.0);
  beside.run(3.0);
  EXPECT_EQ(alone.machine->links()[0].X_WL.matrix(), beside.machine->links()[0].X_WL.matrix());
  EXPECT_EQ(alone.machine->links()[6].X_WL.matrix(), beside.machine->links()[6].X_WL.matrix());
  EXPECT_EQ(beside.machine->contact_report()->touches, 0U);
}

TEST_P(EveryLevel, WedgedBetweenTwoTrunksAtFullThrottleItStaysWhereItIs) {
  Drive run(firm_with({trunk_at(9.0, 0.95, 0.3, 12.0), trunk_at(9.0, -0.95, 0.3, 12.0)}),
            GetParam(), 0.0, true);
  VehicleCommand command = released();
  command.gear = 1;
  command.engine_torque_share = 0.6;
  run.machine->command(command);
  const std::uint64_t before = rigwire::test::allocations();
  run.run(15.0);
  EXPECT_EQ(rigwire::test::allocations(), before);
  ASSERT_FALSE(run.machine->non_finite());
  EXPECT_GT(run.machine->contact_report()->points, 0U);
  EXPECT_GT(run.machine->contact_report()->force_n, 5e3);
  EXPECT_LT(run.farthest_m, 9.0 - kFront_m + 0.05);
  EXPECT_LT(run.machine->links()[0].v_WL_W.norm(), 0.05);
  EXPECT_LT(run.gain_j, 50.0);
  const ContactReport& report = *run.machine->contact_report();
  EXPECT_EQ(report.body, "cab");
  EXPECT_TRUE(report.obstacle);
}

TEST_P(EveryLevel, StraightDrivesThroughAForestEnterNoTrunk) {
  RandomStream random(4, "trunks");
  std::vector<Obstacle> trunks;
  for (int i = 0; i < 200; ++i) {
    const Vector place(random.uniform(-60.0, 60.0), random.uniform(-60.0, 60.0), 0.0);
    if (place.norm() > 8.0) {
      trunks.push_back(trunk_at(place.x(), place.y(), random.uniform(0.08, 0.3), 10.0));
    }
  }
  int stopped = 0;
  for (int i = 0; i < 8; ++i) {
    Drive run(firm_with(trunks), GetParam(), 5.0, false,
              {0.0, 0.0, 2.0 * std::numbers::pi * i / 8.0});
    run.run(10.0);
    ASSERT_FALSE(run.machine->non_finite()) << i;
    EXPECT_LT(run.gain_j, 0.02 * 0.5 * 5600.0 * 25.0) << i;
    EXPECT_LT(run.fastest_mps, 5.1) << i;
    EXPECT_EQ(run.machine->contact().dropped(), 0U);
    stopped += run.machine->contact_report()->touches > 0 ? 1 : 0;
    // No trunk's middle inside the cab.
    for (const Obstacle& trunk : trunks) {
      const Vector p = run.machine->links()[0].X_WL.inverse() *
                       Vector(trunk.X_WO.translation().x(), trunk.X_WO.translation().y(), 1.5);
      EXPECT_FALSE(p.x() > -0.9 && p.x() < 4.6 && std::abs(p.y()) < 0.95) << i;
    }
  }
  EXPECT_GT(stopped, 4);
}

// Between half a wheel's radius, up to which the ground's follower looked, and the axle, from which
// on the contact did, blocks, fallen trunks and rocks were driven through.
TEST_P(EveryLevel, WhatIsNotRolledOverStopsIt) {
  if (GetParam() == VehicleLevel::full) {
    return;  // It lifts its wheels by forces.
  }
  constexpr double kFrom_m = 10.0;
  constexpr double kLong_m = 10.0;
  const WheeledVehicleParameters gator = bench::gator_855d().vehicle;
  for (const WheeledVehicleParameters& vehicle : {WheeledVehicleParameters(), gator}) {
    const double half_radius_m = 0.5 * vehicle.front.tyre.unloaded_radius_m;
    for (const ObstacleShape shape :
         {ObstacleShape::box, ObstacleShape::cylinder, ObstacleShape::sphere}) {
      for (double height_m = 0.05; height_m < 1.21; height_m += 0.05) {
        Obstacle obstacle =
            box_obstacle({kFrom_m + 0.5 * kLong_m, 0.0, 0.0}, {0.5 * kLong_m, 10.0, height_m});
        double end_m = kFrom_m + kLong_m;
        double aside_m = 0.0;
        if (shape == ObstacleShape::cylinder) {  // A trunk that lies across, half in the ground.
          obstacle = trunk_at(0.0, 0.0, height_m, 20.0);
          obstacle.X_WO.linear() =
              Eigen::AngleAxisd(-0.5 * std::numbers::pi, Vector::UnitX()).matrix();
          obstacle.X_WO.translation() << kFrom_m + height_m, 0.0, 0.0;
          end_m = kFrom_m + 2.0 * height_m;
        } else if (shape == ObstacleShape::sphere) {  // A rock in the way of the left wheels.
          aside_m = 0.5 * vehicle.front.track_m;
          obstacle = rock_at({kFrom_m + height_m, aside_m, 0.0}, height_m);
          end_m = kFrom_m + 2.0 * height_m;
        }
        Drive run(firm_with({obstacle}), GetParam(), 4.0, false, {}, vehicle);
        double lowest_m = 1e9;
        for (int i = 0; i < 800; ++i) {
          run.run(10e-3);
          // A wheel's hub over the middle of the obstacle.
          for (std::size_t wheel = 3; wheel < 7; ++wheel) {
            const Vector hub_W = run.machine->links()[wheel].X_WL.translation();
            const bool aside = shape == ObstacleShape::sphere && wheel % 2 == 0;
            if (!aside && std::abs(hub_W.x() - 0.5 * (kFrom_m + end_m)) < 0.1) {
              lowest_m = std::min(lowest_m, hub_W.z());
            }
          }
        }
        const std::string what =
            std::to_string(static_cast<int>(shape)) + ", " + std::to_string(height_m) + " m";
        const bool passed = run.x_m() > end_m + 0.5;
        ASSERT_FALSE(run.machine->non_finite()) << what;
        EXPECT_GT(lowest_m, vehicle.front.tyre.unloaded_radius_m + 0.3 * height_m - 0.1) << what;
        EXPECT_EQ(passed, height_m <= half_radius_m) << what;
        if (passed) {
          EXPECT_LT(run.deepest_m, 1e-9) << what;
        } else {
          // A ball that is little higher lifts a front tyre that is pressed far in, and stops the
          // rear.
          if (shape != ObstacleShape::sphere || height_m > half_radius_m + 0.04) {
            EXPECT_LT(run.farthest_m, kFrom_m - vehicle.front.position_x_m + 0.1) << what;
          }
          EXPECT_GT(run.machine->contact_report()->touches, 0U) << what;
        }
      }
    }
  }
}

// There was nothing between the wheels but the frame, 0.64 m above the ground; the maker has 0.48
// m.
TEST_P(EveryLevel, ItsAxlesPassOverWhatIsLowerThanTheGroundClearance) {
  for (const double height_m : {0.40, 0.46, 0.52, 0.62}) {
    // Between the wheels, 1.545 m apart.
    Drive run(firm_with({box_obstacle({8.0, 0.0, 0.0}, {0.3, 0.5, height_m})}), GetParam(), 1.5);
    run.run(8.0);
    ASSERT_FALSE(run.machine->non_finite()) << height_m;
    const bool passes = height_m < 0.48;
    EXPECT_EQ(run.x_m() > 8.3, passes) << height_m;
    EXPECT_EQ(run.machine->contact_report()->touches > 0, !passes) << height_m;
    if (!passes) {
      EXPECT_LT(run.farthest_m, 7.7 - 3.85 - 0.175 + 0.02) << height_m;
      EXPECT_LT(run.deepest_m, 0.02) << height_m;
      EXPECT_LT(run.gain_j, 1.0) << height_m;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Levels, EveryLevel,
                         testing::Values(VehicleLevel::kinematic, VehicleLevel::planar,
                                         VehicleLevel::full),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace rigwire::sim::test
