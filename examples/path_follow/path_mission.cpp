#include "path_follow/path_mission.h"

#include <cmath>
#include <cstdio>
#include <utility>

#include "field/geometry.h"

namespace rigwire::path_follow {
namespace {

constexpr double kHaltBrake_mps2 = 2.5;

}  // namespace

PathMission::PathMission(field::Polyline path, const PathMissionSettings& settings)
    : settings_(settings),
      follower_(std::move(path), settings.follower),
      speed_(settings.speed, settings.follower.cruise_mps, settings.gear) {}

field::Mission::Start PathMission::start(const field::PlanePosition& position) {
  constexpr double kAlongPath_rad = 0.25;
  constexpr double kGiven_rad = 0.05;
  const double along = follower_.start(position);
  return settings_.start_heading_rad ? Start{*settings_.start_heading_rad, kGiven_rad}
                                     : Start{along, kAlongPath_rad};
}

field::VehicleOrders PathMission::update(const field::Pose& pose,
                                         const field::VehicleReadings& readings, double step_s) {
  const FollowerOutput wanted = follower_.update(pose, step_s);
  const bool in_gear = readings.gear == speed_.gear() && !readings.shifting;
  const SpeedOutput speed =
      speed_.update(wanted.speed_mps, pose.speed_mps, readings.engine_speed_radps, in_gear, step_s);
  wish_mps_ = wanted.speed_mps;
  last_curvature_1pm_ = wanted.curvature_1pm;
  stuck_.update(wanted.speed_mps, pose.speed_mps, step_s);
  field::VehicleOrders orders;
  orders.engine_speed_radps = speed.engine_radps;
  orders.gear = speed_.gear();
  orders.brake_mps2 = speed.brake_mps2;
  orders.curvature_1pm = wanted.curvature_1pm;
  orders.parking_brake = false;
  return orders;
}

field::VehicleOrders PathMission::halt(const field::VehicleReadings&, bool standing) const {
  field::VehicleOrders orders;
  orders.engine_torque_share = 0.0;
  orders.gear = 0;
  orders.brake_mps2 = kHaltBrake_mps2;
  orders.curvature_1pm = last_curvature_1pm_;
  orders.parking_brake = standing;
  return orders;
}

std::optional<std::string> PathMission::fault() const {
  char text[96];
  if (follower_.off_path()) {
    (void)std::snprintf(text, sizeof(text), "%.2f m off the path, allowed %.2f m",
                        std::abs(follower_.offset_m()), settings_.follower.off_path_m);
    return text;
  }
  if (stuck_.stuck()) {
    return "the vehicle does not move";
  }
  return std::nullopt;
}

std::string PathMission::progress() const {
  char text[96];
  if (std::isfinite(follower_.whole_m())) {
    (void)std::snprintf(text, sizeof(text), "%.0f of %.0f m, %+.2f m off", follower_.travelled_m(),
                        follower_.whole_m(), follower_.offset_m());
  } else {
    (void)std::snprintf(text, sizeof(text), "%.0f m, %+.2f m off", follower_.travelled_m(),
                        follower_.offset_m());
  }
  return text;
}

void PathMission::log(field::JsonLine& line) const {
  line.open("path");
  line.number("travelled_m", follower_.travelled_m(), 2);
  line.number("offset_m", follower_.offset_m(), 3);
  line.number("wish_mps", wish_mps_, 3);
  line.close();
}

}  // namespace rigwire::path_follow
