#include "sim/excavator/carried_arm.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "allocation_counter.h"
#include "sim/excavator/excavator.h"

namespace rigwire::sim {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr double kG = 9.80665;

ExcavatorParameters moving() {
  ExcavatorParameters parameters;
  parameters.carrier = ExcavatorCarrier::moving;
  return parameters;
}

double total_mass(const ExcavatorParameters& p) {
  return p.undercarriage.mass_kg + p.upper.mass_kg + p.boom.mass_kg + p.stick.mass_kg +
         p.bucket.mass_kg;
}

// First moment of everything above the undercarriage along x, from the arm's own gravity load: the
// swing of a machine whose gravity lies along y carries it.
double arm_moment_kgm(const JointVector& q, double payload_kg) {
  ArmDynamics arm(ExcavatorParameters{}, {0.0, -1.0, 0.0});
  arm.set_payload_kg(payload_kg);
  return arm.gravity_load(q)[0];
}

// In free flight, valves closed and the arm moving.
TEST(CarriedArm, MomentumInFreeFlightIsKept) {
  ExcavatorParameters parameters = moving();
  const Ground ground;
  DrivenArm arm(parameters, {0.0, 0.0, -kG});
  arm.gains.stiffness *= 0.01;
  const auto drift = [&](double h) {
    Eigen::Isometry3d high = Eigen::Isometry3d::Identity();
    high.translation().z() = 1000.0;
    CarriedArm machine(parameters, ground, high);
    machine.set_velocity({0.1, 0.2, -0.3}, {1.0, 0.0, 2.0});
    ArmState state{{0.2, 0.35, -1.4, -0.6}, {0.4, 0.3, -0.5, 0.8}};
    const ArmPose start = arm.pose(state.q_rad);
    const auto before = machine.momentum(arm, state);
    for (int i = 0; i < static_cast<int>(1.0 / h + 0.5); ++i) {
      const ArmPose at = arm.pose(state.q_rad);
      machine.step(h, arm, at, arm.laws(at, h, start.x, JointVector::Zero()), {}, state);
    }
    const auto after = machine.momentum(arm, state);
    const Eigen::Vector3d fallen(0.0, 0.0, -kG * total_mass(parameters));
    EXPECT_LT((after.linear_W - before.linear_W - fallen).norm(),
              60.0 * h * total_mass(parameters));
    EXPECT_GT(before.angular_W.norm(), 5e3);
    return (after.angular_W - before.angular_W).norm() / before.angular_W.norm();
  };
  const double coarse = drift(2e-3);
  const double fine = drift(1e-3);
  EXPECT_LT(fine, 1e-2);
  EXPECT_NEAR(coarse / fine, 2.0, 0.3) << "the scheme's order";
}

// Research case 22: semi-implicit Euler is off by g h t / 2, neither more nor less.
TEST(CarriedArm, FreeFallIsOffByTheSchemesKnownError) {
  const ExcavatorParameters parameters = moving();
  const Ground ground;
  const DrivenArm arm(parameters, {0.0, 0.0, -kG});
  Eigen::Isometry3d high = Eigen::Isometry3d::Identity();
  high.translation().z() = 1000.0;
  CarriedArm machine(parameters, ground, high);
  ArmState state{{0.2, 0.35, -1.4, -0.6}, JointVector::Zero()};
  const JointVector target = arm.pose(state.q_rad).x;
  const double h = 1e-3;
  for (int i = 0; i < 10000; ++i) {
    const ArmPose at = arm.pose(state.q_rad);
    machine.step(h, arm, at, arm.laws(at, h, target, JointVector::Zero()), {}, state);
  }
  const double fallen = 1000.0 - machine.X_WC().translation().z();
  EXPECT_NEAR(fallen - 0.5 * kG * 100.0, 0.5 * kG * h * 10.0, 1e-7);
}

TEST(CarriedArm, WheelLoadsAtRestAreTheLeversOfTheCentreOfMass) {
  const Ground ground;
  Excavator machine(moving(), Eigen::Isometry3d::Identity(), &ground);
  const ExcavatorParameters p;
  for (const double payload_kg : {0.0, 1000.0}) {
    machine.set_payload_kg(payload_kg);
    machine.step(seconds(15));
    ASSERT_TRUE(machine.finite());
    const double mass = total_mass(p) + payload_kg;
    const double moment = arm_moment_kgm(machine.joint_angles_rad(), payload_kg);
    const double front = kG * (0.5 * mass + moment / p.wheels.wheelbase_m);
    const auto& loads = machine.carried()->wheel_loads_n();
    EXPECT_NEAR(loads[0] + loads[1] + loads[2] + loads[3], kG * mass, 2e-4 * kG * mass);
    EXPECT_NEAR(loads[0] + loads[1], front, 0.01 * kG * mass);
    EXPECT_NEAR(loads[0], loads[1], 1.0);
  }
}

// The tip is loaded, slowly, until the rear wheels lift.
TEST(CarriedArm, RearWheelsLiftAtTheLoadOfTheClosedForm) {
  const Ground ground;
  ExcavatorParameters p = moving();
  p.initial.boom_rad = 0.35;
  Excavator machine(p, Eigen::Isometry3d::Identity(), &ground);
  machine.step(seconds(5));
  const double moment = arm_moment_kgm(machine.joint_angles_rad(), 0.0);
  const double reach = machine.tip_W().x();
  const double lever = 0.5 * p.wheels.wheelbase_m;
  // About the front wheels: mass (lever) - moment = force (reach - lever) / g.
  const double expected_n = kG * (total_mass(p) * lever - moment) / (reach - lever);
  for (int i = 1; i <= 100; ++i) {
    machine.set_bucket_force({0.0, 0.0, -0.008 * i * expected_n}, machine.tip_W());
    machine.step(milliseconds(100));
  }
  double lifts_n = 0.0;
  for (double force = 0.8 * expected_n; force < 1.2 * expected_n; force += 0.01 * expected_n) {
    machine.set_bucket_force({0.0, 0.0, -force}, machine.tip_W());
    machine.step(seconds(1));
    const auto& loads = machine.carried()->wheel_loads_n();
    if (loads[2] + loads[3] < 1.0) {
      lifts_n = force;
      break;
    }
  }
  EXPECT_NEAR(lifts_n, expected_n, 0.06 * expected_n);
}

// A plane through the origin that rises ahead of a machine of yaw 0.
Ground rising(double slope_rad, double friction) {
  SoilParameters hard;
  hard.friction = friction;
  return Ground::plane({-std::sin(slope_rad), 0.0, std::cos(slope_rad)}, hard);
}

Eigen::Isometry3d put(double yaw_rad) {
  Eigen::Isometry3d X_WC = Eigen::Isometry3d::Identity();
  X_WC.linear() = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()).matrix();
  return X_WC;
}

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

