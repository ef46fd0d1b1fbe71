// The path follower's decisions on a vehicle without dynamics.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "path_follow/path_mission.h"
#include "vehicle_plant.h"

namespace rigwire::path_follow {
namespace {

using field::PlanePosition;
using field::Polyline;
using testing::HasSubstr;

constexpr double kStep_s = 0.02;

/// A closed track with bends of about 12 m radius, like that of the forest.
Polyline track() {
  std::vector<PlanePosition> points;
  for (int i = 0; i < 600; ++i) {
    const double a = 2.0 * std::numbers::pi * i / 600;
    const double r = 42.0 + 7.0 * std::sin(3.0 * a);
    points.push_back({r * std::cos(a), r * std::sin(a)});
  }
  return {std::move(points), true};
}

struct Result {
  double worst_m = 0.0;  ///< True distance from the path after the first 15 m.
  double fastest_mps = 0.0;
  bool done = false;
  std::optional<std::string> fault;
  double end_speed_mps = 0.0;
};

struct Case {
  double wander_m = 0.0;
  double white_m = 0.0;
  double start_offset_m = 0.0;
  double heading_error_rad = 0.0;
  double limit_s = 400.0;
};

Result run(PathMission& mission, const Polyline& path, const Case& how) {
  field::VehiclePlant plant;
  const double direction = path.direction_rad(0.0);
  plant.position = path.at(0.0);
  plant.position.east_m -= how.start_offset_m * std::sin(direction);
  plant.position.north_m += how.start_offset_m * std::cos(direction);
  plant.heading_rad = direction + how.heading_error_rad;
  field::TestReceiver receiver(how.wander_m, how.white_m, 3);
  field::PoseEstimatorSettings settings;
  settings.gnss_age_s = 0.0;
  settings.gnss_sigma_m = how.wander_m > 0.0 ? 1.5 : 0.1;
  field::PoseEstimator estimator(settings);
  const PlanePosition first = receiver.measure(plant.position, 1.0);
  const auto start = mission.start(first);
  estimator.start(first, start.heading_rad, start.sigma_rad);
  const SpeedControlSettings drive;
  Result result;
  field::VehicleReadings readings;
  readings.gear = 2;
  double way_m = 0.0;
  const int steps = static_cast<int>(how.limit_s / kStep_s);
  for (int i = 1; i <= steps && !mission.done() && !mission.fault(); ++i) {
    estimator.advance(kStep_s, plant.speed_mps, plant.slip_rad, plant.yaw_rate_radps);
    if (i % 50 == 0) {
      estimator.position(receiver.measure(plant.position, 1.0));
      estimator.course(plant.heading_rad + plant.slip_rad, plant.speed_mps);
    }
    const auto orders = mission.update(estimator.pose(), readings, kStep_s);
    plant.curvature_1pm = orders.curvature_1pm.value_or(0.0);
    // Engine, gearbox and wheels as one stiff thing with the ratio of gear 2, 5 % off.
    const double engine = orders.engine_speed_radps.value_or(0.0);
    plant.wish_mps = engine > 80.0 ? engine / (1.05 * drive.engine_per_speed[1]) : 0.0;
    plant.brake_mps2 = orders.brake_mps2;
    plant.step(kStep_s);
    readings.engine_speed_radps = plant.speed_mps * 1.05 * drive.engine_per_speed[1];
    way_m += plant.speed_mps * kStep_s;
    result.fastest_mps = std::max(result.fastest_mps, plant.speed_mps);
    if (way_m > 15.0) {
      result.worst_m = std::max(result.worst_m, std::abs(path.nearest(plant.position).offset_m));
    }
  }
  result.done = mission.done();
  result.fault = mission.fault();
  result.end_speed_mps = plant.speed_mps;
  return result;
}

TEST(PathFollowClosedLoop, StaysWithinHalfAMetreWithGoodSensors) {
  const Polyline path = track();
  PathMission mission(path, {});
  const Result result = run(mission, path, {.start_offset_m = 1.0, .heading_error_rad = 0.15});
  EXPECT_TRUE(result.done) << mission.progress();
  EXPECT_LT(result.worst_m, 0.5);
  EXPECT_NEAR(result.fastest_mps, 2.0, 0.3);
  EXPECT_LT(result.end_speed_mps, 0.8) << "slows down towards the end";
}

TEST(PathFollowClosedLoop, ToleratesAReceiverThatWandersByMetres) {
  const Polyline path = track();
  PathMission mission(path, {});
  const Result result = run(mission, path, {.wander_m = 1.0, .white_m = 0.6});
  EXPECT_TRUE(result.done) << mission.progress() << result.fault.value_or("");
  EXPECT_LT(result.worst_m, 3.0);
}

TEST(PathFollowClosedLoop, GivesUpOffThePath) {
  const Polyline path = track();
  PathMission mission(path, {});
  const Result result = run(mission, path, {.start_offset_m = 5.0, .limit_s = 5.0});
  EXPECT_THAT(result.fault.value_or(""), HasSubstr("off the path, allowed 3.50 m"));
}

TEST(PathFollowClosedLoop, StopsAtTheEndOfAnOpenPath) {
  const Polyline path({{0, 0}, {20, 0}, {40, 5}, {60, 5}}, false);
  PathMission mission(path, {});
  const Result result = run(mission, path, {});
  EXPECT_TRUE(result.done);
  EXPECT_LT(result.end_speed_mps, 0.8);
}

TEST(PathFollowMission, HaltsWithBrakeAndParksOnlyWhenStanding) {
  PathMission mission(track(), {});
  const auto moving = mission.halt({}, false);
  EXPECT_FALSE(moving.parking_brake);
  EXPECT_GT(moving.brake_mps2, 1.0);
  EXPECT_EQ(moving.gear, 0);
  EXPECT_EQ(moving.engine_torque_share, 0.0);
  EXPECT_TRUE(mission.halt({}, true).parking_brake);
}

TEST(PathFollowMission, VehicleThatDoesNotMoveIsAFault) {
  PathMission mission(track(), {});
  const Polyline path = track();
  const PlanePosition begin = path.at(0.0);
  field::Pose pose;
  pose.position = begin;
  pose.heading_rad = mission.start(begin).heading_rad;
  for (int i = 0; i < 1000; ++i) {
    (void)mission.update(pose, {}, kStep_s);
  }
  EXPECT_THAT(
      mission.fault().value_or(""),
      HasSubstr("the vehicle does not move: asked for 0.8 m/s, its wheels have not turned"));
}

TEST(PathFollowMission, WheelsThatTurnBeforeATrunkAreAFaultThatSaysSo) {
  PathMission mission(track(), {});
  field::Pose pose;
  pose.position = track().at(0.0);
  pose.heading_rad = mission.start(pose.position).heading_rad;
  const PlanePosition held = pose.position;
  for (int i = 0; i < 1000; ++i) {
    // The receiver's place wanders by half a metre.
    pose.position.east_m = held.east_m + 0.5 * std::sin(0.01 * i);
    pose.speed_mps = 1.2;
    (void)mission.update(pose, {}, kStep_s);
    ASSERT_TRUE(i < 400 ? !mission.fault() : true);
  }
  EXPECT_THAT(mission.fault().value_or(""),
              HasSubstr("the wheels turn, but the vehicle stays where it is: 12 m by the wheels"));
}

/// Columns of points from the ground up, as a lidar sees a thing; in the vehicle's frame.
void see_column(WayWatch& way, double x_m, double y_m, double height_m) {
  for (double z_m = 0.05; z_m < height_m; z_m += 0.15) {
    way.add({x_m, y_m, z_m});
  }
}

class PathFollowWay : public testing::Test {
 protected:
  void look(const std::function<void(WayWatch&)>& revolution) {
    for (int i = 0; i < 2; ++i) {
      revolution(way);
      way.finish_revolution(pose, follower);
    }
  }
  Follower follower{Polyline({{0, 0}, {30, 0}, {60, 30}}, false), {}};
  WayWatch way;
  field::Pose pose;
};

TEST_F(PathFollowWay, AThingOnTheLineIsInTheWayWhateverBendsLieBetween) {
  (void)follower.start({0.0, 0.0});
  look([](WayWatch& w) { see_column(w, 12.0, 0.9, 3.0); });
  ASSERT_TRUE(way.nearest());
  EXPECT_NEAR(way.nearest()->ahead_m, 12.0 - 4.8, 0.2);
  EXPECT_NEAR(way.nearest()->offset_m, 0.9, 0.2);
  // Round the bend; straight ahead of the vehicle it would be 4 m beside the path.
  look([](WayWatch& w) { see_column(w, 34.0, 4.1, 3.0); });
  ASSERT_TRUE(way.nearest());
  EXPECT_NEAR(way.nearest()->ahead_m, 30.0 + 4.0 * std::numbers::sqrt2 - 4.8, 0.4);
  look([](WayWatch& w) { see_column(w, 34.0, 0.0, 3.0); });
  EXPECT_FALSE(way.nearest()) << "straight on, where the path leaves to the left";
}

TEST_F(PathFollowWay, GroundCrownsAndOneSightingAreNoObstacle) {
  (void)follower.start({0.0, 0.0});
  look([](WayWatch& w) {
    for (double x_m = 5.0; x_m < 30.0; x_m += 0.1) {
      for (double y_m = -3.0; y_m < 3.0; y_m += 0.1) {
        w.add({x_m, y_m, 0.3 * (x_m - 5.0) - 1.0});  // A bank of 17 degrees.
        w.add({x_m, y_m, 4.0});                      // Leaves.
      }
    }
  });
  EXPECT_FALSE(way.nearest());
  see_column(way, 12.0, 0.0, 3.0);
  way.finish_revolution(pose, follower);
  EXPECT_FALSE(way.nearest()) << "once is not enough";
  see_column(way, 12.0, 0.0, 3.0);
  way.finish_revolution(pose, follower);
  EXPECT_TRUE(way.nearest());
  way.finish_revolution(pose, follower);
  EXPECT_TRUE(way.nearest()) << "nor is once enough to forget it";
  way.finish_revolution(pose, follower);
  EXPECT_FALSE(way.nearest());
}

TEST_F(PathFollowWay, WhatHasComeTooNearToBeSeenIsRememberedUntilItIsPassed) {
  (void)follower.start({0.0, 0.0});
  look([](WayWatch& w) { see_column(w, 9.3, 0.0, 3.0); });
  ASSERT_TRUE(way.nearest());
  for (const double x_m : {0.5, 1.5, 3.0}) {
    pose.position.east_m = x_m;
    (void)follower.update(pose, kStep_s);
    look([](WayWatch&) {});
    ASSERT_TRUE(way.nearest()) << x_m;
    EXPECT_NEAR(way.nearest()->ahead_m, 9.375 - 4.8 - x_m, 0.05);
  }
  for (const double x_m : {6.0, 9.0, 12.0}) {
    pose.position.east_m = x_m;
    (void)follower.update(pose, kStep_s);
    look([](WayWatch&) {});
  }
  EXPECT_FALSE(way.nearest());
}

TEST(PathFollowSpeed, ChoosesTheGearByTheCruiseSpeed) {
  EXPECT_EQ(SpeedControl({}, 1.0, {}).gear(), 1);
  EXPECT_EQ(SpeedControl({}, 2.0, {}).gear(), 2);
  EXPECT_EQ(SpeedControl({}, 6.0, {}).gear(), 5);
  EXPECT_EQ(SpeedControl({}, 2.0, 4).gear(), 4);
  EXPECT_THROW(SpeedControl({}, 2.0, 9), std::invalid_argument);
}

TEST(PathFollowSpeed, BrakesWhatIsTooFastAndStopsForNoWish) {
  SpeedControl control({}, 2.0, {});
  EXPECT_EQ(control.update(2.0, 2.1, 160.0, true, kStep_s).brake_mps2, 0.0);
  EXPECT_GT(control.update(1.0, 2.0, 160.0, true, kStep_s).brake_mps2, 0.5);
  const SpeedOutput stop = control.update(0.0, 1.0, 100.0, true, kStep_s);
  EXPECT_GT(stop.brake_mps2, 1.0);
  EXPECT_LT(stop.engine_radps, 80.0);
}

TEST(PathFollowFollower, RefusesSettingsByName) {
  FollowerSettings settings;
  settings.cruise_mps = std::nan("");
  EXPECT_THAT([&] { Follower(track(), settings); },
              testing::ThrowsMessage<std::invalid_argument>(HasSubstr("cruise_mps")));
}

}  // namespace
}  // namespace rigwire::path_follow
