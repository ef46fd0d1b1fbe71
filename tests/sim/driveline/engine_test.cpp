#include "sim/driveline/engine.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigwire::sim {
namespace {

EngineParameters without_lag() {
  EngineParameters parameters;
  parameters.torque_lag_s = 0.0;
  return parameters;
}

EngineDemand accelerator(double share) {
  return {EngineControl::torque, share, 0.0, 1.0};
}

TEST(EngineMap, IsLinearBetweenPointsAndConstantOutside) {
  EngineParameters p;
  p.full_load = {{100.0, 400.0}, {200.0, 600.0}, {240.0, 500.0}};
  const Engine engine(p);
  EXPECT_DOUBLE_EQ(engine.full_load_nm(0.0), 400.0);
  EXPECT_DOUBLE_EQ(engine.full_load_nm(100.0), 400.0);
  EXPECT_DOUBLE_EQ(engine.full_load_nm(125.0), 450.0);
  EXPECT_DOUBLE_EQ(engine.full_load_nm(200.0), 600.0);
  EXPECT_DOUBLE_EQ(engine.full_load_nm(210.0), 575.0);
  EXPECT_DOUBLE_EQ(engine.full_load_nm(999.0), 500.0);
}

TEST(EngineMap, UnimogHasItsRatedTorqueAndPower) {
  const Engine engine{EngineParameters{}};
  EXPECT_DOUBLE_EQ(engine.reference_torque_nm(), 900.0);
  EXPECT_DOUBLE_EQ(engine.full_load_nm(rpm(1600)), 900.0);
  EXPECT_NEAR(engine.full_load_nm(rpm(2200)) * rpm(2200), 170e3, 20.0);
}

TEST(EngineMap, GatorHasItsRatedPower) {
  const Engine engine{CvtParameters{}.engine};
  EXPECT_NEAR(engine.full_load_nm(rpm(3200)) * rpm(3200), 17e3, 20.0);
}

TEST(EngineTorqueTest, SlopeIsTheDerivativeAndNeverNegativeDamping) {
  Engine engine(without_lag());
  for (const double share : {0.0, 0.3, 1.0}) {
    engine.advance(0.001, 100.0, accelerator(share));
    for (double speed = 20.0; speed < 270.0; speed += 0.9) {
      const EngineTorque here = engine.torque(speed);
      const double slope =
          (engine.torque(speed + 1e-6).torque_nm - engine.torque(speed - 1e-6).torque_nm) / 2e-6;
      ASSERT_GE(here.damping_nmsprad, 0.0);
      ASSERT_NEAR(here.damping_nmsprad, std::max(0.0, -slope), 1e-3) << share << " at " << speed;
      ASSERT_GE(here.torque_nm, here.least_nm);
      ASSERT_LE(here.torque_nm, here.greatest_nm);
    }
  }
}

TEST(EngineTorqueTest, FuelEndsAtCutOffAndFrictionRemains) {
  Engine engine(without_lag());
  engine.advance(0.001, 200.0, accelerator(1.0));
  const EngineParameters& p = engine.parameters();
  EXPECT_NEAR(engine.torque(p.maximum_radps).torque_nm, 737.9, 1e-9);
  EXPECT_DOUBLE_EQ(engine.torque(p.cut_off_radps).torque_nm, -engine.friction_nm(p.cut_off_radps));
  EXPECT_DOUBLE_EQ(engine.torque(400.0).torque_nm, -engine.friction_nm(400.0));
}

TEST(EngineTorqueTest, IdleGovernorIsAtRestAtIdle) {
  Engine engine(without_lag());
  engine.advance(0.001, 73.0, accelerator(0.0));
  const double idle = engine.parameters().idle_radps;
  EXPECT_NEAR(engine.torque(idle).torque_nm, 0.0, 1e-9);
  EXPECT_GT(engine.torque(idle - 1.0).torque_nm, 100.0);
  EXPECT_LT(engine.torque(idle + 1.0).torque_nm, 0.0);
}

TEST(EngineTorqueTest, AcceleratorLagIsExactWhateverTheStep) {
  EngineParameters p;
  p.torque_lag_s = 0.2;
  Engine coarse(p);
  Engine fine(p);
  coarse.advance(0.1, 150.0, accelerator(1.0));
  for (int i = 0; i < 100; ++i) {
    fine.advance(0.001, 150.0, accelerator(1.0));
  }
  EXPECT_NEAR(coarse.torque(150.0).torque_nm, fine.torque(150.0).torque_nm, 1e-9);
  const double friction = coarse.friction_nm(150.0);
  const double share = 1.0 - std::exp(-0.5);
  EXPECT_NEAR(coarse.torque(150.0).torque_nm,
              -friction + share * (coarse.full_load_nm(150.0) + friction), 1e-9);
}

TEST(EngineGovernor, HoldsItsSpeedUnderLoadWithoutError) {
  Engine engine(without_lag());
  const double h = 0.005;
  const double wanted = 150.0;
  double speed = 100.0;
  for (const double load : {0.0, 600.0, 200.0}) {
    for (int i = 0; i < 3000; ++i) {
      engine.advance(h, speed, {EngineControl::speed, 0.0, wanted, 1.0});
      const EngineTorque torque = engine.torque(speed);
      speed += (torque.torque_nm - load) /
               (engine.parameters().inertia_kgm2 / h + torque.damping_nmsprad);
    }
    EXPECT_NEAR(speed, wanted, 1e-3) << load;
  }
}

TEST(EngineGovernor, DoesNotWindUpAtFullLoad) {
  Engine engine(without_lag());
  const double h = 0.005;
  // A minute in which the load is more than the engine has, at half the speed asked for.
  for (int i = 0; i < 12000; ++i) {
    engine.advance(h, 75.0, {EngineControl::speed, 0.0, 150.0, 1.0});
  }
  // Let go: proportional part and what the integral had before the limit.
  EXPECT_LE(engine.torque(155.0).torque_nm, 0.0);
}

}  // namespace
}  // namespace rigwire::sim
