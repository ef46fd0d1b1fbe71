// The lane roller's decisions: the plan, and closed loops on a machine without dynamics.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "roll_lane/lane_mission.h"
#include "vehicle_plant.h"

namespace rigwire::roll_lane {
namespace {

using testing::HasSubstr;

constexpr double kStep_s = 0.02;

TEST(LanePlan, NeighboursOverlapAndTheCrabSideChanges) {
  const LaneSettings settings;
  const LanePlan plan(settings);
  EXPECT_NEAR(plan.lane_y_m(1) - plan.lane_y_m(0), 1.68 + 0.6 - 0.15, 1e-12);
  EXPECT_NEAR(std::sin(plan.at(0, 50.0).crab_rad) * 3.4, 0.6, 1e-12);
  EXPECT_NEAR(plan.at(1, 10.0).crab_rad, -plan.at(0, 50.0).crab_rad, 1e-12);
  EXPECT_EQ(plan.left_m(0, 0.0), 60.0);
  EXPECT_EQ(plan.left_m(1, 60.0), 60.0);
}

TEST(LanePlan, LegsJoinSmoothlyAndDerivativesAreThose) {
  const LanePlan plan({});
  for (int leg = 0; leg < 3; ++leg) {
    const LanePoint end = plan.at(leg, plan.end_x_m(leg));
    const LanePoint begin = plan.at(leg + 1, plan.end_x_m(leg));
    EXPECT_NEAR(end.y_m, begin.y_m, 1e-12);
    EXPECT_NEAR(end.crab_rad, begin.crab_rad, 1e-12);
    EXPECT_NEAR(begin.slope, 0.0, 1e-12);
    constexpr double kDelta_m = 1e-4;
    for (double x = 1.0; x < 59.0; x += 3.7) {
      const LanePoint p = plan.at(leg, x);
      const LanePoint a = plan.at(leg, x - kDelta_m);
      const LanePoint b = plan.at(leg, x + kDelta_m);
      EXPECT_NEAR(p.slope, (b.y_m - a.y_m) / (2.0 * kDelta_m), 1e-6);
      EXPECT_NEAR(p.curvature_1pm, (b.slope - a.slope) / (2.0 * kDelta_m), 1e-6);
      EXPECT_NEAR(p.crab_slope_radpm, (b.crab_rad - a.crab_rad) / (2.0 * kDelta_m), 1e-6);
    }
  }
}

TEST(LanePlan, RefusesNonsenseByName) {
  LaneSettings settings;
  settings.crab_offset_m = 5.0;
  EXPECT_THAT([&] { LanePlan plan(settings); },
              testing::ThrowsMessage<std::invalid_argument>(HasSubstr("crab_offset_m")));
}

struct Result {
  double worst_m = 0.0;            ///< True distance from the line, after a transition.
  double worst_heading_rad = 0.0;  ///< Body against lane less crab, after a transition.
  bool done = false;
  std::optional<std::string> fault;
};

Result run(LaneMission& mission, const LaneMissionSettings& settings, double wander_m,
           double heading_error_rad) {
  field::VehiclePlant plant;
  plant.wheelbase_m = 3.4;
  plant.reference_m = 1.7;
  plant.steer_limit_rad = 0.5236;
  plant.position = {100.0, -40.0};
  plant.heading_rad = settings.direction_rad + heading_error_rad;
  const field::PlanePosition origin = plant.position;
  field::TestReceiver receiver(wander_m, 0.3 * wander_m, 5);
  field::PoseEstimatorSettings estimator_settings;
  estimator_settings.gnss_age_s = 0.0;
  estimator_settings.gnss_sigma_m = wander_m > 0.0 ? 1.5 : 0.05;
  field::PoseEstimator estimator(estimator_settings);
  const auto start = mission.start(origin);
  estimator.start(origin, start.heading_rad, start.sigma_rad);
  const LanePlan plan(settings.lanes);
  Result result;
  int leg = 0;
  double direction = 1.0;
  for (int i = 1; i <= 40000 && !mission.done() && !mission.fault(); ++i) {
    estimator.advance(kStep_s, plant.speed_mps, plant.slip_rad, plant.yaw_rate_radps);
    if (i % 10 == 0) {
      estimator.position(receiver.measure(plant.position, 0.2));
      const double course = plant.heading_rad + plant.slip_rad;
      estimator.course(plant.speed_mps < 0.0 ? field::wrapped(course + 3.14159265358979) : course,
                       std::abs(plant.speed_mps));
    }
    const auto orders = mission.update(estimator.pose(), {}, kStep_s);
    plant.curvature_1pm = orders.curvature_1pm.value_or(0.0);
    plant.crab_rad = orders.crab_angle_rad;
    plant.wish_mps = orders.travel_speed_mps.value_or(0.0);
    plant.step(kStep_s);
    const double c = std::cos(settings.direction_rad);
    const double s = std::sin(settings.direction_rad);
    const double dx = plant.position.east_m - origin.east_m;
    const double dy = plant.position.north_m - origin.north_m;
    const double x = c * dx + s * dy;
    const double y = -s * dx + c * dy;
    if (plant.wish_mps * direction < 0.0) {
      direction = -direction;
      ++leg;
    }
    const double way = settings.lanes.length_m - plan.left_m(leg, x);
    if (way > settings.lanes.transition_m + 4.0) {
      result.worst_m = std::max(result.worst_m, std::abs(y - plan.at(leg, x).y_m));
      result.worst_heading_rad =
          std::max(result.worst_heading_rad,
                   std::abs(field::wrapped(plant.heading_rad - settings.direction_rad +
                                           plan.at(leg, x).crab_rad)));
    }
  }
  result.done = mission.done();
  result.fault = mission.fault();
  return result;
}

TEST(RollLaneClosedLoop, RollsFourLanesWithinTwoDecimetres) {
  LaneMissionSettings settings;
  settings.direction_rad = 0.4;
  LaneMission mission(settings);
  const Result result = run(mission, settings, 0.0, 0.02);
  EXPECT_TRUE(result.done) << mission.progress() << result.fault.value_or("");
  EXPECT_LT(result.worst_m, 0.2);
  EXPECT_LT(result.worst_heading_rad, 0.05) << "the body is turned against the lane by the crab";
}

TEST(RollLaneClosedLoop, ToTheRightAlso) {
  LaneMissionSettings settings;
  settings.lanes.to_the_left = false;
  settings.lanes.lanes = 3;
  LaneMission mission(settings);
  const Result result = run(mission, settings, 0.0, -0.02);
  EXPECT_TRUE(result.done) << mission.progress() << result.fault.value_or("");
  EXPECT_LT(result.worst_m, 0.2);
}

TEST(RollLaneClosedLoop, ToleratesAReceiverThatWanders) {
  LaneMissionSettings settings;
  settings.control.off_line_m = 2.5;
  LaneMission mission(settings);
  const Result result = run(mission, settings, 0.6, 0.03);
  EXPECT_TRUE(result.done) << mission.progress() << result.fault.value_or("");
  EXPECT_LT(result.worst_m, 2.5);
}

TEST(RollLaneMission, HaltsWithoutVibrationAndParksOnlyWhenStanding) {
  LaneMissionSettings settings;
  settings.vibration = true;
  LaneMission mission(settings);
  const auto orders = mission.halt({}, false);
  EXPECT_EQ(orders.travel_speed_mps, 0.0);
  EXPECT_EQ(orders.vibration, false);
  EXPECT_FALSE(orders.parking_brake);
  EXPECT_TRUE(mission.halt({}, true).parking_brake);
}

TEST(RollLaneMission, OffTheLineIsAFault) {
  LaneMission mission({});
  (void)mission.start({0, 0});
  field::Pose pose;
  pose.position = {10.0, 3.0};
  (void)mission.update(pose, {}, kStep_s);
  EXPECT_THAT(mission.fault().value_or(""), HasSubstr("off the line, allowed 2.50 m"));
}

}  // namespace
}  // namespace rigwire::roll_lane