// The excavator began upright, its uphill side in the ground: thrown out, it began metres away.
TEST(CarriedArm, BeginsLeaningAsItsGroundWhereItIsPut) {
  for (const RunningGear gear : {RunningGear::tyres, RunningGear::tracks}) {
    for (const double slope_deg : {10.0, 12.0, 15.0, 18.0, 20.0}) {
      const double slope = slope_deg * kRadPerDeg;
      const Ground ground = rising(slope, 0.8);
      for (const double yaw_deg : {0.0, 90.0, 180.0, 270.0, 30.0}) {
        ExcavatorParameters p = moving();
        p.running_gear = gear;
        const Excavator machine(p, put(yaw_deg * kRadPerDeg), &ground);
        const std::string where = std::to_string(slope_deg) + " deg, yaw " +
                                  std::to_string(yaw_deg) +
                                  (gear == RunningGear::tracks ? ", tracks" : ", wheels");
        EXPECT_EQ(machine.unsteady_start(), "") << where;
        const Eigen::Isometry3d& X_WC = machine.link(Link::undercarriage).X_WL;
        EXPECT_LT(X_WC.translation().norm(), 0.05) << where;
        const Eigen::Vector3d up_W(-std::sin(slope), 0.0, std::cos(slope));
        // On tyres the lower side is pressed in: m g h sin a / (k T^2) is 1.5 degrees at 20.
        const double most_deg = gear == RunningGear::tracks ? 1.0 : 1.5;
        EXPECT_LT(std::acos(std::min(1.0, up_W.dot(X_WC.linear().col(2)))), most_deg * kRadPerDeg)
            << where;
        const Eigen::Vector3d ahead_W = X_WC.linear().col(0);
        const double turned_rad = std::remainder(
            std::atan2(ahead_W.y(), ahead_W.x()) - yaw_deg * kRadPerDeg, 2.0 * std::numbers::pi);
        EXPECT_NEAR(turned_rad, 0.0, kRadPerDeg) << where;
      }
    }
  }
}

