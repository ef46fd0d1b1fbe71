#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "allocation_counter.h"
#include "roller_rig.h"
#include "sim/roller/stability.h"

namespace rigwire::sim {
namespace {

using namespace test;

constexpr IntegrationScheme kStaged[] = {IntegrationScheme::rosenbrock2,
                                         IntegrationScheme::runge_kutta4};

RollerParameters with(RollerParameters p, IntegrationScheme scheme, double step_s) {
  p.scheme = scheme;
  p.step_s = step_s;
  return p;
}

// Grip without end: no strip ever slides.
RollerParameters gripping() {
  RollerParameters p = bare();
  p.drum.friction_factor = 50.0;
  return p;
}

struct Way {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double yaw = 0.0;
  std::uint64_t steps = 0;
  std::uint64_t smooth = 0;
};

// Starts on a slope, then accelerates into a counter-steered turn: nothing meets a limit.
Way turn(const RollerParameters& p) {
  const Ground ground = rising(0.05, 0.8);
  TandemRoller machine(p, ground, {0.0, 0.0}, 0.3);
  machine.command(travel(1.0));
  machine.step(400ms);
  machine.command(travel(3.0, 0.3, -0.25));
  machine.step(1600ms);
  return {position(machine), yaw_rad(machine), machine.dynamics().smooth_tried(),
          machine.dynamics().smooth_steps()};
}

double away(const Way& a, const Way& b) {
  return (a.position - b.position).norm() + std::abs(a.yaw - b.yaw);
}

// Turn with sliding strips, crab, reversal.
Way scrub(const RollerParameters& p) {
  const Ground ground = rising(0.05, 0.8);
  TandemRoller machine(p, ground, {0.0, 0.0}, 0.3);
  machine.command(travel(1.5, 0.3, -0.25));
  machine.step(4s);
  machine.command(travel(-1.0, 0.2, 0.2));
  machine.step(3s);
  return {position(machine), yaw_rad(machine), machine.dynamics().smooth_tried(),
          machine.dynamics().smooth_steps()};
}

TEST(RollerSchemes, HaveTheirOrderInSmoothMotion) {
  const Way reference = turn(with(gripping(), IntegrationScheme::runge_kutta4, 2e-4));
  const auto error = [&](IntegrationScheme scheme, double step_s) {
    const Way found = turn(with(gripping(), scheme, step_s));
    EXPECT_EQ(found.smooth, found.steps);
    return away(found, reference);
  };
  const double euler = error(IntegrationScheme::linearly_implicit_euler, 2e-3) /
                       error(IntegrationScheme::linearly_implicit_euler, 1e-3);
  EXPECT_NEAR(euler, 2.0, 0.1);
  const double ros2 =
      error(IntegrationScheme::rosenbrock2, 4e-3) / error(IntegrationScheme::rosenbrock2, 2e-3);
  EXPECT_NEAR(ros2, 4.0, 0.3);
  EXPECT_LT(error(IntegrationScheme::rosenbrock2, 1e-3), 1e-5);
  EXPECT_LT(error(IntegrationScheme::runge_kutta4, 4e-3), 1e-7);
}

TEST(RollerSchemes, RungeKutta4IsOfFourthOrderWhereNothingHasAKink) {
  const auto coasting = [](double step_s) {
    RollerParameters p = with(gripping(), IntegrationScheme::runge_kutta4, step_s);
    p.drive.bypass = true;
    const Ground ground = rising(0.1, 0.8);
    TandemRoller machine(p, ground, {0.0, 0.0}, 0.3);
    machine.command(travel(0.0));
    machine.set_motion(1.0, 0.02, 0.01);
    machine.step(480ms);
    return Way{position(machine), yaw_rad(machine), 0, 0};
  };
  const Way reference = coasting(5e-4);
  const double coarse = away(coasting(4e-3), reference);
  const double fine = away(coasting(2e-3), reference);
  EXPECT_GT(coarse / fine, 12.0);
  EXPECT_LT(coarse, 1e-8);
}

TEST(RollerSchemes, AgreeAtFineStepsAlsoWithSlidingStrips) {
  const Way euler =
      scrub(with(RollerParameters{}, IntegrationScheme::linearly_implicit_euler, 2e-5));
  for (const IntegrationScheme scheme : kStaged) {
    const Way found = scrub(with(RollerParameters{}, scheme, 2e-4));
    EXPECT_LT(away(found, euler), 2e-4);
    EXPECT_GT(found.smooth, found.steps / 10 * 9);
    EXPECT_LT(found.smooth, found.steps);  // Limits were met.
  }
}

TEST(RollerSchemes, Rosenbrock2StandsStiffOilAndLongSteps) {
  RollerParameters p = gripping();
  p.drive.bulk_modulus_pa *= 1e4;
  const Way reference = turn(with(p, IntegrationScheme::rosenbrock2, 1e-4));
  EXPECT_LT(away(turn(with(p, IntegrationScheme::rosenbrock2, 0.02)), reference), 0.02);
  EXPECT_LT(away(turn(with(p, IntegrationScheme::rosenbrock2, 1e-3)), reference), 1e-3);
}

// Hard case 8.
TEST(RollerSchemes, StandStillOnASlope) {
  for (const IntegrationScheme scheme : kStaged) {
    const Ground ground = rising(20.0 * kDegree, 0.8);
    TandemRoller machine(with(bare(), scheme, 4e-3), ground, {3.0, -2.0}, 0.4);
    machine.step(10s);
    const Eigen::Vector3d before = position(machine);
    machine.step(600s);
    EXPECT_LT((position(machine) - before).norm(), 1e-9);
    EXPECT_LT(frame(machine).v_WL_W.norm(), 1e-12);
  }
}

// Hard case 9.
TEST(RollerSchemes, BrakeToZeroAndStay) {
  for (const IntegrationScheme scheme : kStaged) {
    const Ground ground = rising(5.0 * kDegree, 0.8);
    TandemRoller machine(with(RollerParameters{}, scheme, 2e-3), ground, {0.0, 0.0}, 0.0);
    machine.command(travel(2.5));
    machine.step(6s);
    VehicleCommand stop = travel(0.0);
    stop.brake_share = 1.0;
    stop.parking_brake = true;
    machine.command(stop);
    machine.step(20s);  // Pressure leaks away, brakes and strips stretch back.
    const Eigen::Vector3d before = position(machine);
    machine.step(20s);
    EXPECT_LT((position(machine) - before).norm(), 1e-7);
    EXPECT_LT(frame(machine).v_WL_W.norm(), 1e-9);
  }
}

// Nothing pushes on ice: momentum stays, whatever the yaw does.
TEST(RollerSchemes, KeepMomentumOnIce) {
  for (const IntegrationScheme scheme : kStaged) {
    RollerParameters p = with(bare(), scheme, 2e-3);
    p.drive.bypass = true;
    p.drum.friction_factor = 0.0;
    const Ground ground = level();
    TandemRoller machine(p, ground, {0.0, 0.0}, 0.0);
    machine.command(travel(0.0));
    machine.set_motion(2.0, -1.0, 3.0);
    machine.step(5s);
    EXPECT_NEAR(frame(machine).v_WL_W.x(), 2.0, 1e-9);
    EXPECT_NEAR(frame(machine).v_WL_W.y(), -1.0, 1e-9);
    EXPECT_NEAR(position(machine).x(), 10.0, 1e-8);
    EXPECT_NEAR(frame(machine).w_WL_W.z(), 3.0, 1e-12);
  }
}

TEST(RollerSchemes, DoNotAllocateInAStep) {
  for (const IntegrationScheme scheme : kStaged) {
    const Ground ground = rising(0.05, 0.7);
    TandemRoller machine(with(RollerParameters{}, scheme, 2e-3), ground, {0.0, 0.0}, 0.0);
    machine.command(travel(1.5, 0.3, -0.25));
    const auto before = rigwire::test::allocations();
    machine.step(2s);
    machine.command(travel(-1.5, 0.2, 0.2));
    machine.step(2s);
    EXPECT_EQ(rigwire::test::allocations(), before);
    EXPECT_FALSE(machine.non_finite());
  }
}

std::string refusal(const RollerParameters& p) {
  try {
    validate(p);
  } catch (const std::invalid_argument& refused) {
    return refused.what();
  }
  return "";
}

TEST(RollerSchemes, AnExplicitStepBeyondStabilityIsRefusedWithItsReason) {
  RollerParameters p = with(RollerParameters{}, IntegrationScheme::runge_kutta4, 0.01);
  const std::string reason = refusal(p);
  for (const char* part : {"step: found 10 ms", "allowed at most", "rad/s", "runge_kutta4"}) {
    EXPECT_NE(reason.find(part), std::string::npos) << reason;
  }
  p.step_s = 0.99 * kRollerExplicitLimit / fastest_rate_radps(p);
  EXPECT_EQ(refusal(p), "");
  p.scheme = IntegrationScheme::rosenbrock2;
  p.step_s = 0.02;
  EXPECT_EQ(refusal(p), "");
}

// Brakes that outweigh everything else: rolling resistance adds a tenth to their stiffness.
TEST(RollerSchemes, TheFastestRateOfStiffBrakesIsThatOfADrumOnThem) {
  RollerParameters p = bare();
  p.brake_stiffness_nmprad = 1e12;
  const double wanted = std::sqrt(1.1 * p.brake_stiffness_nmprad / p.drum.spin_inertia_kgm2);
  EXPECT_NEAR(fastest_rate_radps(p), wanted, 0.02 * wanted);
}

TEST(RollerSchemes, TheKinematicLevelKnowsOne) {
  RollerParameters p;
  p.level = RollerLevel::kinematic;
  EXPECT_EQ(refusal(p), "");
  p.scheme = IntegrationScheme::rosenbrock2;
  EXPECT_NE(refusal(p).find("kinematic"), std::string::npos);
  EXPECT_EQ(refusal(p).find("scheme: found another"), 0u);
}

}  // namespace
}  // namespace rigwire::sim
