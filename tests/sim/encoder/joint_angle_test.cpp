#include "sim/encoder/joint_angle.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigwire::sim {
namespace {

LinkMotion turned(const Eigen::Quaterniond& attitude, const Eigen::Vector3d& rate_W) {
  LinkMotion motion;
  motion.X_WL.linear() = attitude.toRotationMatrix();
  motion.w_WL_W = rate_W;
  return motion;
}

TEST(JointAngle, CountsTurnsAboutEachAxisOfATiltedBase) {
  const Eigen::Quaterniond base_attitude =
      Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()) *
      Eigen::Quaterniond(Eigen::AngleAxisd(-0.4, Eigen::Vector3d::UnitY()));
  const LinkMotion base = turned(base_attitude, {0.1, 0.2, 0.3});
  for (int axis = 0; axis < 3; ++axis) {
    JointAngle joint(axis);
    const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
    for (int i = 0; i <= 200; ++i) {
      const double angle = -0.1 * i;
      const LinkMotion moving =
          turned(base_attitude * Eigen::Quaterniond(Eigen::AngleAxisd(angle, unit)),
                 base.w_WL_W + base_attitude * unit * -0.7);
      const EncoderSample sample = joint.sample(kStart, base, moving);
      EXPECT_NEAR(sample.angle_rad, angle, 1e-12) << axis;
      EXPECT_NEAR(sample.rate_radps, -0.7, 1e-12) << axis;
    }
  }
}

}  // namespace
}  // namespace rigwire::sim