// Closed forms: it slides where tan a > mu, and tips where the weight passes its wheels.
TEST(CarriedArm, SaysWhereItCannotStandAndWhy) {
  for (const RunningGear gear : {RunningGear::tyres, RunningGear::tracks}) {
    ExcavatorParameters p = moving();
    p.running_gear = gear;
    const auto start = [&p](double slope_rad, double friction, double yaw_rad) {
      const Ground ground = rising(slope_rad, friction);
      return Excavator(p, put(yaw_rad), &ground).unsteady_start();
    };
    for (const double yaw_rad : {0.0, 0.5 * std::numbers::pi}) {
      EXPECT_EQ(start(std::atan(0.93 * 0.2), 0.2, yaw_rad), "");
      const std::string slides = start(std::atan(1.07 * 0.2), 0.2, yaw_rad);
      EXPECT_NE(slides.find("slides, found"), std::string::npos) << slides;
      EXPECT_NE(slides.find(" after 5 s, allowed "), std::string::npos) << slides;
    }
    const std::string tips = start(45.0 * kRadPerDeg, 1.5, 0.5 * std::numbers::pi);
    EXPECT_NE(tips.find("slopes 45.0 deg it tips over"), std::string::npos) << tips;
  }
}

TEST(CarriedArm, RestsOnASlopeWithoutCreep) {
  const double slope = 0.25;
  SoilParameters hard;
  const Ground ground = Ground::plane({-std::sin(slope), 0.0, std::cos(slope)}, hard);
  Eigen::Isometry3d X_WC = Eigen::Isometry3d::Identity();
  X_WC.linear() = Eigen::AngleAxisd(-slope, Eigen::Vector3d::UnitY()).matrix();
  Excavator machine(moving(), X_WC, &ground);
  machine.step(seconds(10));
  const Eigen::Vector3d before = machine.link(Link::undercarriage).X_WL.translation();
  machine.step(seconds(60));
  ASSERT_TRUE(machine.finite());
  EXPECT_LT((machine.link(Link::undercarriage).X_WL.translation() - before).norm(), 1e-6);
  EXPECT_LT(machine.link(Link::upper).v_WL_W.norm(), 1e-7);
}

// Hard case 13, across a slope on tyres as good as rigid: tan(slope) = track / (2 height).
TEST(CarriedArm, TipsOverAtTheSlopeOfTheRigidClosedForm) {
  ExcavatorParameters p = moving();
  p.wheels.tyre.carcass_stiffness_npm *= 30.0;
  p.wheels.tyre.stiffness_per_pressure_m *= 30.0;
  p.wheels.tyre.vertical_damping_nspm *= 100.0;
  p.wheels.tyre.lateral_stiffness_npm *= 30.0;
  p.wheels.tyre.longitudinal_stiffness_npm *= 30.0;
  SoilParameters grip;
  grip.friction = 2.0;
  const auto on = [&](double slope) {
    Eigen::Isometry3d X_WC = Eigen::Isometry3d::Identity();
    X_WC.linear() = Eigen::AngleAxisd(slope, Eigen::Vector3d::UnitX()).matrix();
    return X_WC;
  };
  double height_mass = 0.0;
  {
    const Ground ground;
    Excavator machine(p, on(0.0), &ground);
    machine.step(seconds(3));
    const std::array<std::pair<Link, const RigidBodyParameters*>, 5> bodies{
        {{Link::undercarriage, &p.undercarriage},
         {Link::upper, &p.upper},
         {Link::boom, &p.boom},
         {Link::stick, &p.stick},
         {Link::bucket, &p.bucket}}};
    for (const auto& [link, body] : bodies) {
      height_mass += body->mass_kg * (machine.link(link).X_WL * body->center_of_mass_m).z();
    }
  }
  const double limit = std::atan(0.5 * p.wheels.track_m * total_mass(p) / height_mass);
  const auto turned_after = [&](double slope) {
    const Ground ground = Ground::plane({0.0, -std::sin(slope), std::cos(slope)}, grip);
    Excavator machine(p, on(slope), &ground);
    machine.step(seconds(4));
    const Eigen::Matrix3d R = machine.link(Link::undercarriage).X_WL.linear();
    return std::abs(std::atan2(R(2, 1), R(2, 2)) - slope);
  };
  EXPECT_LT(turned_after(0.96 * limit), 0.01);
  EXPECT_GT(turned_after(1.01 * limit), 0.2);
}

