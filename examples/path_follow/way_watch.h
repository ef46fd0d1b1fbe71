// Obstacles on the way, from the lidar points of the ground ahead.
//
// Points of a revolution are sorted into upright columns of 0.25 m. A column whose points are 0.5 m
// apart in height or more, none of them counted above `highest_m`, is an obstacle: slopes and waves
// of the ground are not as steep, and crowns overhead do not count. An obstacle is in the way when
// it is within half a width of the line that the vehicle will follow: the path, and until it is
// back on it, beside it. Two revolutions in a row confirm it, or clear it; but one that was seen
// and has come nearer than `blind_m` is remembered until it is passed, because a lidar on the roof
// sees over it there.
//
// Knows neither wires nor clocks.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "field/lidar_wire.h"
#include "field/pose_estimator.h"
#include "path_follow/follower.h"

namespace rigwire::path_follow {

struct WayWatchSettings {
  double front_m = 4.8;       ///< The vehicle's front ahead of the odometry's reference point.
  double half_width_m = 1.5;  ///< Half of the width that must be free along the line.
  double reach_m = 30.0;      ///< Nothing farther ahead is checked.
  double highest_m = 1.6;     ///< Above the reference's ground.
  double lowest_m = -3.0;
  double least_height_m = 0.5;  ///< Minimum height of an obstacle.
  std::size_t least_points = 4;
  double blind_m = 5.0;  ///< Ahead of the front.

  /// Throws std::invalid_argument naming the member.
  void validate() const;
};

/// The nearest thing in the way.
struct Obstruction {
  double ahead_m = 0.0;   ///< Distance from the vehicle's front, along the path.
  double offset_m = 0.0;  ///< Left of the line positive.
  double height_m = 0.0;  ///< Height of its visible part.
};

class WayWatch {
 public:
  explicit WayWatch(const WayWatchSettings& settings = {});

  /// `point` in the frame of the odometry's reference point.
  void add(const field::LidarPoint& point);
  /// Everything since the last call was one revolution, seen from `pose`, on the follower's path.
  void finish_revolution(const field::Pose& pose, const Follower& follower);

  [[nodiscard]] const std::optional<Obstruction>& nearest() const { return believed_; }
  [[nodiscard]] const WayWatchSettings& settings() const { return settings_; }

 private:
  struct Column {
    float least_m = 0.0F;
    float greatest_m = 0.0F;
    std::size_t points = 0;
  };

  WayWatchSettings settings_;
  std::size_t columns_across_;
  std::vector<Column> columns_;
  std::optional<Obstruction> believed_;
  double believed_at_m_ = 0.0;  ///< Value of the follower's way at which the front would touch it.
  int in_a_row_ = 0;            ///< Successive revolutions that contradict the present result.
};

}  // namespace rigwire::path_follow
