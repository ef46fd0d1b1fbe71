#include <gtest/gtest.h>

#include "bench/extrapolated_step.h"
#include "roller_rig.h"

namespace rigwire::sim {
namespace {

using namespace test;

RollerParameters kinematic() {
  RollerParameters p = bare();
  p.level = RollerLevel::kinematic;
  return p;
}

// Runs a machine until steering and ramp have settled.
void settle(TandemRoller& machine, double speed_mps, double front_rad, double rear_rad) {
  machine.command(travel(speed_mps, front_rad, rear_rad));
  machine.step(10s);
}

// Hard case 29.
TEST(RollerPath, CounterSteeringRollsBothDrumsOnOneCircleThatCloses) {
  const double steer = 20.0 * kDegree;
  const Ground ground = level();
  RollerParameters p = kinematic();
  TandemRoller machine(p, ground, {5.0, 7.0}, 0.3);
  settle(machine, 1.0, steer, -steer);
  const double base = 2.0 * p.pivot_x_m;
  const double radius = base / (2.0 * std::tan(steer));
  const Eigen::Matrix3d R = frame(machine).X_WL.linear();
  const Eigen::Vector3d centre = position(machine) + radius * R.col(1);
  const double drum_circle = radius / std::cos(steer);
  for (const std::size_t drum : {3u, 4u}) {
    const Eigen::Vector3d arm = machine.links()[drum].X_WL.translation() - centre;
    EXPECT_NEAR(arm.head<2>().norm(), drum_circle, 1e-12);
  }
  EXPECT_NEAR(frame(machine).w_WL_W.z(), own_velocity(machine).x() / radius, 1e-12);

  // Once around, in whole nanoseconds.
  const Eigen::Vector3d start = position(machine);
  const double heading = yaw_rad(machine);
  const double turn_s = 2.0 * std::numbers::pi / frame(machine).w_WL_W.z();
  machine.step(from_seconds(turn_s));
  EXPECT_LT((position(machine) - start).norm(), 1e-8);
  EXPECT_NEAR(yaw_rad(machine), heading, 1e-8);
}

TEST(RollerPath, CrabKeepsTheHeadingAndMovesAside) {
  const double steer = 23.0 * kDegree;
  const Ground ground = level();
  for (const RollerLevel which : {RollerLevel::kinematic, RollerLevel::dynamic}) {
    RollerParameters p = bare();
    p.level = which;
    TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
    settle(machine, 1.2, steer, steer);
    const Eigen::Vector3d v = own_velocity(machine);
    EXPECT_NEAR(v.y() / v.x(), std::tan(steer), 1e-3);
    EXPECT_NEAR(frame(machine).w_WL_W.z(), 0.0, 1e-9);
    // Turning both pivots one way scrubs, which may turn the dynamic frame a little.
    const double heading = yaw_rad(machine);
    EXPECT_NEAR(heading, 0.0, which == RollerLevel::kinematic ? 1e-12 : 0.03);
    machine.step(5s);
    EXPECT_NEAR(yaw_rad(machine), heading, 1e-8);
    EXPECT_NEAR(machine.vehicle_sample(machine.time()).odometry.slip_angle_rad, steer, 1e-9);
  }
}

TEST(RollerPath, KinematicArcsAreExactWhateverTheStep) {
  const Ground ground = level();
  std::array<Eigen::Vector3d, 2> end;
  for (std::size_t i = 0; i < 2; ++i) {
    RollerParameters p = kinematic();
    p.step_s = i == 0 ? 1e-3 : 50e-3;
    TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
    settle(machine, 1.0, 0.3, -0.2);
    const Eigen::Isometry3d X_start = frame(machine).X_WL;
    machine.step(20s);
    end[i] = X_start.inverse() * position(machine);
  }
  EXPECT_LT((end[0] - end[1]).norm(), 1e-7);
}

TEST(RollerPath, AccelerationsOfTheKinematicCircleAreCentripetal) {
  const Ground ground = level();
  TandemRoller machine(kinematic(), ground, {0.0, 0.0}, 0.0);
  settle(machine, 1.0, 0.3, -0.3);
  const Eigen::Vector3d a = frame(machine).X_WL.linear().transpose() * frame(machine).a_WL_W;
  EXPECT_NEAR(a.y(), own_velocity(machine).x() * frame(machine).w_WL_W.z(), 1e-9);
  EXPECT_NEAR(a.x(), 0.0, 1e-9);
}

TEST(RollerPath, DynamicTurnsWiderThanItsDrumsPointBecauseTheyScrub) {
  const double steer = 0.3;
  const Ground ground = level();
  const RollerParameters p = bare();
  TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
  settle(machine, 1.0, steer, -steer);
  machine.step(5s);
  const OdometryReading odometry = machine.vehicle_sample(machine.time()).odometry;
  const double curvature = frame(machine).w_WL_W.z() / own_velocity(machine).head<2>().norm();
  EXPECT_GT(curvature, 0.8 * odometry.curvature_1pm);
  EXPECT_LT(curvature, odometry.curvature_1pm);
  EXPECT_NEAR(odometry.curvature_1pm, std::tan(steer) / p.pivot_x_m, 1e-9);
  EXPECT_GT(machine.dynamics().drum(0).loss_w(), 0.0);
  EXPECT_GT(machine.dynamics().drum(1).loss_w(), 0.0);
}

// The more the drums grip, the nearer the dynamic path comes to the kinematic one.
TEST(RollerPath, NarrowGrippingDrumsFollowTheKinematicPath) {
  const Ground ground = level(1.0);
  RollerParameters p = bare();
  p.drum.width_m = 0.05;
  p.drum.slip_stiffness_n = 2e7;
  p.drum.cornering_stiffness_nprad = 2e7;
  TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
  settle(machine, 1.0, 0.3, -0.3);
  machine.step(5s);
  const OdometryReading odometry = machine.vehicle_sample(machine.time()).odometry;
  EXPECT_NEAR(frame(machine).w_WL_W.z() / own_velocity(machine).x(), odometry.curvature_1pm, 2e-4);
  EXPECT_NEAR(odometry.speed_mps, own_velocity(machine).x(), 2e-3);
}

// Hard case 20: on ice nothing holds, and nothing is gained or lost.
TEST(RollerPath, KeepsMomentumOnIceInCrabAtFullLock) {
  const Ground ice = level(0.0);
  RollerParameters p = bare();
  p.center_of_mass_x_m = 0.3;
  TandemRoller machine(p, ice, {0.0, 0.0}, 0.0);
  machine.command(travel(0.0, 0.5236, 0.5236));
  machine.step(5s);
  machine.set_motion(1.0, -0.5, 20.0);
  const auto centre_speed = [&] {
    const LinkMotion at =
        at_mount(frame(machine), Eigen::Isometry3d(Eigen::Translation3d(0.3, 0.0, 0.0)));
    return at.v_WL_W;
  };
  const Eigen::Vector3d momentum = centre_speed();
  machine.step(10s);
  EXPECT_NEAR(frame(machine).w_WL_W.z(), 20.0, 1e-9);
  EXPECT_LT((centre_speed() - momentum).norm(), 1e-9);
  // At a lever of 1 m behind the centre of mass: omega^2 r towards it, to the order of the step.
  const LinkMotion mount =
      at_mount(frame(machine), Eigen::Isometry3d(Eigen::Translation3d(-0.7, 0.0, 0.0)));
  const Eigen::Vector3d f = mount.X_WL.linear().transpose() * mount.a_WL_W;
  EXPECT_NEAR(f.x(), 400.0, 1e-6);
  EXPECT_NEAR(f.y(), 0.0, 1e-6);
}

TEST(RollerPath, FarFromTheOriginItMovesTheSame) {
  const Ground ground = level();
  const RollerParameters p = bare();
  TandemRoller here(p, ground, {0.0, 0.0}, 0.2);
  TandemRoller there(p, ground, {1e6, -1e6}, 0.2);
  for (TandemRoller* machine : {&here, &there}) {
    machine->command(travel(1.5, 0.2, -0.2));
    machine->step(20s);
  }
  const Eigen::Vector3d offset(1e6, -1e6, 0.0);
  EXPECT_LT((position(there) - offset - position(here)).norm(), 1e-8);
}

TEST(RollerPath, OdometryShowsSlipThatTheBodyDoesNotHave) {
  const Ground ground = level(0.1);
  RollerParameters p = bare();
  p.drive.ramp_mps2 = 10.0;
  TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
  VehicleCommand command = travel(3.0);
  machine.command(command);
  machine.step(1s);
  const double shown = machine.vehicle_sample(machine.time()).odometry.speed_mps;
  EXPECT_GT(shown, 1.2 * own_velocity(machine).x());
  EXPECT_NEAR(frame(machine).a_WL_W.x(), 0.1 * kGravity, 1e-9);
}

// Hard case 24: time is counted in whole nanoseconds, attitude stays a rotation.
TEST(RollerPath, ADayLaterTheClockIsExactAndTheFrameStillRigid) {
  const Ground ground = level();
  RollerParameters p = kinematic();
  p.step_s = 0.05;
  p.drum.strips = 1;
  TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
  machine.command(travel(1.0, 0.3, -0.3));
  machine.step(std::chrono::hours(24));
  EXPECT_EQ(machine.time(), kStart + std::chrono::hours(24));
  const Eigen::Matrix3d R = frame(machine).X_WL.linear();
  EXPECT_TRUE((R * R.transpose()).isIdentity(1e-12));
}

// The dynamic path comes nearer in proportion to the step, also where strips slide.
TEST(RollerPath, DynamicErrorIsOfFirstOrderInTheStep) {
  const Ground ground = rising(0.03, 0.8);
  const auto end = [&ground](double step_s) {
    RollerParameters p;
    p.step_s = step_s;
    p.travel_control = false;
    TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
    machine.command(travel(1.5, 0.3, -0.3));
    machine.step(6s);
    return position(machine);
  };
  const Eigen::Vector3d reference = end(1e-4);
  const double fine = (end(1e-3) - reference).norm();
  const double coarse = (end(10e-3) - reference).norm();
  EXPECT_LT(fine, 2e-3);
  EXPECT_LT(coarse, 20e-3);
  EXPECT_NEAR(coarse / fine, 11.0, 2.5);  // (10 - 0.1) / (1 - 0.1)
}

// Grip without end, so that no strip ever slides: starts on a slope, then accelerates into a
// counter-steered turn.
Eigen::Vector3d gripping_turn(double step_s, double bulk_modulus_factor = 1.0) {
  RollerParameters p = bare();
  p.drum.friction_factor = 50.0;
  p.drive.bulk_modulus_pa *= bulk_modulus_factor;
  p.step_s = step_s;
  const Ground ground = rising(0.05, 0.8);
  TandemRoller machine(p, ground, {0.0, 0.0}, 0.3);
  machine.command(travel(1.0));
  machine.step(400ms);
  machine.command(travel(3.0, 0.3, -0.25));
  machine.step(1600ms);
  return position(machine);
}

TEST(RollerPath, WithoutSlidingTheStepsExtrapolationTakesItsErrorAway) {
  const auto second = [](double step_s) {
    return bench::extrapolated(2, [&](int parts) { return gripping_turn(step_s / parts); });
  };
  const Eigen::Vector3d reference = second(1e-4);
  const double coarse = (gripping_turn(2e-3) - reference).norm();
  const double fine = (gripping_turn(1e-3) - reference).norm();
  EXPECT_NEAR(coarse / fine, 2.0, 0.1);
  EXPECT_LT((second(2e-3) - reference).norm(), 0.05 * fine);
}

TEST(RollerPath, StandsStiffOilAndLongSteps) {
  const Eigen::Vector3d reference = gripping_turn(1e-4, 1e4);
  EXPECT_LT((gripping_turn(0.02, 1e4) - reference).norm(), 0.05);
  EXPECT_LT((gripping_turn(1e-3, 1e4) - reference).norm(), 3e-3);
}

}  // namespace
}  // namespace rigwire::sim
