// What the lidar shows of the place: the ground in front of the bucket, the nearest thing in the
// dig sector, and whether something stands in the way of a swing.
//
// Works per revolution of the sensor: points are collected, and finish_revolution() evaluates them.
// The own arm (as it is believed to be) and the own body are taken out first.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "dig_cycle/cycle.h"
#include "dig_cycle/machine.h"
#include "field/lidar_wire.h"

namespace rigwire::dig_cycle {

using field::LidarMount;
using field::LidarPoint;
/// On the cabin's roof, in the upper structure's frame.
inline constexpr LidarMount kRoofMount{1.2, 0.8, 3.35, 0.0, -10.0 * kDegree};

struct SurroundingsSettings {
  LidarMount mount = kRoofMount;
  /// Half width of the sector in which the ground ahead and the nearest range are taken.
  double sector_rad = 12.0 * kDegree;
  double ground_inner_m = 5.5;  ///< From the swing axis.
  double ground_outer_m = 9.0;
  std::size_t least_ground_points = 30;
  /// Quantile of the points' heights that counts as the ground.
  double ground_quantile = 0.3;
  /// Points so near to the line of the own arm belong to the arm.
  double arm_half_width_m = 0.9;
  double arm_half_height_m = 1.0;
  /// Sector in which a swing is checked for obstacles, to either side.
  double obstacle_inner_rad = 8.0 * kDegree;
  double obstacle_outer_rad = 35.0 * kDegree;
  double obstacle_below_m = 0.7;   ///< Below tip and bucket pin: the shell's depth and room.
  double obstacle_beyond_m = 0.5;  ///< Beyond the tip.
  std::size_t least_obstacle_points = 8;
};

class Surroundings {
 public:
  explicit Surroundings(const SurroundingsSettings& settings = {});

  void add(const LidarPoint& point, const ArmShape& arm);
  /// Everything since the last call was one revolution.
  void finish_revolution();

  [[nodiscard]] const View& view() const { return view_; }
  /// From the sensor to the nearest thing in the dig sector that is not the machine.
  [[nodiscard]] std::optional<double> nearest_range_m() const { return nearest_range_m_; }
  [[nodiscard]] std::uint64_t revolutions() const { return revolutions_; }

 private:
  SurroundingsSettings settings_;
  std::vector<double> ground_z_m_;
  std::optional<double> nearest_so_far_m_;
  std::size_t points_left_ = 0;
  std::size_t points_right_ = 0;
  View view_;
  std::optional<double> nearest_range_m_;
  std::uint64_t revolutions_ = 0;
};

}  // namespace rigwire::dig_cycle
