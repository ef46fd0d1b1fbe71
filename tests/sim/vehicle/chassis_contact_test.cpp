// A corner of the body on the ground: friction that gives back no more than was put in.
#include "sim/vehicle/chassis_contact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rigwire::sim {
namespace {

struct Corner {
  explicit Corner(double depth_m) {
    WheeledVehicleParameters parameters;
    parameters.body.center_of_mass_m.setZero();
    parameters.chassis.points = {{Eigen::Vector3d::Zero()}};
    stiffness_npm = 0.5 * parameters.chassis.stiffness_npm;
    greatest_n = 0.8 * parameters.chassis.stiffness_npm * depth_m;
    contact = ChassisContact(parameters);
    place.z() = -depth_m;
    SoilParameters soil;
    soil.friction = 0.8;
    ground = Ground::plane({0.0, 0.0, 1.0}, soil);
  }

  /// Friction in a step of h in which the corner slides so fast, N.
  Eigen::Vector2d step(double h, double x_mps, double y_mps) {
    Velocities v{};
    v[0] = x_mps;
    v[1] = y_mps;
    contact.begin(h, ground, place, Eigen::Matrix3d::Identity(), v);
    for (int pass = 0; pass < 12 && contact.changes(v); ++pass) {
    }
    VelocitySystem system;
    contact.add(h, v, system);
    contact.settle(h, v);
    return {system.right[0] / h, system.right[1] / h};
  }

  double stiffness_npm = 0.0;
  double greatest_n = 0.0;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  Ground ground = Ground::plane({0.0, 0.0, 1.0}, {});
  ChassisContact contact{WheeledVehicleParameters()};
};

// At the limit through its damper alone the bristle was taken for bent as far as that force bends
// it: 1.6 kJ from a slide of a tenth of a millimetre.
TEST(ChassisContact, ABristleGivesBackNoMoreThanWasPutIn) {
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
        EXPECT_LE(0.5 * kept_n * kept_n / corner.stiffness_npm, put_in_j * (1.0 + 1e-9)) << h;
      }
      EXPECT_GT(put_in_j, 0.0);
    }
  }
}

TEST(ChassisContact, AfterALongSlideTheBristleIsBentToItsLimit) {
  Corner corner(0.05);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d force = corner.step(1e-3, 1.0, -0.5);
    EXPECT_LE(force.norm(), corner.greatest_n * (1.0 + 1e-9));
  }
  EXPECT_NEAR(corner.step(1e-3, 0.0, 0.0).norm(), corner.greatest_n, 1e-6 * corner.greatest_n);
}

}  // namespace
}  // namespace rigwire::sim
