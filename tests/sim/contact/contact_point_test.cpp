// One point of contact across its normal: friction that gives back no more than was put in.
#include "sim/contact/contact_point.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigwire::sim {
namespace {

struct Corner {
  explicit Corner(double depth_m) {
    point.gap_m = -depth_m;
    point.law = {.stiffness_npm = 1e6, .damping_nspm = 2e4, .friction = 0.8, .bristle_npm = 5e5};
    point.direction_W = {Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX(),
                         Eigen::Vector3d::UnitY()};
    greatest_n = 0.8 * point.law.stiffness_npm * depth_m;
  }

  /// Friction in a step of h in which the corner slides so fast, N.
  Eigen::Vector2d step(double h, double x_mps, double y_mps) {
    const std::array<double, 3> v{0.0, x_mps, y_mps};
    point.begin(h, v);
    for (int pass = 0; pass < 12 && point.changes(v); ++pass) {
    }
    point.settle(h, v);
    return {point.force_n[1], point.force_n[2]};
  }

  ContactPoint point;
  double greatest_n = 0.0;
};

// At the limit through its damper alone the bristle was taken for bent as far as that force bends
// it: 1.6 kJ from a slide of a tenth of a millimetre.
TEST(ContactPoint, ABristleGivesBackNoMoreThanWasPutIn) {
  for (const double h : {1e-4, 1e-3, 5e-3}) {
    for (const double bearing : {0.0, 0.7, 2.5}) {
      Corner corner(0.05);
      const double speed = 3.0;
      const Eigen::Vector2d slide = speed * Eigen::Vector2d(std::cos(bearing), std::sin(bearing));
      double put_in_j = 0.0;
      for (int i = 0; i < 3; ++i) {
        const Eigen::Vector2d force = corner.step(h, slide.x(), slide.y());
        EXPECT_LE(force.norm(), corner.greatest_n * (1.0 + 1e-9));
        put_in_j -= h * force.dot(slide);
        // Held still, only the spring is left of the force.
        Corner still = corner;
        const double kept_n = still.step(h, 0.0, 0.0).norm();
        EXPECT_LE(0.5 * kept_n * kept_n / corner.point.law.bristle_npm, put_in_j * (1.0 + 1e-9))
            << h;
      }
      EXPECT_GT(put_in_j, 0.0);
    }
  }
}

TEST(ContactPoint, AfterALongSlideTheBristleIsBentToItsLimit) {
  Corner corner(0.05);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d force = corner.step(1e-3, 1.0, -0.5);
    EXPECT_LE(force.norm(), corner.greatest_n * (1.0 + 1e-9));
  }
  EXPECT_NEAR(corner.step(1e-3, 0.0, 0.0).norm(), corner.greatest_n, 1e-6 * corner.greatest_n);
}

}  // namespace
}  // namespace rigwire::sim
