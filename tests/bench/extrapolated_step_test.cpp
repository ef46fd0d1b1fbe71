#include "bench/extrapolated_step.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

namespace rigwire::bench {
namespace {

TEST(ExtrapolatedStep, EachOrderTakesOnePowerOfTheStepAway) {
  for (int order = 1; order <= kExtrapolationMax; ++order) {
    // 5 + sum (n+1) / parts^n up to the power that is just taken away.
    const double found = extrapolated(order, [&](int parts) {
      double sum = 5.0;
      for (int power = 1; power < order; ++power) {
        sum += (power + 1) / std::pow(parts, power);
      }
      return sum;
    });
    EXPECT_NEAR(found, 5.0, 1e-11) << order;
  }
}

// x' = -20 x by the linearly implicit Euler rule, x(1 s) from 1.
TEST(ExtrapolatedStep, AStiffDecayConvergesWithTheOrderAskedFor) {
  const auto error = [](int order, int steps) {
    const double h = 1.0 / steps;
    Eigen::Vector2d x(1.0, 2.0);
    for (int i = 0; i < steps; ++i) {
      const Eigen::Vector2d start = x;
      x = extrapolated(order, [&](int parts) {
        return Eigen::Vector2d(start / std::pow(1.0 + 20.0 * h / parts, parts));
      });
    }
    return (x - std::exp(-20.0) * Eigen::Vector2d(1.0, 2.0)).norm();
  };
  for (int order = 1; order <= 4; ++order) {
    EXPECT_NEAR(std::log2(error(order, 800) / error(order, 1600)), order, 0.15) << order;
  }
}

}  // namespace
}  // namespace rigwire::bench
