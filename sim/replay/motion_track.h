// The motion of one link as a function of time, from a recording of it.
//
// Between two recorded instants h apart: position by the cubic that matches positions and
// velocities at both ends, attitude by the cubic of its four numbers that matches attitudes and
// rates, made a unit again; velocity and rate by the cubics that match themselves and the
// accelerations; accelerations linearly. At the recorded instants all are as recorded.
//
// A recording of poses alone gets its velocities and accelerations from the cubic spline through
// them (two continuous derivatives, no acceleration at either end): then all six are derivatives of
// one curve, and an inertial unit measures what the path implies. For a motion of angular frequency
// w the relative error of the acceleration is within (w h)^2 / 12 with a spline, and within (w h)^2
// / 8 between recorded accelerations, which are exact themselves; that of the position is within (w
// h)^4 / 384. Near the ends a spline's acceleration is wrong by up to 100 %, a quarter as much with
// every pose further in. Noise n of the poses adds up to 12 n / h^2.
//
// Before its first instant and after its last the link is at rest at that instant's pose.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "sim/link_motion.h"
#include "sim/samples/time.h"

namespace rigwire::sim {

class MotionTrack {
 public:
  /// A link at rest at this pose.
  explicit MotionTrack(const Eigen::Isometry3d& X_WL);
  /// A track with recorded velocities and accelerations. Preconditions: as many as instants, at
  /// least one; instants rise.
  MotionTrack(std::vector<SimTime> times, const std::vector<LinkMotion>& motions);
  /// A track through poses, as above, with the same preconditions.
  MotionTrack(std::vector<SimTime> times, const std::vector<Eigen::Isometry3d>& poses);

  [[nodiscard]] LinkMotion at(SimTime time) const;
  [[nodiscard]] SimTime begin() const { return times_.front(); }
  [[nodiscard]] SimTime end() const { return times_.back(); }
  [[nodiscard]] std::size_t size() const { return times_.size(); }

 private:
  struct Knot {
    Eigen::Vector3d p_W;
    Eigen::Vector4d q;  ///< x, y, z, w; on the side of the knot before.
    Eigen::Vector3d v_W = Eigen::Vector3d::Zero();
    Eigen::Vector3d w_W = Eigen::Vector3d::Zero();
    Eigen::Vector3d a_W = Eigen::Vector3d::Zero();
    Eigen::Vector3d alpha_W = Eigen::Vector3d::Zero();
  };
  void add_pose(const Eigen::Isometry3d& X_WL);
  void fit_spline();

  std::vector<SimTime> times_;
  std::vector<Knot> knots_;
};

}  // namespace rigwire::sim
