#include "path_follow/follower.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "field/geometry.h"
#include "field/require.h"

namespace rigwire::path_follow {
namespace {

/// A standing vehicle needs a desired speed above this to begin.
constexpr double kLeastSpeed_mps = 0.5;
/// The path is done when less than this is left.
constexpr double kArrived_m = 0.4;
/// How far along the path one step may move the nearest place.
constexpr double kWindow_m = 6.0;

}  // namespace

void FollowerSettings::validate() const {
  const auto require = [](auto... check) { field::require_between("follower", check...); };
  require(cruise_mps, 0.1, 30.0, "cruise_mps");
  require(acceleration_mps2, 0.01, 10.0, "acceleration_mps2");
  require(braking_mps2, 0.01, 10.0, "braking_mps2");
  require(lateral_acceleration_mps2, 0.01, 10.0, "lateral_acceleration_mps2");
  require(lookahead_s, 0.0, 10.0, "lookahead_s");
  require(lookahead_least_m, 0.5, 50.0, "lookahead_least_m");
  require(lookahead_most_m, lookahead_least_m, 100.0, "lookahead_most_m");
  require(curvature_limit_1pm, 0.001, 2.0, "curvature_limit_1pm");
  require(off_path_m, 0.1, 1000.0, "off_path_m");
  require(laps, 0.0, 1e6, "laps");
  require(offset_gain, 0.0, 1.0, "offset_gain");
}

Follower::Follower(field::Polyline path, const FollowerSettings& settings)
    : path_(std::move(path)), settings_(settings) {
  settings_.validate();
}

double Follower::whole_m() const {
  if (!path_.closed()) {
    return path_.length_m() - start_m_;
  }
  return settings_.laps > 0.0 ? settings_.laps * path_.length_m()
                              : std::numeric_limits<double>::infinity();
}

double Follower::start(const field::PlanePosition& position) {
  start_m_ = along_m_ = path_.nearest(position).along_m;
  travelled_m_ = 0.0;
  return path_.direction_rad(along_m_);
}

double Follower::speed_limit_mps(double left_m) const {
  double limit = std::min(settings_.cruise_mps, std::sqrt(2.0 * settings_.braking_mps2 *
                                                          std::max(0.0, left_m - kArrived_m)));
  const double ahead_m = std::max(6.0, 0.5 * speed_mps_ * speed_mps_ / settings_.braking_mps2);
  constexpr double kStep_m = 2.0;
  for (double way = 0.0; way <= ahead_m; way += kStep_m) {
    const double curvature = std::abs(path_.curvature_1pm(along_m_ + way));
    if (curvature > 1e-6) {
      limit = std::min(limit, std::sqrt(settings_.lateral_acceleration_mps2 / curvature +
                                        2.0 * settings_.braking_mps2 * way));
    }
  }
  return limit;
}

FollowerOutput Follower::update(const field::Pose& pose, double step_s) {
  const field::Polyline::Place place = path_.nearest(pose.position, along_m_, kWindow_m);
  double moved_m = place.along_m - along_m_;
  if (path_.closed()) {
    moved_m = std::remainder(moved_m, path_.length_m());
  }
  travelled_m_ += moved_m;
  along_m_ = place.along_m;
  offset_m_ = place.offset_m;
  off_path_ = off_path_ || std::abs(offset_m_) > settings_.off_path_m;
  const double left_m = whole_m() - travelled_m_;
  done_ = done_ || left_m < kArrived_m;
  if (done_ || off_path_) {
    speed_mps_ = 0.0;
    return {};
  }

  const double speed = std::abs(pose.speed_mps);
  const double lookahead_m = std::clamp(settings_.lookahead_s * speed, settings_.lookahead_least_m,
                                        settings_.lookahead_most_m);
  const field::PlanePosition target = path_.at(along_m_ + lookahead_m);
  const double dx = target.east_m - pose.position.east_m;
  const double dy = target.north_m - pose.position.north_m;
  const double course = pose.heading_rad + pose.slip_angle_rad;
  const double left = -std::sin(course) * dx + std::cos(course) * dy;
  double curvature = 2.0 * left / std::max(1e-6, dx * dx + dy * dy);
  curvature -= settings_.offset_gain * offset_m_;
  FollowerOutput output;
  output.curvature_1pm =
      std::clamp(curvature, -settings_.curvature_limit_1pm, settings_.curvature_limit_1pm);

  double limit = std::max(speed_limit_mps(left_m), kLeastSpeed_mps);
  if (free_m_) {
    // Braking twice as hard as at the path's end: this stop was not planned.
    limit = std::min(limit, std::sqrt(4.0 * settings_.braking_mps2 * std::max(0.0, *free_m_)));
  }
  speed_mps_ = std::min({limit, speed_mps_ + settings_.acceleration_mps2 * step_s,
                         speed + 0.8});  // the wish does not run away from a vehicle that is stuck
  output.speed_mps = speed_mps_;
  return output;
}

}  // namespace rigwire::path_follow
