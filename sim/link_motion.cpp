#include "sim/link_motion.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace rigwire::sim {

namespace {

/// sin(share * angle) / sin(angle), to 1e-12 also where the angle is tiny or zero.
double sine_ratio(double share, double angle_rad) {
  if (angle_rad > 0.05) {
    return std::sin(share * angle_rad) / std::sin(angle_rad);
  }
  const auto over_x = [](double x) {  // sin(x) / x
    const double x2 = x * x;
    return 1.0 - x2 / 6.0 * (1.0 - x2 / 20.0 * (1.0 - x2 / 42.0));
  };
  return share * over_x(share * angle_rad) / over_x(angle_rad);
}

}  // namespace

LinkMotionInterpolation::LinkMotionInterpolation(SimTime t0, const LinkMotion& at_t0, SimTime t1,
                                                 const LinkMotion& at_t1)
    : t0_(t0),
      t1_(t1),
      at_t0_(at_t0),
      at_t1_(at_t1),
      q0_(at_t0.X_WL.linear()),
      q1_(at_t1.X_WL.linear()) {
  assert(t0 < t1);
  if (q0_.dot(q1_) < 0.0) {
    q1_.coeffs() = -q1_.coeffs();
  }
  // From the chord: exact for small angles, where the arc cosine is not.
  half_angle_rad_ = 2.0 * std::asin(std::min(1.0, 0.5 * (q1_.coeffs() - q0_.coeffs()).norm()));
}

LinkMotion LinkMotionInterpolation::operator()(SimTime time) const {
  assert(t0_ <= time && time <= t1_);
  const double h = to_seconds(t1_ - t0_);
  const double s = to_seconds(time - t0_) / h;
  const double s2 = s * s;
  const double s3 = s2 * s;

  LinkMotion result;
  Eigen::Quaterniond q;
  // Spherical linear interpolation of the attitude, cubic Hermite of the position.
  q.coeffs() = sine_ratio(1.0 - s, half_angle_rad_) * q0_.coeffs() +
               sine_ratio(s, half_angle_rad_) * q1_.coeffs();
  result.X_WL.linear() = q.toRotationMatrix();
  result.X_WL.translation() = (2.0 * s3 - 3.0 * s2 + 1.0) * at_t0_.X_WL.translation() +
                              (s3 - 2.0 * s2 + s) * h * at_t0_.v_WL_W +
                              (3.0 * s2 - 2.0 * s3) * at_t1_.X_WL.translation() +
                              (s3 - s2) * h * at_t1_.v_WL_W;
  result.v_WL_W = (1.0 - s) * at_t0_.v_WL_W + s * at_t1_.v_WL_W;
  result.w_WL_W = (1.0 - s) * at_t0_.w_WL_W + s * at_t1_.w_WL_W;
  result.a_WL_W = (1.0 - s) * at_t0_.a_WL_W + s * at_t1_.a_WL_W;
  result.alpha_WL_W = (1.0 - s) * at_t0_.alpha_WL_W + s * at_t1_.alpha_WL_W;
  return result;
}

LinkMotion at_mount(const LinkMotion& link, const Eigen::Isometry3d& X_LS) {
  LinkMotion sensor;
  const Eigen::Vector3d r_W = link.X_WL.linear() * X_LS.translation();
  sensor.X_WL = link.X_WL * X_LS;
  // Rigid body: v + w x r, a + alpha x r + w x (w x r).
  sensor.v_WL_W = link.v_WL_W + link.w_WL_W.cross(r_W);
  sensor.w_WL_W = link.w_WL_W;
  sensor.a_WL_W =
      link.a_WL_W + link.alpha_WL_W.cross(r_W) + link.w_WL_W.cross(link.w_WL_W.cross(r_W));
  sensor.alpha_WL_W = link.alpha_WL_W;
  return sensor;
}

}  // namespace rigwire::sim
