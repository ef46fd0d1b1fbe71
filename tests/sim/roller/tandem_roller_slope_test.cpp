#include <gtest/gtest.h>

#include "roller_rig.h"

namespace rigwire::sim {
namespace {

using namespace test;

// Hard case 8: for ever means an hour.
TEST(RollerOnASlope, StandsForAnHourWithinAMicrometre) {
  for (const double slope : {5.0, 20.0, 30.0}) {
    RollerParameters p = bare();
    p.step_s = 0.02;
    const Ground ground = rising(slope * kDegree, 0.8);
    TandemRoller machine(p, ground, {3.0, -2.0}, 0.4);
    machine.step(10s);
    const Eigen::Vector3d before = position(machine);
    const double yaw = yaw_rad(machine);
    machine.step(std::chrono::hours(1));
    EXPECT_LT((position(machine) - before).norm(), 1e-6) << slope;
    EXPECT_NEAR(yaw_rad(machine), yaw, 1e-7) << slope;
    EXPECT_LT(frame(machine).v_WL_W.norm(), 1e-12) << slope;
  }
}

TEST(RollerOnASlope, SlidesWithLockedDrumsWhenTheSlopeIsSteeperThanFriction) {
  const double slope = 35.0 * kDegree;
  const double friction = 0.6;
  RollerParameters p = bare();
  p.parking_brake_torque_nm = 1e5;
  const Ground ground = rising(slope, friction);
  TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
  machine.step(1s);
  const double wanted = kGravity * (std::sin(slope) - friction * std::cos(slope));
  EXPECT_NEAR(frame(machine).a_WL_W.norm(), wanted, 1e-9);
  EXPECT_NEAR(frame(machine).v_WL_W.norm(), wanted * 1.0, 5e-3);
  EXPECT_NEAR(machine.drum_rate_radps(0), 0.0, 1e-3);
}

// Hard case 26.
TEST(RollerOnASlope, AnAccelerometerAtRestFeelsGravityTurned) {
  for (const double slope : {0.0, 12.0}) {
    const Ground ground = rising(slope * kDegree, 0.8);
    TandemRoller machine(bare(), ground, {0.0, 0.0}, 0.0);
    machine.step(5s);
    const Eigen::Vector3d wanted(kGravity * std::sin(slope * kDegree), 0.0,
                                 kGravity * std::cos(slope * kDegree));
    for (const LinkMotion& link : machine.links().first(3)) {
      EXPECT_LT((specific_force(link) - wanted).norm(), 1e-9) << slope;
      EXPECT_LT(link.w_WL_W.norm(), 1e-12) << slope;
    }
  }
}

// Hard case 28: both drums freewheel.
TEST(RollerOnASlope, RollsDownInNeutralAsItsDrumsInertiaSays) {
  const double slope = 8.0 * kDegree;
  RollerParameters p = bare();
  p.drive.bypass = true;
  p.drum.slip_stiffness_n = 5e8;
  const Ground ground = rising(slope, 0.8);
  TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
  machine.command(travel(0.0));
  machine.step(3s);
  const double start = frame(machine).v_WL_W.norm();
  machine.step(4s);
  const double radius2 = p.drum.radius_m * p.drum.radius_m;
  const double wanted =
      kGravity * std::sin(slope) / (1.0 + 2.0 * p.drum.spin_inertia_kgm2 / (p.mass_kg * radius2));
  EXPECT_NEAR((frame(machine).v_WL_W.norm() - start) / 4.0, wanted, 1e-5);
  EXPECT_NEAR(frame(machine).a_WL_W.norm(), wanted, 1e-5);
  EXPECT_LT(own_velocity(machine).x(), 0.0);
}

TEST(RollerOnASlope, CreepsByLeakageUntilTheParkingBrakeIsOn) {
  const double slope = 10.0 * kDegree;
  const RollerParameters p = bare();
  const Ground ground = rising(slope, 0.8);
  TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
  machine.command(travel(0.0));
  machine.step(30s);
  // Leakage at the pressure that holds the weight, over both motors; friction of the motors takes
  // its small share.
  const double d = p.drive.motor_displacement_m3prad;
  const double radius = p.drum.radius_m;
  const double torque = p.mass_kg * kGravity * std::sin(slope) * radius;
  const double rate =
      torque / (2.0 * (2.0 * d * d / p.drive.leakage_m3pspa + p.drive.motor_friction_nmsprad));
  EXPECT_NEAR(machine.drum_rate_radps(0), -rate, 1e-3 * rate);
  EXPECT_LT(rate * radius, 0.015);
  machine.command(VehicleCommand{});
  machine.step(20s);
  const Eigen::Vector3d before = position(machine);
  machine.step(20s);
  EXPECT_LT((position(machine) - before).norm(), 1e-7);
}

TEST(RollerOnASlope, BrakesOnTheFrictionLimitAndThenStands) {
  RollerParameters p = bare();
  p.drive.bypass = true;
  p.brake_torque_nm = 1e5;
  const double friction = 0.5;
  const Ground ground = level(friction);
  TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
  VehicleCommand command = travel(0.0);
  command.brake_share = 1.0;
  machine.command(command);
  machine.set_motion(3.0, 0.0, 0.0);
  machine.step(5s);
  EXPECT_NEAR(position(machine).x(), 9.0 / (2.0 * friction * kGravity), 0.02);
  EXPECT_LT(frame(machine).v_WL_W.norm(), 1e-9);
  EXPECT_NEAR(position(machine).y(), 0.0, 1e-9);
}

TEST(RollerOnASlope, LightBrakingDoesNotSlide) {
  RollerParameters p = bare();
  p.drive.bypass = true;
  const Ground ground = level(0.8);
  TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
  machine.set_motion(3.0, 0.0, 0.0);
  VehicleCommand command = travel(0.0);
  command.brake_share = 0.2;
  machine.command(command);
  machine.step(1s);
  const double radius = p.drum.radius_m;
  const double inertia = p.mass_kg + 2.0 * p.drum.spin_inertia_kgm2 / (radius * radius);
  const double wanted = 2.0 * 0.2 * p.brake_torque_nm / radius / inertia;
  EXPECT_NEAR(-frame(machine).a_WL_W.x(), wanted, 5e-3 * wanted);
  EXPECT_EQ(machine.dynamics().drum(0).sliding_strips(), 0);
  EXPECT_EQ(machine.dynamics().unsettled_steps(), 0u);
}

TEST(RollerOnASlope, LoadsFollowSlopeAndLeverOfTheCentreOfMass) {
  const double slope = 15.0 * kDegree;
  const RollerParameters p = bare();
  const Ground ground = rising(slope, 0.8);
  TandemRoller uphill(p, ground, {0.0, 0.0}, 0.0);
  uphill.step(1s);
  const double weight = p.mass_kg * kGravity;
  const double front =
      weight * (std::cos(slope) * p.pivot_x_m - std::sin(slope) * p.center_of_mass_height_m) /
      (2.0 * p.pivot_x_m);
  EXPECT_NEAR(uphill.drum_load_n(0), front, 1e-6 * weight);
  EXPECT_NEAR(uphill.drum_load_n(0) + uphill.drum_load_n(1), weight * std::cos(slope),
              1e-9 * weight);
}

}  // namespace
}  // namespace rigwire::sim
