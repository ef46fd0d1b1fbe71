// What the field program knows of its machine: the arm's lengths and limits, and which way each
// valve section moves its joint. Data of the controller, entered by its installer.
//
// Frame of all positions here: the upper structure's, origin on the swing axis at the height of the
// ground under the tracks, x forward along the arm, y left, z up. Angles in rad, positive upwards;
// boom against the upper structure, stick against the boom, bucket against the stick; swing of the
// upper structure against the undercarriage, positive to the left.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "field/geometry.h"

namespace rigwire::dig_cycle {

using field::kDegree;
using field::wrapped;

enum Joint : std::size_t { swing, boom, stick, bucket };
inline constexpr std::size_t kJoints = 4;
inline constexpr std::array<std::string_view, kJoints> kJointNames{"swing", "boom", "stick",
                                                                   "bucket"};
/// One value per joint, in the order of Joint (also the order of the valve sections 1..4).
using PerJoint = std::array<double, kJoints>;

struct Machine {
  double boom_foot_x_m = 0.30;
  double boom_foot_z_m = 2.10;  ///< Swing bearing 1.25 m + foot 0.85 m above it.
  double boom_length_m = 5.00;
  double stick_length_m = 2.45;
  double bucket_length_m = 1.40;  ///< Bucket pin to tip.
  /// Joint stops; the swing has none.
  PerJoint lower_rad{-1e9, -35.0 * kDegree, -161.0 * kDegree, -138.0 * kDegree};
  PerJoint upper_rad{1e9, 61.0 * kDegree, -30.0 * kDegree, 40.0 * kDegree};
  /// +1 where a positive opening (cylinder out, swing left) increases the angle, -1 where it
  /// decreases it: the stick's and the bucket's cylinders pull the tip in as they extend.
  PerJoint opening_sign{1.0, 1.0, -1.0, -1.0};
  /// Pins of the boom's cylinders: on the upper structure from the boom's foot, and on the boom.
  double boom_base_x_m = 0.55;
  double boom_base_z_m = -0.45;
  double boom_rod_x_m = 2.05;
  double boom_rod_z_m = 0.60;
  double boom_bottom_area_m2 = 0.020774;    ///< Area of both cylinders, bore 115 mm.
  double boom_rod_side_area_m2 = 0.010721;  ///< Area of both, rods of 80 mm.
  /// Point at which the soil's weight acts: from the bucket's pin towards the tip, and into the
  /// shell.
  double load_x_m = 0.65;
  double load_z_m = 0.25;
};

/// A point in the plane of the arm.
struct PlanePoint {
  double x_m = 0.0;
  double z_m = 0.0;
};

/// Pins of the arm, for the tip and for recognising the own arm in the lidar's points.
struct ArmShape {
  PlanePoint foot;
  PlanePoint stick_pin;
  PlanePoint bucket_pin;
  PlanePoint tip;
};

/// Where the arm is.
[[nodiscard]] ArmShape arm_shape(const Machine& machine, const PerJoint& angles_rad);

/// Lever of the boom's cylinders about the boom's foot.
[[nodiscard]] double boom_lever_m(const Machine& machine, double boom_rad);
/// Horizontal way from the boom's foot to the soil in the bucket.
[[nodiscard]] double load_reach_m(const Machine& machine, const PerJoint& angles_rad);

/// Boom and stick angles (the other entries: swing 0, bucket as given) that bring the tip to `tip`
/// with the stick hanging (elbow up). Empty when out of reach or beyond a joint's stop.
[[nodiscard]] std::optional<PerJoint> reach(const Machine& machine, PlanePoint tip,
                                            double bucket_rad);

}  // namespace rigwire::dig_cycle