TEST(CarriedArm, SlidesDownASlopeThatItsFrictionCannotHold) {
  const double slope = 0.25;
  SoilParameters ice;
  ice.friction = 0.05;
  const Ground ground = Ground::plane({-std::sin(slope), 0.0, std::cos(slope)}, ice);
  Eigen::Isometry3d X_WC = Eigen::Isometry3d::Identity();
  X_WC.linear() = Eigen::AngleAxisd(-slope, Eigen::Vector3d::UnitY()).matrix();
  Excavator machine(moving(), X_WC, &ground);
  const LinkMotion before = machine.link(Link::undercarriage);
  machine.step(seconds(2));
  const LinkMotion after = machine.link(Link::undercarriage);
  const double friction = 0.05 * moving().wheels.tyre.friction_factor;
  const double expected = kG * (std::sin(slope) - friction * std::cos(slope));
  EXPECT_NEAR((after.v_WL_W - before.v_WL_W).norm() / 2.0, expected, 0.05 * expected);
}

TEST(CarriedArm, RocksWhenTheArmStopsAndComesToRest) {
  const Ground ground;
  Excavator machine(moving(), Eigen::Isometry3d::Identity(), &ground);
  machine.step(seconds(5));
  const Eigen::Matrix3d level = machine.link(Link::undercarriage).X_WL.linear();
  ValveCommand command;
  command.opening[1] = -0.8;
  machine.command(command);
  machine.step(milliseconds(800));
  machine.command(ValveCommand{});
  double greatest = 0.0;
  for (int i = 0; i < 100; ++i) {
    machine.step(milliseconds(10));
    greatest = std::max(greatest, Eigen::AngleAxisd(level.transpose() *
                                                    machine.link(Link::undercarriage).X_WL.linear())
                                      .angle());
  }
  EXPECT_GT(greatest, 1e-3);
  machine.step(seconds(30));
  EXPECT_LT(machine.link(Link::upper).v_WL_W.norm(), 1e-8);
}

TEST(CarriedArm, LinkAccelerationsAreTheSlopeOfTheirVelocities) {
  const Ground ground;
  Excavator machine(moving(), Eigen::Isometry3d::Identity(), &ground);
  ValveCommand command;
  command.opening = {0.6, 0.5, -0.4, 0.4};
  machine.command(command);
  LinkMotion before;
  for (int i = 0; i < 700; ++i) {
    before = machine.link(Link::bucket);
    machine.step(milliseconds(1));
  }
  const LinkMotion& now = machine.link(Link::bucket);
  EXPECT_LT(((now.v_WL_W - before.v_WL_W) / 1e-3 - now.a_WL_W).norm(),
            0.02 + 0.05 * now.a_WL_W.norm());
}

TEST(CarriedArm, EveryLevelWithForcesStaysSoundAndAllocatesNothing) {
  const Ground ground;
  for (const ExcavatorLevel level :
       {ExcavatorLevel::quasi_static, ExcavatorLevel::dynamic, ExcavatorLevel::chambers}) {
    ExcavatorParameters parameters = moving();
    parameters.level = level;
    Excavator machine(parameters, Eigen::Isometry3d::Identity(), &ground);
    const auto before = rigwire::test::allocations();
    for (int i = 0; i < 300; ++i) {
      ValveCommand command;
      const double sign = i % 100 < 50 ? 1.0 : -1.0;
      command.opening = {0.8 * sign, sign, -0.7 * sign, 0.9 * sign};
      machine.command(command);
      machine.set_bucket_resistance({.gain_nspm = 1e6, .limit_n = 3e4});
      machine.step(milliseconds(10));
    }
    EXPECT_EQ(rigwire::test::allocations(), before);
    EXPECT_TRUE(machine.finite());
    EXPECT_LT(machine.link(Link::undercarriage).X_WL.translation().norm(), 3.0);
    EXPECT_GT(machine.link(Link::undercarriage).X_WL.linear()(2, 2), 0.9);
  }
}

TEST(CarriedArm, AMovingCarrierNeedsAGroundAndForces) {
  EXPECT_THROW(Excavator(moving(), Eigen::Isometry3d::Identity()), std::invalid_argument);
  ExcavatorParameters parameters = moving();
  parameters.level = ExcavatorLevel::kinematic;
  EXPECT_THROW(validate(parameters), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
