#include "sim/link_motion.h"

#include <cassert>

namespace rigwire::sim {

LinkMotion interpolate(SimTime t0, const LinkMotion& at_t0, SimTime t1, const LinkMotion& at_t1,
                       SimTime time) {
  assert(t0 < t1 && t0 <= time && time <= t1);
  const double h = to_seconds(t1 - t0);
  const double s = to_seconds(time - t0) / h;
  const double s2 = s * s;
  const double s3 = s2 * s;

  LinkMotion result;
  const Eigen::Vector3d position = (2.0 * s3 - 3.0 * s2 + 1.0) * at_t0.X_WL.translation() +
                                   (s3 - 2.0 * s2 + s) * h * at_t0.v_WL_W +
                                   (3.0 * s2 - 2.0 * s3) * at_t1.X_WL.translation() +
                                   (s3 - s2) * h * at_t1.v_WL_W;
  const Eigen::Quaterniond q0(at_t0.X_WL.linear());
  const Eigen::Quaterniond q1(at_t1.X_WL.linear());
  result.X_WL.linear() = q0.slerp(s, q1).toRotationMatrix();
  result.X_WL.translation() = position;
  result.v_WL_W = (1.0 - s) * at_t0.v_WL_W + s * at_t1.v_WL_W;
  result.w_WL_W = (1.0 - s) * at_t0.w_WL_W + s * at_t1.w_WL_W;
  result.a_WL_W = (1.0 - s) * at_t0.a_WL_W + s * at_t1.a_WL_W;
  result.alpha_WL_W = (1.0 - s) * at_t0.alpha_WL_W + s * at_t1.alpha_WL_W;
  return result;
}

LinkMotion at_mount(const LinkMotion& link, const Eigen::Isometry3d& X_LS) {
  LinkMotion sensor;
  const Eigen::Vector3d r_W = link.X_WL.linear() * X_LS.translation();
  sensor.X_WL = link.X_WL * X_LS;
  sensor.v_WL_W = link.v_WL_W + link.w_WL_W.cross(r_W);
  sensor.w_WL_W = link.w_WL_W;
  sensor.a_WL_W =
      link.a_WL_W + link.alpha_WL_W.cross(r_W) + link.w_WL_W.cross(link.w_WL_W.cross(r_W));
  sensor.alpha_WL_W = link.alpha_WL_W;
  return sensor;
}

}  // namespace rigwire::sim
