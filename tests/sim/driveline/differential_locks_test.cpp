#include "sim/driveline/differential_locks.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

namespace rigwire::sim {
namespace {

AxleParameters eager() {
  AxleParameters p;
  p.lock_time_s = 0.0;
  p.lock_rate_difference_radps = 1e9;
  return p;
}

TEST(DifferentialLocks, MergeSpeedIsTheMomentumOfBothWheelsOverTheirInertia) {
  DifferentialLocks locks(eager());
  const WheelVector inertia(30.0, 45.0, 20.0, 60.0);
  WheelVector rates(10.0, 4.0, -3.0, 7.0);
  locks.request({false, false, true});
  EXPECT_TRUE(locks.advance(0.001, inertia.asDiagonal(), rates));
  EXPECT_DOUBLE_EQ(rates(0), 10.0);
  EXPECT_DOUBLE_EQ(rates(1), 4.0);
  EXPECT_NEAR(rates(2), (20.0 * -3.0 + 60.0 * 7.0) / 80.0, 1e-12);
  EXPECT_EQ(rates(2), rates(3));
}

TEST(DifferentialLocks, EveryCombinationRemovesOneCoordinateEach) {
  for (unsigned mask = 0; mask < 8; ++mask) {
    DifferentialLocks locks(eager());
    const std::array<bool, 3> wanted{(mask & 1) != 0, (mask & 2) != 0, (mask & 4) != 0};
    locks.request(wanted);
    WheelVector rates(10.0, 4.0, -3.0, 7.0);
    const double momentum = rates.sum();
    locks.advance(0.001, WheelMatrix::Identity() * 33.0, rates);
    EXPECT_EQ(locks.engaged(), wanted);
    const int count = wanted[0] + wanted[1] + wanted[2];
    EXPECT_EQ(locks.coordinates(), 4 - count);
    const auto basis = locks.basis().leftCols(locks.coordinates());
    EXPECT_TRUE((basis.transpose() * basis).isIdentity(1e-15));
    EXPECT_NEAR((basis * (basis.transpose() * rates) - rates).norm(), 0.0, 1e-14);
    EXPECT_NEAR(rates.sum(), momentum, 1e-13);
    if (wanted[0]) {
      EXPECT_NEAR(rates(0), rates(1), 1e-14);
    }
    if (wanted[1]) {
      EXPECT_NEAR(rates(0) + rates(1), rates(2) + rates(3), 1e-14);
    }
    if (wanted[2]) {
      EXPECT_NEAR(rates(2), rates(3), 1e-14);
    }
    if (count == 3) {
      EXPECT_TRUE(rates.isConstant(4.5, 1e-14));
    }
  }
}

TEST(DifferentialLocks, MergeKeepsTheOtherMomentaAlsoWithAnEngineOnOneAxle) {
  DifferentialLocks locks(eager());
  const WheelVector shares(0.0, 0.0, 0.5, 0.5);
  const WheelMatrix inertia = WheelMatrix::Identity() * 12.0 + 500.0 * shares * shares.transpose();
  WheelVector rates(2.0, 4.0, 9.0, 11.0);
  const WheelVector before = inertia * rates;
  locks.request({false, true, false});
  locks.advance(0.001, inertia, rates);
  const WheelVector impulse = inertia * rates - before;
  // One torque between the axles: equal and opposite, equal on both wheels of an axle.
  EXPECT_NEAR(impulse(0), impulse(1), 1e-12);
  EXPECT_NEAR(impulse(2), impulse(3), 1e-12);
  EXPECT_NEAR(impulse.sum(), 0.0, 1e-12);
  EXPECT_NEAR(rates(0) + rates(1), rates(2) + rates(3), 1e-12);
  EXPECT_GT(rates(2) + rates(3), 16.0);  // the engine's side hardly slows
}

TEST(DifferentialLocks, WaitsForItsTimeAndForNearlyEqualSpeeds) {
  AxleParameters p;
  p.lock_time_s = 0.3;
  p.lock_rate_difference_radps = 2.0;
  DifferentialLocks locks(p);
  locks.request({true, false, false});
  WheelVector rates(5.0, 2.9, 0.0, 0.0);
  for (int i = 0; i < 1000; ++i) {
    locks.advance(0.001, WheelMatrix::Identity(), rates);
  }
  EXPECT_FALSE(locks.engaged()[0]);
  EXPECT_DOUBLE_EQ(rates(0), 5.0);
  rates(1) = 3.1;
  locks.advance(0.001, WheelMatrix::Identity(), rates);
  EXPECT_TRUE(locks.engaged()[0]);

  DifferentialLocks early(p);
  early.request({true, false, false});
  for (int i = 0; i < 299; ++i) {
    early.advance(0.001, WheelMatrix::Identity(), rates);
  }
  EXPECT_FALSE(early.engaged()[0]);
  early.advance(0.001, WheelMatrix::Identity(), rates);
  EXPECT_TRUE(early.engaged()[0]);
}

TEST(DifferentialLocks, OneThatIsNotFittedStaysOpen) {
  AxleParameters p = eager();
  p.lockable = {false, true, false};
  DifferentialLocks locks(p);
  locks.request({true, false, true});
  WheelVector rates(1.0, 2.0, 3.0, 4.0);
  EXPECT_FALSE(locks.advance(1.0, WheelMatrix::Identity(), rates));
  EXPECT_EQ(locks.coordinates(), 4);
  EXPECT_TRUE(locks.basis().isIdentity(0.0));
}

TEST(DifferentialLocks, OpeningGivesTheIdentityBack) {
  DifferentialLocks locks(eager());
  locks.request({true, true, true});
  WheelVector rates(1.0, 2.0, 3.0, 4.0);
  locks.advance(0.001, WheelMatrix::Identity(), rates);
  EXPECT_EQ(locks.coordinates(), 1);
  locks.request({});
  EXPECT_FALSE(locks.advance(0.001, WheelMatrix::Identity(), rates));
  EXPECT_EQ(locks.coordinates(), 4);
  EXPECT_TRUE(locks.basis().isIdentity(0.0));
}

}  // namespace
}  // namespace rigwire::sim
