#include "roll_lane/lane_plan.h"

#include <algorithm>
#include <cmath>

#include "field/require.h"

namespace rigwire::roll_lane {
namespace {

/// From 0 to 1 with the first and second derivative 0 at both ends.
struct Blend {
  double value;
  double slope;
  double curvature;
};
Blend blend(double t) {
  if (t <= 0.0) {
    return {0.0, 0.0, 0.0};
  }
  if (t >= 1.0) {
    return {1.0, 0.0, 0.0};
  }
  return {t * t * t * (t * (6.0 * t - 15.0) + 10.0), 30.0 * t * t * (t - 1.0) * (t - 1.0),
          60.0 * t * (2.0 * t * t - 3.0 * t + 1.0)};
}

}  // namespace

void LaneSettings::validate() const {
  const auto require = [](auto... check) { field::require_between("lanes", check...); };
  require(lanes, 1, 1000, "lanes");
  require(length_m, 5.0, 5000.0, "length_m");
  require(transition_m, 2.0, length_m, "transition_m");
  require(drum_width_m, 0.2, 5.0, "drum_width_m");
  require(drum_distance_m, 0.5, 10.0, "drum_distance_m");
  require(crab_offset_m, 0.0, 0.5 * drum_distance_m, "crab_offset_m");
  require(overlap_m, 0.0, 0.9 * drum_width_m, "overlap_m");
}

double LaneSettings::crab_angle_rad() const {
  return std::asin(crab_offset_m / drum_distance_m);
}

LanePlan::LanePlan(const LaneSettings& settings) : settings_(settings) {
  settings_.validate();
}

double LanePlan::end_x_m(int leg) const {
  return direction(leg) > 0 ? settings_.length_m : 0.0;
}

double LanePlan::left_m(int leg, double x_m) const {
  return direction(leg) * (end_x_m(leg) - x_m);
}

double LanePlan::lane_y_m(int leg) const {
  return std::max(leg, 0) * settings_.pitch_m() * (settings_.to_the_left ? 1.0 : -1.0);
}

double LanePlan::crab_rad(int leg) const {
  if (leg < 0) {
    return 0.0;  // no crab angle before the first lane
  }
  return settings_.crab_angle_rad() * (leg % 2 == 0 ? 1.0 : -1.0);
}

LanePoint LanePlan::at(int leg, double x_m) const {
  const double way = settings_.length_m - left_m(leg, x_m);
  const double per_m = direction(leg) / settings_.transition_m;
  const Blend b = blend(way / settings_.transition_m);
  const double dy = lane_y_m(leg) - lane_y_m(leg - 1);
  const double dcrab = crab_rad(leg) - crab_rad(leg - 1);
  LanePoint point;
  point.y_m = lane_y_m(leg - 1) + dy * b.value;
  point.slope = dy * b.slope * per_m;
  point.curvature_1pm = dy * b.curvature * per_m * per_m;
  point.crab_rad = crab_rad(leg - 1) + dcrab * b.value;
  point.crab_slope_radpm = dcrab * b.slope * per_m;
  return point;
}

}  // namespace rigwire::roll_lane
