// Steering by the guidance command: angles, limits, and the handshake after a fault.
#include <gtest/gtest.h>

#include <cmath>

#include "emulators/vehicle_gateway/control.h"
#include "requests.h"
#include "rig.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
namespace vehicle = protocols::vehicle;
using vehicle::ExitReason;
using vehicle::LimitStatus;
using vehicle::Switch;

TEST(VehicleGuidance, FrontSteeringFollowsTheCurvature) {
  VehicleRig rig;
  rig.run(50ms);
  rig.ask(curvature(0.05));
  EXPECT_NEAR(std::tan(rig.command().front_steer_rad) / 3.25, 0.05, 0.13e-3);
  EXPECT_EQ(rig.command().rear_steer_rad, 0.0);
  rig.ask(curvature(-0.05));
  EXPECT_LT(rig.command().front_steer_rad, 0.0);
}

TEST(VehicleGuidance, CounterSteeringIsSymmetric) {
  VehicleRig rig(roller());
  rig.run(50ms);
  rig.ask(curvature(0.1));
  EXPECT_EQ(rig.command().front_steer_rad, -rig.command().rear_steer_rad);
  // R = L / (2 tan delta)
  EXPECT_NEAR(2.0 * std::tan(rig.command().front_steer_rad) / 3.6, 0.1, 0.13e-3);
}

TEST(VehicleGuidance, CrabMovesAsideWithoutTurning) {
  VehicleRig rig(roller());
  rig.run(50ms);
  rig.ask(crab(8.0 * kDegree));
  rig.ask(curvature(0.0));
  EXPECT_NEAR(rig.command().front_steer_rad, 8.0 * kDegree, kDegree / 256.0);
  EXPECT_NEAR(rig.command().rear_steer_rad, rig.command().front_steer_rad, 1e-12);
}

TEST(VehicleGuidance, CrabOnACircleKeepsCurvatureAndSlipAngle) {
  VehicleRig rig(roller());
  rig.run(50ms);
  rig.ask(crab(8.0 * kDegree));
  rig.ask(curvature(0.1));
  const double front = std::tan(rig.command().front_steer_rad);
  const double rear = std::tan(rig.command().rear_steer_rad);
  // Double bicycle with its reference half-way between the axles.
  const double slip = std::atan(0.5 * (front + rear));
  EXPECT_NEAR(slip, 8.0 * kDegree, kDegree / 256.0);
  EXPECT_NEAR((front - rear) * std::cos(slip) / 3.6, 0.1, 0.13e-3);
}

TEST(VehicleGuidance, AngleLimitIsToldWithItsSide) {
  VehicleRig rig;
  rig.run(50ms);
  rig.ask(curvature(2.0));
  EXPECT_EQ(rig.command().front_steer_rad, VehicleGatewaySettings{}.maximum_front_steer_rad);
  EXPECT_EQ(rig.gateway.control().guidance_limit(), LimitStatus::limited_low);
  rig.ask(curvature(-2.0));
  EXPECT_EQ(rig.gateway.control().guidance_limit(), LimitStatus::limited_high);
  rig.ask(curvature(0.0));
  EXPECT_EQ(rig.gateway.control().guidance_limit(), LimitStatus::not_limited);
}

TEST(VehicleGuidance, SilenceHoldsTheSteeringAndStopsTheMachine) {
  VehicleRig rig(roller());
  rig.run(300ms);
  rig.ask(curvature(0.1));
  rig.ask(travel(1.0));
  const double held = rig.command().front_steer_rad;
  rig.run(149ms);
  EXPECT_FALSE(rig.gateway.control().stopping());
  rig.run(2ms);
  EXPECT_TRUE(rig.gateway.control().stopping());
  EXPECT_EQ(rig.command().front_steer_rad, held);
  EXPECT_EQ(rig.command().travel_speed_mps, 0.0);
  EXPECT_GT(rig.command().brake_share, 0.0);
  rig.run(100ms);
  const auto info = rig.output.latest<vehicle::GuidanceMachineInfo>();
  EXPECT_EQ(info.reset_required, Switch::on);
  EXPECT_EQ(info.ready, Switch::off);
  EXPECT_EQ(info.exit_reason, static_cast<std::uint8_t>(ExitReason::command_timeout));
}

TEST(VehicleGuidance, WantsOneNotIntendedAfterAFault) {
  VehicleRig rig(roller());
  rig.run(300ms);
  rig.ask(curvature(0.1));
  rig.run(200ms);
  const double held = rig.command().front_steer_rad;
  rig.ask(curvature(-0.1));
  EXPECT_EQ(rig.command().front_steer_rad, held);
  EXPECT_TRUE(rig.gateway.control().guidance_needs_reset());
  rig.ask(not_intended());
  EXPECT_FALSE(rig.gateway.control().guidance_needs_reset());
  rig.ask(curvature(-0.1));
  EXPECT_LT(rig.command().front_steer_rad, 0.0);
  EXPECT_FALSE(rig.gateway.control().stopping());
}

TEST(VehicleGuidance, EndedProperlyIsNoFault) {
  VehicleRig rig;
  rig.run(50ms);
  rig.ask(curvature(0.05));
  rig.ask(not_intended());
  rig.run(1s);
  EXPECT_EQ(rig.gateway.control().troubles().active().count, 0U);
  EXPECT_FALSE(rig.gateway.control().stopping());
  EXPECT_GT(rig.command().front_steer_rad, 0.1);  // steering stays
}

TEST(VehicleGuidance, CurvatureThatIsNoneIsAFault) {
  VehicleRig rig;
  rig.run(50ms);
  rig.ask(curvature(vehicle::kError));
  EXPECT_EQ(rig.command(), VehicleCommand{});  // it did not steer yet
  rig.ask(curvature(0.05));
  rig.ask(curvature(vehicle::kError));
  EXPECT_TRUE(rig.gateway.control().guidance_needs_reset());
  EXPECT_TRUE(rig.gateway.control().stopping());
  EXPECT_EQ(rig.gateway.control().guidance_exit(), ExitReason::out_of_range);
  rig.ask(not_intended());
  rig.ask(curvature(0.05));
  rig.ask(vehicle::GuidanceCommand{0.0, Switch::error});
  EXPECT_EQ(rig.gateway.control().guidance_exit(), ExitReason::other_error);
}

TEST(VehicleGuidance, StatusNotAvailableDoesNotKeepItAlive) {
  VehicleRig rig;
  rig.run(50ms);
  rig.ask(curvature(0.05));
  for (int i = 0; i < 20; ++i) {
    rig.run(10ms);
    rig.ask(vehicle::GuidanceCommand{0.05, Switch::not_available});
  }
  EXPECT_TRUE(rig.gateway.control().guidance_needs_reset());
}

}  // namespace
}  // namespace rigwire::emulators
