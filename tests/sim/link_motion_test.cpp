#include "sim/link_motion.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;

/// A body on a circle of radius 3 m about the world's z, one turn in 2 pi / w seconds.
LinkMotion on_circle(double t_s, double w_radps) {
  LinkMotion motion;
  const double angle = w_radps * t_s;
  motion.X_WL.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  motion.X_WL.translation() = Eigen::Vector3d(3.0 * std::cos(angle), 3.0 * std::sin(angle), 1.0);
  motion.w_WL_W = w_radps * Eigen::Vector3d::UnitZ();
  motion.v_WL_W = motion.w_WL_W.cross(motion.X_WL.translation());
  motion.a_WL_W = motion.w_WL_W.cross(motion.v_WL_W);
  return motion;
}

double attitude_error(const LinkMotion& a, const LinkMotion& b) {
  return Eigen::AngleAxisd(a.X_WL.linear().transpose() * b.X_WL.linear()).angle();
}

TEST(LinkMotionInterpolation, IsExactAtBothEnds) {
  const LinkMotion a = on_circle(0.0, 2.0);
  const LinkMotion b = on_circle(0.01, 2.0);
  const LinkMotionInterpolation between(kStart, a, kStart + 10ms, b);
  EXPECT_LT((between(kStart).X_WL.matrix() - a.X_WL.matrix()).norm(), 1e-14);
  EXPECT_LT((between(kStart + 10ms).X_WL.matrix() - b.X_WL.matrix()).norm(), 1e-14);
  EXPECT_EQ(between(kStart + 10ms).v_WL_W, b.v_WL_W);
}

TEST(LinkMotionInterpolation, FollowsASteadyTurnToRounding) {
  for (const double w : {1e-6, 0.1, 1.0, 20.0, 250.0}) {  // up to 2.5 rad in a step
    const LinkMotionInterpolation between(kStart, on_circle(0.0, w), kStart + 10ms,
                                          on_circle(0.01, w));
    for (const auto time : {1ms, 3ms, 5ms, 9ms}) {
      EXPECT_LT(attitude_error(between(kStart + time), on_circle(to_seconds(kStart + time), w)),
                2e-8)  // of the angle's own rounding; see below for small turns
          << w;
    }
  }
  const LinkMotionInterpolation still(kStart, on_circle(0.0, 0.0), kStart + 10ms,
                                      on_circle(0.0, 0.0));
  EXPECT_EQ(still(kStart + 5ms).X_WL.linear(), Eigen::Matrix3d::Identity());
}

TEST(LinkMotionInterpolation, PositionErrorFallsWithTheFourthPowerOfTheStep) {
  const auto middle_error = [](double h_s) {
    const LinkMotionInterpolation between(kStart, on_circle(0.0, 1.0), kStart + from_seconds(h_s),
                                          on_circle(h_s, 1.0));
    return (between(kStart + from_seconds(h_s / 2)).X_WL.translation() -
            on_circle(h_s / 2, 1.0).X_WL.translation())
        .norm();
  };
  EXPECT_NEAR(middle_error(0.2) / middle_error(0.1), 16.0, 0.5);
  EXPECT_LT(middle_error(0.002), 1e-12);
}

TEST(LinkMotionInterpolation, TakesTheShortWayAcrossTheQuaternionsSign) {
  LinkMotion a;
  LinkMotion b;
  a.X_WL.linear() = Eigen::AngleAxisd(3.1, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  b.X_WL.linear() = Eigen::AngleAxisd(-3.1, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const LinkMotion middle = LinkMotionInterpolation(kStart, a, kStart + 2ms, b)(kStart + 1ms);
  EXPECT_NEAR(middle.X_WL.linear()(0, 0), -1.0, 1e-12);  // half a turn, not none
}

TEST(AtMount, ALeverArmAddsTangentialAndCentripetalTerms) {
  LinkMotion link;
  link.w_WL_W = 2.0 * Eigen::Vector3d::UnitZ();
  link.alpha_WL_W = 3.0 * Eigen::Vector3d::UnitZ();
  Eigen::Isometry3d X_LS = Eigen::Isometry3d::Identity();
  X_LS.translation() = Eigen::Vector3d(1.5, 0.0, 0.0);
  const LinkMotion sensor = at_mount(link, X_LS);
  EXPECT_TRUE(sensor.v_WL_W.isApprox(Eigen::Vector3d(0.0, 3.0, 0.0), 1e-15));
  EXPECT_TRUE(sensor.a_WL_W.isApprox(Eigen::Vector3d(-6.0, 4.5, 0.0), 1e-15));
}

}  // namespace
}  // namespace rigwire::sim
