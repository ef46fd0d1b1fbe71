#include "sim/encoder/joint_angle.h"

#include <cmath>

#include "fields/constants.h"

namespace rigwire::sim {

EncoderSample JointAngle::sample(SimTime time, const LinkMotion& base, const LinkMotion& moving) {
  const Eigen::Matrix3d R_BM = base.X_WL.linear().transpose() * moving.X_WL.linear();
  const int first = (axis_ + 1) % 3;
  const int second = (axis_ + 2) % 3;
  // Angle of a rotation about this axis, carried on to the nearest turn.
  const double wrapped = std::atan2(R_BM(second, first), R_BM(first, first));
  if (angle_rad_) {
    *angle_rad_ += std::remainder(wrapped - *angle_rad_, kTurn);
  } else {
    angle_rad_ = wrapped;
  }
  // Relative angular velocity along the axis.
  const double rate = base.X_WL.linear().col(axis_).dot(moving.w_WL_W - base.w_WL_W);
  return {time, *angle_rad_, rate};
}

}  // namespace rigwire::sim
