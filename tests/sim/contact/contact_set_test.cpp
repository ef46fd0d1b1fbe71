// The law of contact on one free body: drops, slides, rolls, rests, impacts, trunks that give way.
#include "sim/contact/contact_set.h"
#include "fields/constants.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "allocation_counter.h"
#include "free_body.h"
#include "sim/random.h"

namespace rigwire::sim {
namespace {

using Vector = Eigen::Vector3d;

Vector box_inertia(double mass_kg, const Vector& half) {
  const Vector squares = half.cwiseProduct(half);
  return mass_kg / 3.0 *
         Vector(squares.y() + squares.z(), squares.x() + squares.z(), squares.x() + squares.y());
}

/// The most that the body's energy and what its contacts have stored have ever risen by, J.
double greatest_gain_j(FreeBody& body, double h, double span_s) {
  double gain = 0.0;
  double lowest_lost = body.contact().report().lost_j;
  double most_lost = lowest_lost;
  const auto steps = static_cast<int>(span_s / h);
  for (int i = 0; i < steps; ++i) {
    body.step(h);
    const double lost = body.contact().report().lost_j;
    gain = std::max(gain, most_lost - lost);
    most_lost = std::max(most_lost, lost);
  }
  return gain;
}

class StepSize : public testing::TestWithParam<double> {};

TEST_P(StepSize, ACrateDroppedOnEdgeOrCornerGainsNoEnergyAndComesToRest) {
  const double h = GetParam();
  const Ground ground = ground_with({box_obstacle({0.0, 0.0, -1.0}, {20.0, 20.0, 1.0})});
  const Vector half(0.5, 0.4, 0.3);
  for (const Vector& axis :
       {Vector(1.0, 0.0, 0.0), Vector(1.0, 0.6, 0.2), Vector(0.3, -1.0, 0.0)}) {
    FreeBody crate(ground, ConvexShape::box(half), 1000.0, box_inertia(1000.0, half), 5e6, 4e4);
    crate.X_WB.linear() = Eigen::AngleAxisd(40.0 * kDegree, axis.normalized()).matrix();
    crate.X_WB.translation().z() = 1.5;
    const double start = crate.energy_j();
    const double gain = greatest_gain_j(crate, h, 6.0);
    EXPECT_LT(gain, 2e-3 * start) << axis.transpose();
    EXPECT_LT(crate.energy_j(), start);
    EXPECT_LT(crate.v_W.norm(), 1e-3) << axis.transpose();
    EXPECT_LT(crate.contact().report().deepest_m, 1e-3);
    // It lies on a face.
    EXPECT_GT(crate.X_WB.linear().row(2).cwiseAbs().maxCoeff(), 0.9999);
  }
}

// Each of two points had the whole tyre's stiffness: a wheel across a trunk was twice as hard as on
// the road.
TEST_P(StepSize, PointsOfASoftBodyShareItsSpring) {
  const double h = GetParam();
  const Ground ground = ground_with({box_obstacle({0.0, 0.0, -1.0}, {20.0, 20.0, 1.0})});
  const Vector half(0.5, 0.4, 0.3);
  const double stiffness = 2e5;
  FreeBody bale(ground, ConvexShape::box(half), 1000.0, box_inertia(1000.0, half), stiffness, 1e4,
                0.0, 0.0, true);
  bale.X_WB.translation().z() = 0.301;
  for (int i = 0; i < static_cast<int>(5.0 / h); ++i) {
    bale.step(h);
  }
  EXPECT_EQ(bale.contact().report().deepest_m, 0.0);
  EXPECT_NEAR(bale.contact().report().pressed_m, 1000.0 * kGravity_mps2 / stiffness, 1e-4);
}

TEST_P(StepSize, ACrateAtRestDoesNotCreepOnASlope) {
  const double h = GetParam();
  Obstacle slope = box_obstacle({0.0, 0.0, 0.0}, {20.0, 20.0, 1.0}, 0.6);
  slope.X_WO.linear() = Eigen::AngleAxisd(20.0 * kDegree, Vector::UnitY()).matrix();
  const Ground ground = ground_with({slope});
  const Vector half(0.5, 0.4, 0.3);
  FreeBody crate(ground, ConvexShape::box(half), 1000.0, box_inertia(1000.0, half), 5e6, 4e4);
  crate.X_WB.linear() = slope.X_WO.linear();
  crate.X_WB.translation() = slope.X_WO * Vector(0.0, 0.0, 1.2999);
  for (int i = 0; i < static_cast<int>(2.0 / h); ++i) {
    crate.step(h);
  }
  const Vector before = crate.X_WB.translation();
  for (int i = 0; i < static_cast<int>(20.0 / h); ++i) {
    crate.step(h);
  }
  EXPECT_LT((crate.X_WB.translation() - before).norm(), 1e-6);
}

TEST_P(StepSize, ACrateSlidesDownASteepSlopeByCoulombsLaw) {
  const double h = GetParam();
  const double angle = 40.0 * kDegree;
  const double friction = 0.5;
  Obstacle slope = box_obstacle({0.0, 0.0, 0.0}, {40.0, 20.0, 1.0}, friction);
  slope.X_WO.linear() = Eigen::AngleAxisd(angle, Vector::UnitY()).matrix();
  const Ground ground = ground_with({slope});
  const Vector half(0.5, 0.4, 0.1);
  FreeBody crate(ground, ConvexShape::box(half), 1000.0, box_inertia(1000.0, half), 5e6, 4e4);
  crate.X_WB.linear() = slope.X_WO.linear();
  crate.X_WB.translation() = slope.X_WO * Vector(0.0, 0.0, 1.0999);
  for (int i = 0; i < static_cast<int>(1.0 / h); ++i) {
    crate.step(h);
  }
  const double before = crate.v_W.norm();
  for (int i = 0; i < static_cast<int>(1.0 / h); ++i) {
    crate.step(h);
  }
  EXPECT_NEAR(crate.v_W.norm() - before,
              kGravity_mps2 * (std::sin(angle) - friction * std::cos(angle)), 0.02);
}

TEST_P(StepSize, ABallRollsDownASlopeAsTheClosedFormSays) {
  const double h = GetParam();
  const double angle = 15.0 * kDegree;
  Obstacle slope = box_obstacle({0.0, 0.0, 0.0}, {40.0, 20.0, 1.0}, 0.6);
  slope.X_WO.linear() = Eigen::AngleAxisd(angle, Vector::UnitY()).matrix();
  const Ground ground = ground_with({slope});
  const double mass = 500.0;
  const double radius = 0.4;
  FreeBody ball(ground, ConvexShape::sphere(radius), mass,
                Vector::Constant(0.4 * mass * radius * radius), 5e6, 3e4);
  ball.X_WB.translation() = slope.X_WO * Vector(-10.0, 0.0, 1.0 + radius - 1e-4);
  for (int i = 0; i < static_cast<int>(2.0 / h); ++i) {
    ball.step(h);
  }
  // a = g sin / (1 + 2/5).
  EXPECT_NEAR(ball.v_W.norm(), 2.0 * kGravity_mps2 * std::sin(angle) / 1.4, 0.02);
}

TEST_P(StepSize, ATipThatComesSidewaysIntoARockIsNotThrownUp) {
  const double h = GetParam();
  const Ground ground = ground_with({rock_at({2.0, 0.0, 0.2}, 0.7)});
  for (const double mass : {500.0, 3000.0}) {
    for (const double height : {-0.2, 0.0, 0.2, 0.4, 0.6}) {
      for (const double speed : {0.5, 1.5, 3.0}) {
        const Vector half(0.1, 0.5, 0.1);
        FreeBody tip(ground, ConvexShape::box(half), mass, box_inertia(mass, half), 2e7, 1e5);
        tip.gravity_mps2 = 0.0;
        tip.X_WB.translation() << 0.9, 0.0, height;
        tip.v_W.x() = speed;
        const double start = tip.energy_j();
        const double gain = greatest_gain_j(tip, h, 1.5);
        const std::string what = std::to_string(mass) + " kg at " + std::to_string(height) +
                                 " m, " + std::to_string(speed) + " m/s";
        EXPECT_LT(gain, (h > 1e-3 ? 1e-2 : 1e-3) * start) << what;
        EXPECT_LT(tip.energy_j(), start * (1.0 + 1e-9)) << what;
        // Never faster upward than it came.
        EXPECT_LE(std::abs(tip.v_W.z()), speed) << what;
      }
    }
  }
}

// The body's front was a soft spring: 234 mm in a wall at 50 km/h, and it sprang back.
TEST_P(StepSize, ABentFrontKeepsItsDentAndWhatItTook) {
  const double h = GetParam();
  const Ground ground = ground_with({box_obstacle({15.0, 0.0, 1.0}, {1.0, 8.0, 4.0})});
  const Vector half(2.0, 1.1, 0.4);
  const double mass = 5600.0;
  const double crush = 2.5e5;
  const double hardening = 4e5;
  FreeBody truck(ground, ConvexShape::box(half), mass, box_inertia(mass, half), 4e7, 2e5, crush,
                 hardening);
  truck.gravity_mps2 = 0.0;
  truck.X_WB.translation() << 11.0, 0.0, 1.0;
  truck.v_W.x() = 13.9;
  const double start = truck.energy_j();
  EXPECT_LT(greatest_gain_j(truck, h, 0.5), 1e-6 * start);
  const ContactReport& report = truck.contact().report();
  EXPECT_LT(report.deepest_ever_m, 0.02);
  // Four points: E = 4 (A C + B C^2 / 2).
  const double dent = (std::sqrt(crush * crush + 0.5 * hardening * start) - crush) / hardening;
  EXPECT_NEAR(report.dent_m, dent, 0.06 * dent + 5.0 * h);
  // Only the springs give back, at most A^2 / 2 k each, at the force of the end.
  const double end = crush + hardening * report.dent_m;
  EXPECT_LT(truck.v_W.x(), 0.0);
  EXPECT_LT(truck.energy_j(), 4.0 * end * end / (2.0 * 4e7));
  EXPECT_NEAR(report.lost_j, start - truck.energy_j(), 1e-6 * start);
  // Whatever comes there later finds it bent.
  truck.X_WB.setIdentity();
  truck.X_WB.translation() << 12.0, 0.0, 1.0;
  truck.w_W.setZero();
  truck.v_W << 0.5, 0.0, 0.0;
  const double before = report.dent_m;
  double farthest = 0.0;
  for (int i = 0; i < static_cast<int>(2.0 / h); ++i) {
    truck.step(h);
    farthest = std::max(farthest, truck.X_WB.translation().x());
  }
  EXPECT_NEAR(farthest, 12.0 + before, 0.02);
  EXPECT_EQ(report.dent_m, before);
  EXPECT_LT(report.deepest_ever_m, 0.02);
}

TEST_P(StepSize, ATruckIsStoppedByAThickTrunkWithoutPassingIt) {
  const double h = GetParam();
  const Ground ground = ground_with({trunk_at(5.0, 0.0, 0.4, 10.0)});
  const Vector half(2.0, 1.1, 0.4);
  for (const double speed : {1.0, 5.0, 13.9}) {
    FreeBody truck(ground, ConvexShape::box(half), 5600.0, box_inertia(5600.0, half), 1.5e6, 3e4);
    truck.gravity_mps2 = 0.0;
    truck.X_WB.translation() << 0.0, 0.0, 1.0;
    truck.v_W.x() = speed;
    const double start = truck.energy_j();
    const double gain = greatest_gain_j(truck, h, 4.0);
    EXPECT_LT(gain, 1e-3 * start);
    EXPECT_LT(truck.X_WB.translation().x(), 2.6);
    EXPECT_LT(truck.v_W.x(), 0.0);
    EXPECT_GT(truck.contact().report().touches, 0U);
  }
}

INSTANTIATE_TEST_SUITE_P(Steps, StepSize, testing::Values(1e-4, 1e-3, 2e-3, 5e-3),
                         [](const auto& step) {
                           return "step_" + std::to_string(std::lround(1e4 * step.param)) +
                                  "_tenths_of_ms";
                         });

TEST(ContactSet, ATrunkGivesWayBeyondItsMomentAndNotBefore) {
  Obstacle trunk = trunk_at(5.0, 0.0, 0.1, 15.0);
  trunk.strength_nm = 21e3;
  trunk.stiffness_npm = 1.7e6;
  const Ground ground = ground_with({trunk});
  const Vector half(2.0, 1.1, 0.4);
  FreeBody truck(ground, ConvexShape::box(half), 5600.0, box_inertia(5600.0, half), 1.5e6, 3e4);
  truck.gravity_mps2 = 0.0;
  truck.X_WB.translation() << 2.899, 0.0, 0.8;
  const auto push = [&](double force_n, double span_s) {
    truck.push_W.x() = force_n;
    for (int i = 0; i < static_cast<int>(span_s / 1e-3); ++i) {
      truck.step(1e-3);
    }
  };
  // 21 kNm shared by 1.2 m, the front's upper edge, and 0.4 m, its lower: 35 kN together.
  push(8e3, 4.0);
  EXPECT_EQ(truck.contact().report().felled, 0U);
  EXPECT_TRUE(truck.contact().leaning().empty());
  EXPECT_LT(truck.X_WB.translation().x(), 3.0);
  push(45e3, 4.0);
  EXPECT_EQ(truck.contact().report().felled, 1U);
  EXPECT_GT(truck.X_WB.translation().x(), 5.0);
  // The work that the trunk took: about its moment times a quarter of a radian.
  EXPECT_NEAR(truck.contact().report().lost_j, 21e3 * 0.25, 0.5 * 21e3 * 0.25);
}

TEST(ContactSet, ATreeThatGaveWayFallsAwayFromThePushAndLiesOnTheGround) {
  Obstacle trunk = trunk_at(5.0, 0.0, 0.1, 3.0);
  trunk.strength_nm = 21e3;
  trunk.stiffness_npm = 1.7e6;
  trunk.tree_height_m = 15.0;
  const Ground ground = ground_with({trunk});
  const Vector half(2.0, 1.1, 0.4);
  FreeBody truck(ground, ConvexShape::box(half), 5600.0, box_inertia(5600.0, half), 1.5e6, 3e4);
  truck.gravity_mps2 = 0.0;
  truck.X_WB.translation() << 2.899, 0.0, 0.8;
  truck.push_W.x() = 45e3;
  double before_rad = 0.0;
  double down_s = 0.0;
  for (int i = 0; i < 12000; ++i) {
    truck.step(1e-3);
    if (truck.contact().leaning().empty()) {
      continue;
    }
    const LeaningObstacle& lean = truck.contact().leaning().front();
    EXPECT_GE(lean.angle_rad, before_rad - 0.01);
    EXPECT_LT(lean.angle_rad - before_rad, 0.1) << "no jump";
    before_rad = lean.angle_rad;
    down_s += lean.down && !lean.lies ? 1e-3 : 0.0;
    // When it is down the truck stops: that it falls on is nobody's push.
    if (lean.down) {
      truck.push_W.x() = 0.0;
      truck.v_W.setZero();
      truck.w_W.setZero();
    }
  }
  ASSERT_EQ(truck.contact().leaning().size(), 1U);
  const LeaningObstacle& lean = truck.contact().leaning().front();
  EXPECT_TRUE(lean.lies);
  EXPECT_NEAR(lean.angle_rad, 0.5 * std::numbers::pi, 0.03);
  const Vector top = lean.motion_W(trunk.foot_W()) * Vector(5.0, 0.0, trunk.foot_W().z() + 15.0);
  EXPECT_NEAR(top.x(), 20.0, 0.3) << "away from the push";
  // theta'' = 3 g / (2 L) sin theta from 0.4 rad: at rest it would take 2.2 s; the truck was at
  // some 3 m/s.
  EXPECT_GT(down_s, 0.4);
  EXPECT_LT(down_s, 2.4);
}

// Vehicles that came later drove through what was seen lying there.
TEST(ContactSet, ATrunkThatLiesIsFeltByWhoComesLater) {
  Obstacle trunk = trunk_at(5.0, 0.0, 0.25, 3.0);
  trunk.strength_nm = 21e3;
  trunk.stiffness_npm = 1.7e6;
  trunk.tree_height_m = 15.0;
  const Ground ground = ground_with({trunk});
  const Vector half(2.0, 1.1, 0.4);
  FreeBody truck(ground, ConvexShape::box(half), 5600.0, box_inertia(5600.0, half), 1.5e6, 3e4);
  truck.gravity_mps2 = 0.0;
  truck.X_WB.translation() << 2.7, 0.0, 0.8;
  const auto drive = [&](const Vector& v_W, double span_s) {
    truck.X_WB.linear().setIdentity();
    truck.v_W = v_W;
    truck.w_W.setZero();
    for (int i = 0; i < static_cast<int>(span_s / 1e-3); ++i) {
      truck.step(1e-3);
    }
  };
  const auto allocated = rigwire::test::allocations();
  truck.push_W.x() = 60e3;
  for (int i = 0; i < 6000 && truck.contact().report().felled == 0; ++i) {
    truck.step(1e-3);
  }
  ASSERT_EQ(truck.contact().report().felled, 1U);
  truck.push_W.setZero();
  // On over the place where it falls: it lies under the truck, and is nothing yet.
  drive({1.5, 0.0, -0.2}, 2.0);
  ASSERT_TRUE(truck.contact().leaning().front().lies);
  EXPECT_FALSE(truck.contact().leaning().front().solid);
  EXPECT_EQ(truck.contact().report().points, 0U);
  // Off it to the side, and back.
  drive({0.0, -3.0, 0.0}, 2.0);
  EXPECT_TRUE(truck.contact().leaning().front().solid);
  const double before_j = truck.contact().report().lost_j;
  drive({0.0, 3.0, 0.0}, 3.0);
  EXPECT_EQ(rigwire::test::allocations(), allocated);
  const double flank_m = truck.X_WB.translation().y() + half.y();
  EXPECT_LT(flank_m, -0.2) << "it stopped at the trunk's side, or came back";
  EXPECT_LT(truck.v_W.y(), 0.5);
  EXPECT_GT(truck.contact().report().lost_j, before_j + 1e3);
  EXPECT_LT(truck.contact().report().deepest_ever_m, 0.25);
  EXPECT_EQ(truck.contact().report().felled, 1U) << "what lies does not fall again";
}

TEST(ContactSet, NothingNearCostsNothingAndAllocatesNothing) {
  std::vector<Obstacle> trunks;
  for (int i = 0; i < 400; ++i) {
    trunks.push_back(trunk_at(3.0 * (i % 20) - 30.0, 3.0 * (i / 20) - 30.0, 0.2, 10.0));
  }
  const Ground ground = ground_with(trunks);
  const Vector half(2.0, 0.8, 0.4);
  FreeBody truck(ground, ConvexShape::box(half), 5600.0, box_inertia(5600.0, half), 1.5e6, 3e4);
  truck.gravity_mps2 = 0.0;
  truck.X_WB.translation() << -28.5, -28.5, 1.0;
  truck.v_W << 5.0, 2.0, 0.0;
  truck.step(1e-3);
  const std::uint64_t before = rigwire::test::allocations();
  for (int i = 0; i < 5000; ++i) {
    truck.step(1e-3);
  }
  EXPECT_EQ(rigwire::test::allocations(), before);
  EXPECT_GT(truck.contact().report().touches, 0U);
  EXPECT_EQ(truck.contact().dropped(), 0U);
}

// The bucket put 0.4 m into the truck left it at 230 m/s.
TEST(ContactSet, WhatBeginsInsideCanGoOutAndNotFartherIn) {
  const Ground ground = ground_with({box_obstacle({0.0, 0.0, 1.0}, {1.0, 5.0, 5.0}, 0.0)});
  const Vector half(0.3, 0.3, 0.3);
  for (const double push : {-2e4, 2e4}) {
    FreeBody crate(ground, ConvexShape::box(half), 500.0, box_inertia(500.0, half), 1e9, 1e6);
    crate.gravity_mps2 = 0.0;
    crate.X_WB.translation() << 0.9, 0.0, 1.0;
    crate.push_W.x() = push;
    for (int i = 0; i < 1000; ++i) {
      crate.step(1e-3);
    }
    EXPECT_LT(crate.contact().report().deepest_ever_m, 0.401);
    EXPECT_GT(crate.contact().report().lost_j, -1e-6);
    if (push < 0.0) {
      EXPECT_NEAR(crate.X_WB.translation().x(), 0.9, 1e-3);
    } else {
      // It moves as freely as in the open: F t^2 / (2 m).
      EXPECT_NEAR(crate.X_WB.translation().x(), 0.9 + 0.5 * push / 500.0, 0.05);
    }
  }
}

// A wall fell over because the truck that met it was bent.
TEST(ContactSet, WhatABodyIsBentByDoesNotLean) {
  const Ground ground = ground_with({box_obstacle({15.0, 0.0, 1.0}, {1.0, 8.0, 4.0})});
  const Vector half(2.0, 1.1, 0.4);
  FreeBody truck(ground, ConvexShape::box(half), 5600.0, box_inertia(5600.0, half), 4e7, 2e5, 2.5e5,
                 4e5);
  truck.gravity_mps2 = 0.0;
  truck.X_WB.translation() << 11.5, 0.0, 1.0;
  truck.v_W.x() = 13.9;
  EXPECT_EQ(greatest_gain_j(truck, 1e-3, 0.5), 0.0);
  EXPECT_TRUE(truck.contact().leaning().empty());
  ASSERT_EQ(truck.contact().dents().size(), 1U);
  const Dent& dent = truck.contact().dents().front();
  EXPECT_NEAR(dent.normal_L.x(), -1.0, 1e-6);
  EXPECT_NEAR(dent.patch_L.min().x(), half.x(), 1e-3) << "of the front as it was";
  EXPECT_NEAR(dent.patch_L.sizes().y(), 2.2, 1e-3);
}

// A trunk that gives way took the limit for the spring's when its spring was softened: 0.5 kJ.
TEST(ContactSet, ATrunkThatLeansGivesNothingBack) {
  Obstacle trunk = trunk_at(5.0, 0.0, 0.1, 15.0);
  trunk.stiffness_npm = 1.7e6;
  for (const double strength : {5e3, 21e3, 64e3}) {
    trunk.strength_nm = strength;
    const Ground ground = ground_with({trunk});
    for (const double turn : {0.0, 0.3, -0.7}) {
      const Vector half(2.0, 1.1, 0.4);
      FreeBody truck(ground, ConvexShape::box(half), 5600.0, box_inertia(5600.0, half), 1.5e6, 3e4);
      truck.gravity_mps2 = 0.0;
      truck.X_WB.linear() = Eigen::AngleAxisd(turn, Vector::UnitZ()).matrix();
      truck.X_WB.translation() << 1.0, 0.4, 0.8;
      truck.v_W << 4.0, 0.0, 0.0;
      truck.w_W << 0.0, 0.0, 0.8;
      EXPECT_LT(greatest_gain_j(truck, 1e-3, 3.0), 1.0) << strength << " " << turn;
      EXPECT_GT(truck.contact().report().touches, 0U);
    }
  }
}

// What is skipped because it cannot have come near is what would not have pushed.
TEST(ContactSet, RememberingWhoIsFarChangesNotOneBit) {
  std::vector<Obstacle> obstacles{box_obstacle({0.0, 0.0, -1.0}, {20.0, 20.0, 1.0})};
  RandomStream random(3, "about");
  for (int i = 0; i < 40; ++i) {
    obstacles.push_back(
        i % 2 == 0 ? trunk_at(random.uniform(-6.0, 6.0), random.uniform(-6.0, 6.0), 0.15, 6.0)
                   : rock_at({random.uniform(-6.0, 6.0), random.uniform(-6.0, 6.0), 0.1}, 0.4));
  }
  const Ground ground = ground_with(obstacles);
  const Vector half(0.5, 0.4, 0.3);
  const auto thrown = [&](bool anew) {
    FreeBody crate(ground, ConvexShape::box(half), 1000.0, box_inertia(1000.0, half), 5e6, 4e4);
    crate.X_WB.linear() = Eigen::AngleAxisd(0.7, Vector(1.0, 0.6, 0.2).normalized()).matrix();
    crate.X_WB.translation() << -8.0, -7.5, 1.5;
    crate.v_W << 7.0, 6.0, 1.0;
    crate.w_W << 3.0, -2.0, 5.0;
    for (int i = 0; i < 3000; ++i) {
      if (anew) {
        crate.look_anew(obstacles.size());
      }
      crate.step(1e-3);
    }
    return crate;
  };
  const FreeBody remembering = thrown(false);
  const FreeBody looking = thrown(true);
  EXPECT_EQ(remembering.X_WB.matrix(), looking.X_WB.matrix());
  EXPECT_EQ(remembering.contact().report().lost_j, looking.contact().report().lost_j);
  EXPECT_GT(looking.contact().report().touches, 3U);
}

TEST(ContactSet, TheSameTwiceGivesTheSameBits) {
  const auto run = [] {
    const Ground ground =
        ground_with({box_obstacle({0.0, 0.0, -1.0}, {20.0, 20.0, 1.0}),
                     trunk_at(1.5, 0.2, 0.2, 5.0), rock_at({-1.2, 0.3, 0.1}, 0.5)});
    const Vector half(0.5, 0.4, 0.3);
    FreeBody crate(ground, ConvexShape::box(half), 1000.0, box_inertia(1000.0, half), 5e6, 4e4);
    crate.X_WB.linear() = Eigen::AngleAxisd(0.7, Vector(1.0, 0.6, 0.2).normalized()).matrix();
    crate.X_WB.translation().z() = 1.5;
    crate.v_W << 2.0, 0.3, 0.0;
    for (int i = 0; i < 3000; ++i) {
      crate.step(1e-3);
    }
    return crate;
  };
  const FreeBody a = run();
  const FreeBody b = run();
  EXPECT_EQ(a.X_WB.matrix(), b.X_WB.matrix());
  EXPECT_EQ(a.contact().report().lost_j, b.contact().report().lost_j);
  EXPECT_GT(a.contact().report().touches, 1U);
}

}  // namespace
}  // namespace rigwire::sim
