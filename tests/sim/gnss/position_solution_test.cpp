#include "sim/gnss/position_solution.h"
#include "fields/constants.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/random.h"

namespace rigwire::sim {
namespace {

RangeEquation at(double azimuth_deg, double elevation_deg, GnssSystem system = GnssSystem::gps) {
  const double a = azimuth_deg * kDegree;
  const double e = elevation_deg * kDegree;
  RangeEquation equation;
  equation.direction_ned = {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), -std::sin(e)};
  equation.system = system;
  return equation;
}

std::vector<RangeEquation> sky() {
  return {at(20, 70), at(80, 30), at(140, 15), at(200, 45), at(260, 10), at(330, 25)};
}

TEST(PositionSolution, FindsThePositionThatMadeTheRanges) {
  auto equations = sky();
  equations.push_back(at(10, 50, GnssSystem::glonass));
  equations.push_back(at(190, 20, GnssSystem::glonass));
  equations.push_back(at(100, 35, GnssSystem::sbas));  // GPS time
  const Eigen::Vector3d moved(3.0, -2.0, 5.0);
  RandomStream random(1, "sigma");
  for (auto& equation : equations) {
    const double clock_m = equation.system == GnssSystem::glonass ? -40.0 : 12.0;
    equation.error_m = clock_m - equation.direction_ned.dot(moved);
    equation.sigma_m = random.uniform(0.5, 5.0);
  }
  const auto solution = solve_position(equations, std::nullopt);
  ASSERT_TRUE(solution);
  EXPECT_LT((solution->error_ned_m - moved).norm(), 1e-9);
  EXPECT_NEAR(solution->clock_error_m, 12.0, 1e-9);
  for (const double residual_m : solution->residuals_m) {
    EXPECT_NEAR(residual_m, 0.0, 1e-9);
  }
}

TEST(PositionSolution, DilutionsEqualThoseOfTheGeometry) {
  const auto equations = sky();
  std::vector<Eigen::Vector3d> directions_enu;
  for (const auto& equation : equations) {
    const auto& ned = equation.direction_ned;
    directions_enu.emplace_back(ned.y(), ned.x(), -ned.z());
  }
  const Dilution expected = make_geometric_dilution()->reported(directions_enu);
  const auto solution = solve_position(equations, std::nullopt);
  ASSERT_TRUE(solution);
  EXPECT_NEAR(solution->dilution.horizontal, expected.horizontal, 1e-9);
  EXPECT_NEAR(solution->dilution.vertical, expected.vertical, 1e-9);
  EXPECT_NEAR(solution->dilution.position, expected.position, 1e-9);
  EXPECT_NEAR(solution->dilution.time, expected.time, 1e-9);
  EXPECT_NEAR(solution->dilution.north, expected.north, 1e-9);
  EXPECT_NEAR(solution->dilution.east, expected.east, 1e-9);
  // With sigma 1 the covariance is the cofactor matrix itself.
  EXPECT_NEAR(solution->covariance_ned_m2(0, 0), expected.north * expected.north, 1e-9);
  EXPECT_NEAR(solution->covariance_ned_m2(2, 2), expected.vertical * expected.vertical, 1e-9);
}

TEST(PositionSolution, WhatAllRangesShareAlikeGoesToTheClock) {
  auto equations = sky();
  const auto alone = solve_position(equations, std::nullopt);
  for (auto& equation : equations) {
    equation.common_m[1] = 3.0;
    equation.sigma_m = std::sqrt(1.0 + 9.0);
  }
  const auto shared = solve_position(equations, std::nullopt);
  ASSERT_TRUE(alone && shared);
  EXPECT_LT((alone->covariance_ned_m2 - shared->covariance_ned_m2).norm(), 1e-9);
  EXPECT_NEAR(shared->clock_sigma_m, std::hypot(alone->clock_sigma_m, 3.0), 1e-9);
}

TEST(PositionSolution, CovarianceIsThatOfTheErrors) {
  auto equations = sky();
  RandomStream random(3, "errors");
  for (auto& equation : equations) {
    equation.common_m = {random.uniform(0.0, 3.0), random.uniform(-2.0, 2.0), 0.0, 0.0};
    equation.sigma_m =
        std::hypot(random.uniform(0.5, 3.0), equation.common_m[0], equation.common_m[1]);
  }
  const Eigen::Matrix3d believed = solve_position(equations, std::nullopt)->covariance_ned_m2;
  Eigen::Matrix3d sample = Eigen::Matrix3d::Zero();
  constexpr int kTrials = 20'000;
  for (int i = 0; i < kTrials; ++i) {
    const double first = random.gaussian();
    const double second = random.gaussian();
    for (auto& equation : equations) {
      const double common = std::hypot(equation.common_m[0], equation.common_m[1]);
      const double own = std::sqrt(equation.sigma_m * equation.sigma_m - common * common);
      equation.error_m =
          equation.common_m[0] * first + equation.common_m[1] * second + own * random.gaussian();
    }
    const Eigen::Vector3d error = solve_position(equations, std::nullopt)->error_ned_m;
    sample += error * error.transpose() / kTrials;
  }
  EXPECT_LT((sample - believed).norm(), 0.05 * believed.norm());
}

TEST(PositionSolution, AHeldHeightTurnsIntoRangesAndIsReported) {
  const std::vector<RangeEquation> three{at(0, 30), at(120, 30), at(240, 30)};
  const auto solution = solve_position(three, HeldHeight{8.0, 4.0});
  ASSERT_TRUE(solution);
  // A symmetric ring: the height error goes to the clock, sin 30 of it.
  EXPECT_NEAR(solution->error_ned_m.head<2>().norm(), 0.0, 1e-9);
  EXPECT_NEAR(solution->error_ned_m.z(), -8.0, 1e-12);
  EXPECT_NEAR(solution->clock_error_m, 4.0, 1e-9);
  EXPECT_NEAR(solution->covariance_ned_m2(2, 2), 16.0, 1e-9);
  EXPECT_TRUE(std::isnan(solution->dilution.vertical));
  EXPECT_DOUBLE_EQ(solution->dilution.position, solution->dilution.horizontal);
  // Clock: three ranges of sigma 1, and the height through the sine.
  EXPECT_NEAR(solution->clock_sigma_m, std::sqrt(1.0 / 3.0 + 4.0), 1e-9);

  auto lopsided = three;
  lopsided[1] = at(30, 60);
  const auto off = solve_position(lopsided, HeldHeight{8.0, 4.0});
  ASSERT_TRUE(off);
  // What the held height does is what the same ranges with that height would have needed.
  for (std::size_t i = 0; i < 3; ++i) {
    const double predicted = off->clock_error_m - lopsided[i].direction_ned.dot(off->error_ned_m);
    EXPECT_NEAR(predicted, 0.0, 1e-9);
  }
}

TEST(PositionSolution, WhatDoesNotDetermineAPositionGivesNone) {
  EXPECT_FALSE(solve_position({}, std::nullopt));
  const auto all = sky();
  EXPECT_FALSE(solve_position(std::span(all).first(3), std::nullopt));
  EXPECT_TRUE(solve_position(std::span(all).first(3), HeldHeight{}));
  EXPECT_FALSE(solve_position(std::span(all).first(2), HeldHeight{}));
  // All in the vertical plane through north: nothing is known of the east.
  const std::vector<RangeEquation> plane{at(0, 10), at(0, 40), at(0, 80), at(180, 30), at(180, 60)};
  EXPECT_FALSE(solve_position(plane, std::nullopt));
  EXPECT_FALSE(solve_position(plane, HeldHeight{}));
  const std::vector<RangeEquation> cone{at(0, 40), at(70, 40), at(140, 40), at(210, 40),
                                        at(280, 40)};
  EXPECT_FALSE(solve_position(cone, std::nullopt));
}

TEST(PositionSolution, EverySystemPaysForItsClock) {
  auto equations = sky();
  EXPECT_EQ(effective_count(equations), 6);
  equations.push_back(at(45, 45, GnssSystem::galileo));
  EXPECT_EQ(effective_count(equations), 6);
  equations.push_back(at(90, 45, GnssSystem::sbas));
  EXPECT_EQ(effective_count(equations), 7);
  EXPECT_EQ(effective_count({}), 0);
  // A system of one satellite says nothing about the position.
  auto gps = sky();
  gps[2].error_m = 7.0;
  auto both = gps;
  both.push_back(at(45, 45, GnssSystem::galileo));
  both.back().error_m = 1000.0;
  EXPECT_LT((solve_position(gps, std::nullopt)->error_ned_m -
             solve_position(both, std::nullopt)->error_ned_m)
                .norm(),
            1e-9);
}

}  // namespace
}  // namespace rigwire::sim
