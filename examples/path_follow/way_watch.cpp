#include "path_follow/way_watch.h"

#include <algorithm>
#include <cmath>

#include "field/require.h"

namespace rigwire::path_follow {
namespace {

constexpr double kColumn_m = 0.25;
// Points are kept up to this distance to either side, because of bends.
constexpr double kAside_m = 15.0;
constexpr double kBackOnPath_m = 10.0;
constexpr int kToBelieve = 2;

}  // namespace

void WayWatchSettings::validate() const {
  const auto require = [](auto... check) { field::require_between("way_watch", check...); };
  require(front_m, 0.0, 20.0, "front_m");
  require(half_width_m, 0.1, 10.0, "half_width_m");
  require(reach_m, 2.0, 100.0, "reach_m");
  require(highest_m, 0.2, 10.0, "highest_m");
  require(lowest_m, -20.0, 0.0, "lowest_m");
  require(least_height_m, 0.1, 5.0, "least_height_m");
  require(blind_m, 0.0, 20.0, "blind_m");
}

WayWatch::WayWatch(const WayWatchSettings& settings) : settings_(settings) {
  settings_.validate();
  columns_across_ = static_cast<std::size_t>(std::lround(2.0 * kAside_m / kColumn_m));
  columns_.resize(static_cast<std::size_t>(std::ceil(settings_.reach_m / kColumn_m)) *
                  columns_across_);
}

void WayWatch::add(const field::LidarPoint& point) {
  const double ahead_m = point.x_m - settings_.front_m;
  if (!(ahead_m >= 0.0) || !(ahead_m < settings_.reach_m) || !(std::abs(point.y_m) < kAside_m) ||
      !(point.z_m < settings_.highest_m) || !(point.z_m > settings_.lowest_m)) {
    return;
  }
  const auto row = static_cast<std::size_t>(ahead_m / kColumn_m);
  const auto across = static_cast<std::size_t>((point.y_m + kAside_m) / kColumn_m);
  const std::size_t at = row * columns_across_ + across;
  if (at >= columns_.size()) {
    return;
  }
  Column& column = columns_[at];
  const auto z = static_cast<float>(point.z_m);
  column.least_m = column.points == 0 ? z : std::min(column.least_m, z);
  column.greatest_m = column.points == 0 ? z : std::max(column.greatest_m, z);
  ++column.points;
}

void WayWatch::finish_revolution(const field::Pose& pose, const Follower& follower) {
  std::optional<Obstruction> nearest;
  const double cos_heading = std::cos(pose.heading_rad);
  const double sin_heading = std::sin(pose.heading_rad);
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const Column& column = columns_[i];
    const double height_m = double{column.greatest_m} - double{column.least_m};
    if (column.points < settings_.least_points || height_m < settings_.least_height_m) {
      continue;
    }
    const std::size_t row = i / columns_across_;
    const std::size_t across = i % columns_across_;
    const double x_m = settings_.front_m + (static_cast<double>(row) + 0.5) * kColumn_m;
    const double y_m = (static_cast<double>(across) + 0.5) * kColumn_m - kAside_m;
    const field::PlanePosition there{pose.position.east_m + cos_heading * x_m - sin_heading * y_m,
                                     pose.position.north_m + sin_heading * x_m + cos_heading * y_m};
    const double reach_m = settings_.front_m + settings_.reach_m;
    const field::Polyline::Place place =
        follower.path().nearest(there, follower.along_m(), reach_m + 1.0);
    double way_m = place.along_m - follower.along_m();
    if (follower.path().closed()) {
      way_m = std::remainder(way_m, follower.path().length_m());
    }
    const double ahead_m = way_m - settings_.front_m;
    // The line leads from where the vehicle is back to the path.
    const double line_m =
        follower.offset_m() * std::max(0.0, 1.0 - std::max(0.0, way_m) / kBackOnPath_m);
    const double offset_m = place.offset_m - line_m;
    if (ahead_m < -1.0 || std::abs(offset_m) > settings_.half_width_m) {
      continue;
    }
    if (!nearest || ahead_m < nearest->ahead_m) {
      nearest = Obstruction{std::max(0.0, ahead_m), offset_m, height_m};
    }
  }
  std::ranges::fill(columns_, Column{});
  if (believed_ && !nearest) {
    const double left_m = believed_at_m_ - follower.travelled_m();
    if (left_m < settings_.blind_m && left_m > -settings_.front_m) {
      believed_->ahead_m = std::max(0.0, left_m);
      in_a_row_ = 0;
      return;
    }
  }
  in_a_row_ = nearest.has_value() == believed_.has_value() ? 0 : in_a_row_ + 1;
  if (in_a_row_ == 0 || in_a_row_ >= kToBelieve) {
    believed_ = nearest;
    believed_at_m_ = nearest ? follower.travelled_m() + nearest->ahead_m : 0.0;
    in_a_row_ = 0;
  }
}

}  // namespace rigwire::path_follow
