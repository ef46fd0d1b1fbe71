#include "sim/gnss/gauss_markov.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace rigwire::sim {
namespace {

/// Mean product of values `lag` samples apart.
double correlation(const std::vector<double>& x, std::size_t lag) {
  double sum = 0.0;
  for (std::size_t i = 0; i + lag < x.size(); ++i) {
    sum += x[i] * x[i + lag];
  }
  return sum / static_cast<double>(x.size() - lag);
}

TEST(GaussMarkov, AutocorrelationIsTheSameWhateverTheStep) {
  constexpr double kTau_s = 10.0;
  for (const double step_s : {0.1, 1.0, 5.0}) {
    RandomStream random(1, "process");
    GaussMarkov process;
    std::vector<double> x;
    for (double t = 0.0; t < 100'000.0; t += step_s) {
      process.advance(step_s, kTau_s, random);
      x.push_back(process.value());
    }
    // 5000 independent stretches: 3 % is two standard deviations.
    EXPECT_NEAR(correlation(x, 0), 1.0, 0.05) << step_s;
    for (const double lag_s : {5.0, 10.0, 20.0}) {
      const auto lag = static_cast<std::size_t>(std::lround(lag_s / step_s));
      EXPECT_NEAR(correlation(x, lag), std::exp(-lag_s / kTau_s), 0.05) << step_s << " " << lag_s;
    }
  }
}

TEST(GaussMarkov, AllanVarianceFollowsTheClosedForm) {
  // sigma^2(T) = 2 s^2 tau/T [1 - tau/(2T) (3 - 4 exp(-T/tau) + exp(-2T/tau))]
  constexpr double kTau_s = 10.0;
  constexpr double kStep_s = 0.25;
  RandomStream random(2, "process");
  GaussMarkov process;
  for (const double window_s : {5.0, 20.0, 80.0}) {
    const auto n = static_cast<int>(window_s / kStep_s);
    double square = 0.0;
    double before = 0.0;
    constexpr int kWindows = 4000;
    for (int k = 0; k <= kWindows; ++k) {
      double mean = 0.0;
      for (int i = 0; i < n; ++i) {
        process.advance(kStep_s, kTau_s, random);
        mean += process.value() / n;
      }
      square += k == 0 ? 0.0 : 0.5 * (mean - before) * (mean - before) / kWindows;
      before = mean;
    }
    const double x = window_s / kTau_s;
    const double closed =
        2.0 / x * (1.0 - 0.5 / x * (3.0 - 4.0 * std::exp(-x) + std::exp(-2.0 * x)));
    EXPECT_NEAR(square / closed, 1.0, 0.1) << window_s;
  }
}

TEST(GaussMarkov, WithoutCorrelationItIsWhite) {
  RandomStream random(3, "process");
  GaussMarkov process;
  std::vector<double> x;
  for (int i = 0; i < 20'000; ++i) {
    process.advance(0.1, 0.0, random);
    x.push_back(process.value());
  }
  EXPECT_NEAR(correlation(x, 0), 1.0, 0.03);
  EXPECT_NEAR(correlation(x, 1), 0.0, 0.03);
}

}  // namespace
}  // namespace rigwire::sim
