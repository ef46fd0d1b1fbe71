#include "path_follow/path_mission.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "field/geometry.h"

namespace rigwire::path_follow {
namespace {

constexpr double kHaltBrake_mps2 = 2.5;
constexpr double kHoldBrake_mps2 = 1.5;
constexpr double kAtRest_mps = 0.1;
/// An obstacle that stays for so long is not a person who walks past.
constexpr double kPatience_s = 3.0;

}  // namespace

PathMission::PathMission(field::Polyline path, const PathMissionSettings& settings)
    : settings_(settings),
      follower_(std::move(path), settings.follower),
      speed_(settings.speed, settings.follower.cruise_mps, settings.gear),
      way_(settings.way) {}

field::Mission::Start PathMission::start(const field::PlanePosition& position) {
  constexpr double kAlongPath_rad = 0.25;
  constexpr double kGiven_rad = 0.05;
  const double along = follower_.start(position);
  return settings_.start_heading_rad ? Start{*settings_.start_heading_rad, kGiven_rad}
                                     : Start{along, kAlongPath_rad};
}

field::VehicleOrders PathMission::update(const field::Pose& pose,
                                         const field::VehicleReadings& readings, double step_s) {
  pose_ = pose;
  const auto& in_the_way = way_.nearest();
  follower_.set_free_way(in_the_way ? std::optional(in_the_way->ahead_m - settings_.keep_m)
                                    : std::nullopt);
  const FollowerOutput wanted = follower_.update(pose, step_s);
  const bool blocked = in_the_way && wanted.speed_mps < kAtRest_mps;
  blocked_s_ = blocked && std::abs(pose.speed_mps) < kAtRest_mps ? blocked_s_ + step_s : 0.0;
  const bool in_gear = readings.gear == speed_.gear() && !readings.shifting;
  const SpeedOutput speed =
      speed_.update(wanted.speed_mps, pose.speed_mps, readings.engine_speed_radps, in_gear, step_s);
  wish_mps_ = wanted.speed_mps;
  last_curvature_1pm_ = wanted.curvature_1pm;
  stuck_.update(wanted.speed_mps, pose.speed_mps, step_s);
  spin_.update(pose.position, pose.speed_mps, step_s);
  field::VehicleOrders orders;
  orders.engine_speed_radps = speed.engine_radps;
  orders.gear = speed_.gear();
  orders.brake_mps2 = speed.brake_mps2;
  orders.curvature_1pm = wanted.curvature_1pm;
  orders.parking_brake = false;
  if (blocked) {
    orders.engine_torque_share = 0.0;
    orders.engine_speed_radps.reset();
    orders.brake_mps2 = std::max(orders.brake_mps2, kHoldBrake_mps2);
  }
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
  char text[192];
  if (blocked_s_ > kPatience_s && way_.nearest()) {
    const Obstruction& it = *way_.nearest();
    (void)std::snprintf(
        text, sizeof(text),
        "there is an obstacle in the way, %.1f m ahead of the front, %.1f m %s of the "
        "line, at least %.1f m high; stopped before it",
        it.ahead_m, std::abs(it.offset_m), it.offset_m < 0.0 ? "right" : "left", it.height_m);
    return text;
  }
  if (follower_.off_path()) {
    (void)std::snprintf(text, sizeof(text), "%.2f m off the path, allowed %.2f m",
                        std::abs(follower_.offset_m()), settings_.follower.off_path_m);
    return text;
  }
  if (auto why = field::lost(pose_, settings_.follower.off_path_m)) {
    return why;
  }
  if (stuck_.stuck()) {
    (void)std::snprintf(
        text, sizeof(text),
        "the vehicle does not move: asked for %.1f m/s, its wheels have not turned for "
        "15 s; something holds it",
        wish_mps_);
    return text;
  }
  if (spin_.spinning()) {
    (void)std::snprintf(text, sizeof(text),
                        "the wheels turn, but the vehicle stays where it is: %.0f m by the wheels "
                        "in %.0f s, %.1f m by the receiver; something holds it",
                        spin_.by_wheels_m(), field::SpinWatch::kSpan_s, spin_.moved_m());
    return text;
  }
  return std::nullopt;
}

void PathMission::finish_revolution() {
  way_.finish_revolution(pose_, follower_);
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
  const auto& in_the_way = way_.nearest();
  line.number("obstacle_m", in_the_way ? std::optional(in_the_way->ahead_m) : std::nullopt, 2);
  line.close();
}

}  // namespace rigwire::path_follow
