// Off the ground and back: dynamics cases 11, 12, 18, 19, 22, 23; balance of momentum and energy.
#include <gtest/gtest.h>

#include "vehicle_rig.h"

namespace rigwire::sim::test {
namespace {

using namespace std::chrono_literals;

/// A body whose axles weigh next to nothing, far above the ground.
WheeledVehicleParameters bare_body(const Eigen::Vector3d& inertia) {
  WheeledVehicleParameters p;
  p.gravity_mps2 = 0.0;
  p.air_drag_ns2pm2 = 0.0;
  p.body.principal_inertia_kgm2 = inertia;
  for (VehicleAxleParameters* axle : {&p.front, &p.rear}) {
    axle->beam.mass_kg = 1e-6;
    axle->beam.roll_inertia_kgm2 = 1e-6;
    axle->beam.pitch_inertia_kgm2 = 1e-6;
    axle->wheel_spin_inertia_kgm2 = 1e-6;
    axle->parking_brake_nm = 0.0;
  }
  return p;
}

FullVehicleState high(const BareVehicle& rig) {
  FullVehicleState state = rig.machine.state();
  state.p_WC.z() += 1000.0;
  return state;
}

TEST(VehicleAirborne, FreeFallHasTheStepsFirstOrderError) {
  WheeledVehicleParameters parameters;
  parameters.air_drag_ns2pm2 = 0.0;
  BareVehicle rig(slope(0.0), parameters);
  FullVehicleState state = high(rig);
  // Springs at the length that they have without load.
  for (std::size_t i = 0; i < 2; ++i) {
    const StaticLoads loads = static_loads(parameters);
    const VehicleAxleParameters& axle = i == 0 ? parameters.front : parameters.rear;
    state.suspension[2 * i] = -loads.spring_n[i] / (2.0 * axle.beam.spring_npm);
  }
  rig.machine.set_state(state);
  const double from = rig.machine.state().p_WC.z();
  for (int i = 0; i < 100; ++i) {
    rig.machine.step(100ms);
    EXPECT_NEAR(rig.machine.links()[0].a_WL_W.z(), -kGravity, 1e-9);
    for (const WheelState& wheel : rig.machine.wheels()) {
      EXPECT_EQ(wheel.load_n, 0.0);
    }
  }
  const double exact = -0.5 * kGravity * 100.0;
  EXPECT_NEAR(rig.machine.state().p_WC.z() - from, exact - 0.5 * kGravity * 1e-3 * 10.0, 1e-6);
}

TEST(VehicleAirborne, MomentumIsKeptWhileEverythingMoves) {
  WheeledVehicleParameters parameters;
  parameters.air_drag_ns2pm2 = 0.0;
  parameters.gravity_mps2 = 0.0;
  const auto drift = [&](double step_s) {
    parameters.step_s = step_s;
    BareVehicle rig(slope(0.0), parameters);
    FullVehicleState state = high(rig);
    state.w_WB_B = {0.4, 0.3, -0.5};
    state.suspension_rate = {0.4, 0.5, -0.3, 0.6};
    state.wheel_rate_radps = {20.0, 10.0, -5.0, 30.0};
    rig.machine.set_state(state);
    // About the common centre of mass, where the linear part drops out.
    const VehicleMomentum before = rig.machine.momentum();
    rig.machine.step(1s);
    const VehicleMomentum after = rig.machine.momentum();
    return std::pair((after.linear_W - before.linear_W).norm() / 9000.0,
                     (after.angular_W - before.angular_W).norm() / before.angular_W.norm());
  };
  const auto coarse = drift(1e-3);
  const auto fine = drift(1e-4);
  EXPECT_LT(coarse.first, 2e-3);
  EXPECT_LT(coarse.second, 0.3);
  // First order: a tenth of the step leaves a tenth of the error.
  EXPECT_LT(fine.first, 0.2 * coarse.first);
  EXPECT_LT(fine.second, 0.2 * coarse.second);
}

TEST(VehicleAirborne, FullPitchLoopIsTheExactRotation) {
  BareVehicle rig(slope(0.0), bare_body({5.5e3, 2.3e4, 2.4e4}));
  FullVehicleState state = high(rig);
  state.w_WB_B = {0.0, 2.0 * std::numbers::pi, 0.0};
  rig.machine.set_state(state);
  const Eigen::Quaterniond start = rig.machine.state().q_WB;
  for (int i = 1; i <= 100; ++i) {
    rig.machine.step(10ms);
    const Eigen::Quaterniond exact =
        start * Eigen::Quaterniond(Eigen::AngleAxisd(2.0 * std::numbers::pi * i / 100.0,
                                                     Eigen::Vector3d::UnitY()));
    // The axles' rest of mass swings in the springs; it carries 1e-10 of the inertia.
    EXPECT_LT(rig.machine.state().q_WB.angularDistance(exact), 2e-7) << i;
    EXPECT_NEAR(rig.machine.state().q_WB.norm(), 1.0, 1e-12);
  }
}

TEST(VehicleAirborne, DzhanibekovFlipsInTime) {
  BareVehicle rig(slope(0.0), bare_body({1e4, 2e4, 3e4}));
  FullVehicleState state = high(rig);
  state.w_WB_B = {0.01, 10.0, 0.0};
  rig.machine.set_state(state);
  std::vector<double> flips;
  double last = state.w_WB_B.y();
  for (int i = 0; i < 15000; ++i) {
    rig.machine.step(1ms);
    const double now = rig.machine.state().w_WB_B.y();
    if ((now < 0.0) != (last < 0.0)) {
      flips.push_back(1e-3 * (i + 1.0 - now / (now - last)));
    }
    last = now;
  }
  ASSERT_EQ(flips.size(), 5U);
  // First after half an interval, then one each (I 1 : 2 : 3, exact 2.873142 s).
  for (std::size_t i = 1; i < flips.size(); ++i) {
    EXPECT_NEAR(flips[i] - flips[i - 1], 2.873142, 2e-3);
  }
}

TEST(VehicleAirborne, DroppedFromHalfAMetreItLandsAndDoesNotRiseAgainAsHigh) {
  BareVehicle rig(slope(0.0));
  FullVehicleState state = rig.machine.state();
  state.p_WC.z() += 0.5;
  rig.machine.set_state(state);
  rig.machine.command(released());
  double lowest = 1.0;
  double highest_later = -1.0;
  bool landed = false;
  for (int i = 0; i < 3000; ++i) {
    rig.machine.step(1ms);
    for (std::size_t k = 0; k < kWheels; ++k) {
      EXPECT_GE(rig.machine.wheels()[k].load_n, 0.0);
      lowest = std::min(lowest, rig.machine.links()[3 + k].X_WL.translation().z());
    }
    landed = landed || rig.total_load() > 0.0;
    if (landed && rig.speed() < 1.0 && i > 500) {
      highest_later = std::max(highest_later, rig.position().z());
    }
  }
  EXPECT_GT(lowest, 0.254);  // Never on the rim, far from the ground.
  EXPECT_LT(highest_later, 0.3);
  rig.machine.step(10s);
  // Tyres that stand hold by friction what the landing has bent them by.
  EXPECT_NEAR(rig.position().z(), 0.0, 2e-4);
  EXPECT_LT(rig.speed(), 1e-9);
}

TEST(VehicleAirborne, DropLosesEnergyOnly) {
  BareVehicle rig(slope(0.0));
  FullVehicleState state = rig.machine.state();
  state.p_WC.z() += 0.5;
  rig.machine.set_state(state);
  const auto tyres = [&] {
    double sum = 0.0;
    for (std::size_t i = 0; i < kWheels; ++i) {
      const TyreParameters& tyre = rig.machine.parameters().front.tyre;
      const double depth =
          std::max(0.0, tyre.unloaded_radius_m - rig.machine.links()[3 + i].X_WL.translation().z());
      sum += 0.5 * (tyre.carcass_stiffness_npm + tyre.stiffness_per_pressure_m * 4.5e5) * depth *
             depth;
    }
    return sum;
  };
  const auto energy = [&] {
    const VehicleMomentum m = rig.machine.momentum();
    return m.kinetic_j + m.potential_j + m.spring_j + tyres();
  };
  double last = energy();
  for (int i = 0; i < 200; ++i) {
    rig.machine.step(10ms);
    const double now = energy();
    EXPECT_LT(now, last + 150.0) << i;  // 0.3 % of 44 kJ: first-order error of the step.
    last = now;
  }
}

TEST(VehicleAirborne, AMillionMetresAwayTheSameHappens) {
  const auto path = [](double offset) {
    BareVehicle rig(slope(0.0), {}, {offset, -offset, 0.0});
    FullVehicleState state = rig.machine.state();
    state.p_WC.z() += 0.3;
    state.v_WC_W = {3.0, 0.2, 0.0};
    rig.machine.set_state(state);
    rig.machine.command(released());
    rig.machine.step(500ms);
    return Eigen::Vector3d(rig.position() - Eigen::Vector3d(offset, -offset, 0.0));
  };
  EXPECT_LT((path(0.0) - path(1e6)).norm(), 1e-7);
}

}  // namespace
}  // namespace rigwire::sim::test
