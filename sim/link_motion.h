// Where one rigid link of a machine is and how it moves, for the sensors mounted on it.
//
// Frames: W world, east-north-up at the scene's map origin, double metres; L the link, x forward,
// y left, z up. Names as docs/glossary.md says: X_WL pose of L in W, v_WL_W velocity of L's origin
// in W expressed in W.
#pragma once

#include <Eigen/Geometry>
#include <string>

#include "sim/samples/time.h"

namespace rigwire::sim {

struct LinkMotion {
  Eigen::Isometry3d X_WL = Eigen::Isometry3d::Identity();
  Eigen::Vector3d v_WL_W = Eigen::Vector3d::Zero();      ///< m/s, of the link's origin.
  Eigen::Vector3d w_WL_W = Eigen::Vector3d::Zero();      ///< rad/s, angular velocity.
  Eigen::Vector3d a_WL_W = Eigen::Vector3d::Zero();      ///< m/s2, of the link's origin.
  Eigen::Vector3d alpha_WL_W = Eigen::Vector3d::Zero();  ///< rad/s2, angular acceleration.
};

/// The motion between two neighbouring instants of the solver: position by the cubic that matches
/// both positions and velocities, attitude along the shortest rotation at constant rate, rates and
/// accelerations linearly. Exact at both ends. What does not depend on the time asked for is worked
/// out once, for sensors that ask thousands of times a second.
class LinkMotionInterpolation {
 public:
  /// Precondition: t0 < t1.
  LinkMotionInterpolation(SimTime t0, const LinkMotion& at_t0, SimTime t1, const LinkMotion& at_t1);

  /// Precondition: t0 <= time <= t1.
  [[nodiscard]] LinkMotion operator()(SimTime time) const;

 private:
  SimTime t0_;
  SimTime t1_;
  LinkMotion at_t0_;
  LinkMotion at_t1_;
  Eigen::Quaterniond q0_;
  Eigen::Quaterniond q1_;  ///< On the side of q0_.
  double half_angle_rad_;  ///< Between q0_ and q1_, as unit vectors of four.
};

/// Motion of a frame S fixed to the link at X_LS (a sensor's mount).
[[nodiscard]] LinkMotion at_mount(const LinkMotion& link, const Eigen::Isometry3d& X_LS);

}  // namespace rigwire::sim
