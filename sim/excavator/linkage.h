// Cylinder length as a function of joint angle, in closed form: no loop constraint, hence no drift.
//
// All geometry is planar, in (x, z) with angles upward positive from x. L is the pin-to-pin length
// of a cylinder, q the angle of the joint that it moves, dL/dq its lever about the joint: a force F
// that extends the cylinder gives the joint torque F dL/dq.
//
// A linkage has a dead centre where dL/dq passes zero; beyond it the same length belongs to a
// second pose. Each class therefore knows its working range, the interval of q that its stroke
// covers on one side of the dead centre, and solves L -> q inside it only.
#pragma once

#include "sim/excavator/arm_angles.h"
#include "sim/excavator/parameters.h"

namespace rigwire::sim {

/// Length and lever at one joint angle.
struct CylinderGeometry {
  double length_m = 0.0;
  double lever_m = 0.0;  ///< dL/dq, signed.
};

/// Joint angles and lengths at the two ends of the stroke.
struct WorkingRange {
  double q_retracted_rad = 0.0;
  double q_extended_rad = 0.0;
  double length_min_m = 0.0;
  double length_max_m = 0.0;

  [[nodiscard]] double q_min_rad() const;
  [[nodiscard]] double q_max_rad() const;
};

/// Cylinder between the two links that the joint connects (boom, stick). With a the base pin's and
/// b the rod pin's distance from the joint, L^2 = a^2 + b^2 - 2 a b cos(q + offset).
class DirectLinkage {
 public:
  /// `base_pin_m` from the joint in the frame before it, `rod_pin_m` in the moved link's frame.
  DirectLinkage(const Eigen::Vector2d& base_pin_m, const Eigen::Vector2d& rod_pin_m);

  [[nodiscard]] CylinderGeometry at(double q_rad) const;
  /// Returns the geometry from the angle's cosine and sine. Loses digits where the pins' distances
  /// are equal and the length goes to zero, which no working range includes.
  [[nodiscard]] CylinderGeometry at(const Turn& q) const;

  /// The joint angle with this length, on the branch (`lever_sign` = +1 or -1) asked for, nearest
  /// to zero among its repetitions every turn. A length out of reach gives the dead centre.
  [[nodiscard]] double angle_at(double length_m, int lever_sign) const;

  [[nodiscard]] double shortest_m() const;
  [[nodiscard]] double longest_m() const;

 private:
  double base_radius_m_;
  double rod_radius_m_;
  double offset_rad_;  ///< Angle from the base pin to the rod pin at q = 0.
  Turn offset_;
};

/// The bucket's four-bar linkage. J, the joint of cylinder, idler and link, is the intersection of
/// two circles on the side that `branch` fixes permanently, so that a length cannot flip the
/// mechanism over.
class BucketLinkage {
 public:
  BucketLinkage(const BucketLinkageParameters& parameters, double stick_length_m);

  /// Where the circles do not intersect (idler and link stretched or folded), J is placed on the
  /// line between their centres: the length stays continuous and finite, and the lever bounded.
  [[nodiscard]] CylinderGeometry at(double q_rad) const { return at(Turn::by(q_rad)); }
  [[nodiscard]] CylinderGeometry at(const Turn& q) const;

  /// Returns the joint of idler, link and cylinder, in the stick's frame (for drawing).
  [[nodiscard]] Eigen::Vector2d idler_joint_m(double q_rad) const;

  /// Whether the idler's and the link's circles intersect at this angle.
  [[nodiscard]] bool closes_at(double q_rad) const;

  /// The joint angle with this length within [from, to], on which the length must be monotone;
  /// the nearer end if the length is outside. Within 1e-13 rad.
  [[nodiscard]] double angle_at(double length_m, double from_rad, double to_rad) const;

  /// Returns the dead centre: the angle of the maximum length reachable without stretching the
  /// four-bar, searched downward (the curling way) from `from_rad`. Within 1e-9 rad.
  [[nodiscard]] double dead_centre(double from_rad) const;

 private:
  Eigen::Vector2d base_pin_m_;
  Eigen::Vector2d idler_pivot_m_;
  Eigen::Vector2d bucket_pin_m_;
  double idler_length_m_;
  double link_length_m_;
  double lug_radius_m_;
  double lug_angle_rad_;
  double branch_;

  /// L measured from the bucket pin.
  [[nodiscard]] Eigen::Vector2d lug_arm_m(const Turn& q) const;
  [[nodiscard]] Eigen::Vector2d idler_joint_of(const Eigen::Vector2d& lug_m) const;
  Turn lug_;
};

/// The three linkages of one machine with their working ranges.
class Linkages {
 public:
  /// Throws std::invalid_argument as validate(ExcavatorParameters) says for pins and cylinders.
  explicit Linkages(const ExcavatorParameters& parameters);

  /// joint: 0 boom, 1 stick, 2 bucket.
  [[nodiscard]] CylinderGeometry at(int joint, double q_rad) const;
  [[nodiscard]] CylinderGeometry at(int joint, const Turn& q) const;
  [[nodiscard]] double angle_at(int joint, double length_m) const;
  [[nodiscard]] const WorkingRange& range(int joint) const { return ranges_[index(joint)]; }
  [[nodiscard]] const DirectLinkage& boom() const { return boom_; }
  [[nodiscard]] const DirectLinkage& stick() const { return stick_; }
  [[nodiscard]] const BucketLinkage& bucket() const { return bucket_; }
  /// Minimum distance along the length between the stroke and the nearest dead centre.
  [[nodiscard]] double dead_centre_margin_m(int joint) const { return margins_m_[index(joint)]; }

 private:
  static std::size_t index(int joint) { return static_cast<std::size_t>(joint); }

  DirectLinkage boom_;
  DirectLinkage stick_;
  BucketLinkage bucket_;
  std::array<WorkingRange, 3> ranges_;
  std::array<double, 3> margins_m_{};
};

}  // namespace rigwire::sim
