#include "dig_cycle/surroundings.h"

#include <algorithm>
#include <cmath>

namespace rigwire::dig_cycle {
namespace {

/// Upper structure and tracks.
constexpr double kBodyHalfLength_m = 3.0;
constexpr double kBodyHalfWidth_m = 1.8;
constexpr double kBodyLowest_m = 0.3;
/// A full revolution of the densest sensor has about this many points in the sector.
constexpr std::size_t kGroundCapacity = 8192;

double distance_to_segment_m(PlanePoint point, PlanePoint from, PlanePoint to) {
  const double x_m = to.x_m - from.x_m;
  const double z_m = to.z_m - from.z_m;
  const double along = ((point.x_m - from.x_m) * x_m + (point.z_m - from.z_m) * z_m) /
                       std::max(1e-9, x_m * x_m + z_m * z_m);
  const double share = std::clamp(along, 0.0, 1.0);
  return std::hypot(point.x_m - from.x_m - share * x_m, point.z_m - from.z_m - share * z_m);
}

}  // namespace

Surroundings::Surroundings(const SurroundingsSettings& settings) : settings_(settings) {
  ground_z_m_.reserve(kGroundCapacity);
}

/// Sorts one point: on the own body or arm (ignored), ground or nearest range in the sector ahead,
/// or obstacle in the sector that a swing would sweep.
void Surroundings::add(const LidarPoint& point, const ArmShape& arm) {
  const auto [x_m, y_m, z_m] = settings_.mount.to_body(point);

  if (std::abs(x_m) < kBodyHalfLength_m && std::abs(y_m) < kBodyHalfWidth_m &&
      z_m > kBodyLowest_m) {
    return;
  }
  const PlanePoint side{x_m, z_m};
  if (std::abs(y_m) < settings_.arm_half_width_m &&
      std::min({distance_to_segment_m(side, arm.foot, arm.stick_pin),
                distance_to_segment_m(side, arm.stick_pin, arm.bucket_pin),
                distance_to_segment_m(side, arm.bucket_pin, arm.tip)}) <
          settings_.arm_half_height_m) {
    return;
  }
  const double azimuth_rad = std::atan2(y_m, x_m);
  const double radius_m = std::hypot(x_m, y_m);
  const double off_rad = std::abs(azimuth_rad);
  if (off_rad < settings_.sector_rad) {
    const double range_m = std::hypot(point.x_m, point.y_m, point.z_m);
    nearest_so_far_m_ = std::min(nearest_so_far_m_.value_or(range_m), range_m);
    if (radius_m > settings_.ground_inner_m && radius_m < settings_.ground_outer_m &&
        ground_z_m_.size() < kGroundCapacity) {
      ground_z_m_.push_back(z_m);
    }
  }
  const double lowest_m = std::min(arm.tip.z_m, arm.bucket_pin.z_m);
  const double farthest_m = std::max(arm.tip.x_m, arm.bucket_pin.x_m);
  if (off_rad > settings_.obstacle_inner_rad && off_rad < settings_.obstacle_outer_rad &&
      radius_m < farthest_m + settings_.obstacle_beyond_m &&
      z_m > lowest_m - settings_.obstacle_below_m) {
    ++(azimuth_rad > 0.0 ? points_left_ : points_right_);
  }
}

void Surroundings::finish_revolution() {
  if (ground_z_m_.size() >= settings_.least_ground_points) {
    const auto place = static_cast<std::ptrdiff_t>(settings_.ground_quantile *
                                                   static_cast<double>(ground_z_m_.size()));
    std::nth_element(ground_z_m_.begin(), ground_z_m_.begin() + place, ground_z_m_.end());
    view_.ground_z_m = ground_z_m_[static_cast<std::size_t>(place)];
  } else {
    view_.ground_z_m.reset();
  }
  view_.obstacle_left = points_left_ >= settings_.least_obstacle_points;
  view_.obstacle_right = points_right_ >= settings_.least_obstacle_points;
  nearest_range_m_ = nearest_so_far_m_;
  ++revolutions_;

  ground_z_m_.clear();
  nearest_so_far_m_.reset();
  points_left_ = 0;
  points_right_ = 0;
}

}  // namespace rigwire::dig_cycle
