// Order, agreement and limits of the schemes of the full level.
#include <gtest/gtest.h>

#include <ostream>
#include <stdexcept>
#include <string>

#include "allocation_counter.h"
#include "sim/driveline/make_driveline.h"
#include "vehicle_rig.h"

namespace rigwire::sim {

/// For test names.
inline void PrintTo(IntegrationScheme scheme, std::ostream* out) {
  *out << (scheme == IntegrationScheme::linearly_implicit_euler ? "linearly_implicit_euler"
           : scheme == IntegrationScheme::rosenbrock2           ? "rosenbrock2"
                                                                : "runge_kutta4");
}

}  // namespace rigwire::sim

namespace rigwire::sim::test {
namespace {

using namespace std::chrono_literals;
using enum IntegrationScheme;

WheeledVehicleParameters stepped(IntegrationScheme scheme, double step_s,
                                 WheeledVehicleParameters parameters = {}) {
  parameters.scheme = scheme;
  parameters.step_s = step_s;
  return parameters;
}

/// Half a second at 10 m/s under torque, heaving, rolling and drifting a little: all forces within
/// their limits and smooth.
Eigen::Vector3d manoeuvre(IntegrationScheme scheme, Duration step,
                          const WheeledVehicleParameters& parameters = {}) {
  BareVehicle rig(slope(2.0 * kDegree), stepped(scheme, to_seconds(step), parameters));
  rig.machine.command(released());
  rig.machine.start_rolling(10.0);
  FullVehicleState state = rig.machine.state();
  state.v_WC_W += Eigen::Vector3d(0.0, 0.3, 0.1);
  state.w_WB_B += Eigen::Vector3d(0.05, 0.02, 0.1);
  rig.machine.set_state(state);
  rig.equations.torque_nm = WheelVector::Constant(0.1 * parameters.mass_kg());
  rig.machine.step(500ms);
  EXPECT_FALSE(rig.machine.non_finite());
  for (const WheelState& wheel : rig.machine.wheels()) {
    EXPECT_FALSE(wheel.slipping);
  }
  return rig.position();
}

struct OrderCase {
  IntegrationScheme scheme;
  Duration coarse;
  double least;
  double most;
};

void PrintTo(const OrderCase& c, std::ostream* out) {
  PrintTo(c.scheme, out);
}

class VehicleSchemeOrder : public testing::TestWithParam<OrderCase> {};

TEST_P(VehicleSchemeOrder, ErrorFallsWithTheStepByThatPower) {
  const OrderCase& c = GetParam();
  for (const WheeledVehicleParameters& parameters : {WheeledVehicleParameters(), gator_855d()}) {
    const Eigen::Vector3d exact = manoeuvre(runge_kutta4, 50us, parameters);
    const double coarse = (manoeuvre(c.scheme, c.coarse, parameters) - exact).norm();
    const double fine = (manoeuvre(c.scheme, c.coarse / 2, parameters) - exact).norm();
    const double order = std::log2(coarse / fine);
    EXPECT_GE(order, c.least);
    EXPECT_LE(order, c.most);
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, VehicleSchemeOrder,
                         testing::Values(OrderCase{linearly_implicit_euler, 500us, 0.9, 1.1},
                                         OrderCase{rosenbrock2, 500us, 1.8, 2.3},
                                         OrderCase{runge_kutta4, 1ms, 3.5, 5.0}),
                         testing::PrintToStringParamName());

TEST(VehicleSchemes, AgreeAtFineSteps) {
  const Eigen::Vector3d fourth = manoeuvre(runge_kutta4, 100us);
  EXPECT_LT((manoeuvre(rosenbrock2, 50us) - fourth).norm(), 1e-6);
  // Of first order: extrapolated over two steps.
  const Eigen::Vector3d coarse = manoeuvre(linearly_implicit_euler, 20us);
  const Eigen::Vector3d fine = manoeuvre(linearly_implicit_euler, 10us);
  EXPECT_LT((2.0 * fine - coarse - fourth).norm(), 1e-6);
}

class VehicleScheme : public testing::TestWithParam<IntegrationScheme> {};

TEST_P(VehicleScheme, StandsOnASlopeAndComesToRestThere) {
  BareVehicle rig(slope(15.0 * kDegree), stepped(GetParam(), 1e-3));
  rig.machine.command(braked());
  rig.machine.start_rolling(3.0);
  rig.machine.step(12s);  // Rocks on its bristles until then.
  const Eigen::Vector3d at = rig.position();
  EXPECT_LT(std::abs(rig.speed()), 1e-6);
  rig.machine.step(10s);
  EXPECT_LT((rig.position() - at).norm(), 1e-6);
  EXPECT_NEAR(rig.total_load(),
              rig.machine.parameters().mass_kg() * kGravity * std::cos(15.0 * kDegree), 1.0);
}

TEST_P(VehicleScheme, BrakesWithLockedWheelsAlikeAtShortSteps) {
  const auto stop = [](IntegrationScheme scheme) {
    BareVehicle rig(slope(0.0, 0.4), stepped(scheme, 1e-3));
    rig.machine.command(braked());
    rig.machine.start_rolling(8.0);
    rig.machine.step(4s);
    EXPECT_LT(std::abs(rig.speed()), 5e-3);
    return rig.position().x();
  };
  const double reference = stop(linearly_implicit_euler);
  EXPECT_NEAR(reference, 8.0 * 8.0 / (2.0 * 0.4 * kGravity), 0.5);
  EXPECT_NEAR(stop(GetParam()), reference, 0.03);
}

TEST_P(VehicleScheme, LandsFromADropWithoutGainingEnergy) {
  BareVehicle rig(slope(0.0), stepped(GetParam(), 1e-3));
  rig.machine.command(released());
  FullVehicleState state = rig.machine.state();
  const double rest = state.p_WC.z();
  state.p_WC.z() += 0.5;
  rig.machine.set_state(state);
  double highest = 0.0;
  for (int i = 0; i < 3000; ++i) {
    rig.machine.step(1ms);
    if (i > 500) {
      highest = std::max(highest, rig.machine.state().p_WC.z() - rest);
    }
  }
  ASSERT_FALSE(rig.machine.non_finite());
  EXPECT_LT(highest, 0.5);
  EXPECT_NEAR(rig.machine.state().p_WC.z(), rest, 1e-3);
}

TEST_P(VehicleScheme, DrivesThroughShiftsAndLocksWithoutAllocation) {
  const Ground ground = slope(3.0 * kDegree);
  const auto machine = make_wheeled_vehicle(stepped(GetParam(), 1e-3), ground,
                                            make_driveline(unimog_u5023_driveline()), {});
  VehicleCommand command = released();
  command.gear = 2;
  command.engine_torque_share = 0.7;
  command.front_steer_rad = 0.2;
  command.lock = {true, true, true};
  machine->command(command);
  machine->step(100ms);
  const std::uint64_t before = rigwire::test::allocations();
  machine->step(2s);
  command.gear = 3;
  machine->command(command);
  machine->step(2s);
  EXPECT_EQ(rigwire::test::allocations(), before);
  ASSERT_FALSE(machine->non_finite());
  EXPECT_GT(machine->links()[0].v_WL_W.norm(), 1.0);
  EXPECT_NEAR(machine->wheels()[2].rate_radps, machine->wheels()[3].rate_radps, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Schemes, VehicleScheme,
                         testing::Values(linearly_implicit_euler, rosenbrock2, runge_kutta4),
                         testing::PrintToStringParamName());

TEST(VehicleSchemes, StiffSuspensionIsForTheImplicitOnes) {
  const WheeledVehicleParameters stiff = nearly_rigid({});
  BareVehicle rig(slope(0.0), stepped(rosenbrock2, 5e-3, stiff));
  rig.machine.command(released());
  rig.machine.start_rolling(5.0);
  rig.machine.step(3s);
  ASSERT_FALSE(rig.machine.non_finite());
  EXPECT_NEAR(rig.total_load(), stiff.mass_kg() * kGravity, 100.0);
  EXPECT_THROW(validate(stepped(runge_kutta4, 5e-3, stiff)), std::invalid_argument);
}

TEST(VehicleSchemes, AreRefusedWhereTheyDoNotHold) {
  const auto refusal = [](const WheeledVehicleParameters& parameters) {
    try {
      validate(parameters);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  WheeledVehicleParameters p = stepped(runge_kutta4, 1e-3);
  EXPECT_EQ(refusal(p), "");
  const double most = kRungeKutta4StepLimit / fastest_mode_radps(p);
  p.step_s = 1.01 * most;
  EXPECT_NE(refusal(p).find("step: found "), std::string::npos);
  EXPECT_NE(refusal(p).find("Hz"), std::string::npos);
  p.step_s = 0.99 * most;
  EXPECT_EQ(refusal(p), "");
  p.scheme = rosenbrock2;
  p.step_s = 0.02;
  EXPECT_EQ(refusal(p), "");
  for (const VehicleLevel level : {VehicleLevel::kinematic, VehicleLevel::planar}) {
    p.level = level;
    EXPECT_EQ(refusal(p).find("scheme"), 0u);
  }
}

}  // namespace
}  // namespace rigwire::sim::test
