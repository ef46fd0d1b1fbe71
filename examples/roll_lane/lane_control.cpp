#include "roll_lane/lane_control.h"

#include <algorithm>
#include <cmath>

#include "field/geometry.h"
#include "field/require.h"

namespace rigwire::roll_lane {
namespace {

constexpr double kLeastSpeed_mps = 0.15;
constexpr double kArrived_m = 0.15;
constexpr double kStanding_mps = 0.03;
/// Slower than this the drums do not vibrate: they would dig themselves in.
constexpr double kVibrate_mps = 0.4;
constexpr double kCourseLimit_rad = 0.5;

}  // namespace

void LaneControlSettings::validate() const {
  const auto require = [](auto... check) { field::require_between("lane control", check...); };
  require(speed_mps, 0.2, 4.0, "speed_mps");
  require(acceleration_mps2, 0.01, 5.0, "acceleration_mps2");
  require(braking_mps2, 0.01, 5.0, "braking_mps2");
  require(bandwidth_1pm, 0.01, 2.0, "bandwidth_1pm");
  require(curvature_limit_1pm, 0.001, 1.0, "curvature_limit_1pm");
  require(off_line_m, 0.1, 100.0, "off_line_m");
  require(rest_s, 0.0, 60.0, "rest_s");
}

LaneControl::LaneControl(const LaneSettings& lanes, const LaneControlSettings& settings)
    : plan_(lanes), settings_(settings) {
  settings_.validate();
}

void LaneControl::start(const field::PlanePosition& origin, double direction_rad) {
  origin_ = origin;
  direction_rad_ = direction_rad;
  leg_ = 0;
}

/// Feedback of lane_control.h: curvature = line's - w^2 offset - 2 w (course error), less the
/// change of the crab angle. The speed is limited by the braking way to the end of the leg.
LaneOutput LaneControl::update(const field::Pose& pose, double step_s) {
  const double east = pose.position.east_m - origin_.east_m;
  const double north = pose.position.north_m - origin_.north_m;
  const double c = std::cos(direction_rad_);
  const double s = std::sin(direction_rad_);
  x_m_ = c * east + s * north;
  const double y = -s * east + c * north;
  LaneOutput output;
  if (done() || off_line_) {
    return output;
  }
  const LanePoint line = plan_.at(leg_, x_m_);
  const int direction = LanePlan::direction(leg_);
  offset_m_ = y - line.y_m;
  off_line_ = std::abs(offset_m_) > settings_.off_line_m;
  const double left_m = plan_.left_m(leg_, x_m_);
  arrived_ = arrived_ || left_m < kArrived_m;
  if (arrived_ || off_line_) {
    speed_mps_ = 0.0;
    output.crab_rad = line.crab_rad;
    if (std::abs(pose.speed_mps) < kStanding_mps) {
      rest_s_ += step_s;
    }
    if (rest_s_ > settings_.rest_s && !off_line_) {
      ++leg_;
      rest_s_ = 0.0;
      arrived_ = false;
    }
    return output;
  }

  const double course =
      std::clamp(field::wrapped(pose.heading_rad + pose.slip_angle_rad - direction_rad_),
                 -kCourseLimit_rad, kCourseLimit_rad);
  const double w = settings_.bandwidth_1pm;
  const double turn = line.curvature_1pm - w * w * offset_m_ -
                      direction * 2.0 * w * (course - std::atan(line.slope));
  output.curvature_1pm = std::clamp(turn - line.crab_slope_radpm, -settings_.curvature_limit_1pm,
                                    settings_.curvature_limit_1pm);
  output.crab_rad = line.crab_rad;
  speed_mps_ = std::min({settings_.speed_mps, speed_mps_ + settings_.acceleration_mps2 * step_s,
                         std::max(kLeastSpeed_mps, std::sqrt(2.0 * settings_.braking_mps2 *
                                                             std::max(0.0, left_m - kArrived_m)))});
  output.speed_mps = direction * speed_mps_;
  output.vibrate = std::abs(pose.speed_mps) > kVibrate_mps;
  return output;
}

}  // namespace rigwire::roll_lane
