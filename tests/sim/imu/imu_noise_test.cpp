#include "sim/imu/imu_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "number_word.h"

namespace rigwire::sim {
namespace {

/// Overlapping Allan deviation of each axis at averaging time m * dt, combined over all records.
class AllanDeviation {
 public:
  explicit AllanDeviation(std::size_t m) : m_(m) {}

  void add(const std::vector<double>& record) {
    std::vector<double> integral(record.size() + 1, 0.0);
    for (std::size_t i = 0; i < record.size(); ++i) {
      integral[i + 1] = integral[i] + record[i];
    }
    for (std::size_t i = 0; i + 2 * m_ < integral.size(); ++i) {
      const double difference =
          (integral[i + 2 * m_] - 2.0 * integral[i + m_] + integral[i]) / static_cast<double>(m_);
      sum_ += difference * difference;
      ++count_;
    }
  }
  [[nodiscard]] double value() const { return std::sqrt(0.5 * sum_ / static_cast<double>(count_)); }

 private:
  std::size_t m_;
  double sum_ = 0.0;
  std::size_t count_ = 0;
};

double allan(const RandomErrorParameters& parameters, double rate_hz, double record_s, double tau_s,
             int triads) {
  const auto samples = static_cast<std::size_t>(record_s * rate_hz);
  AllanDeviation deviation(static_cast<std::size_t>(std::lround(tau_s * rate_hz)));
  for (int triad = 0; triad < triads; ++triad) {
    RandomStream random(42, "noise test " + std::to_string(triad));
    RandomErrors errors(parameters, random);
    std::vector<double> record[3];
    for (std::size_t i = 0; i < samples; ++i) {
      const Eigen::Vector3d error = errors.next(1.0 / rate_hz, random);
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        record[axis].push_back(error(axis));
      }
    }
    for (const auto& axis : record) {
      deviation.add(axis);
    }
  }
  return deviation.value();
}

class NoiseAtRate : public testing::TestWithParam<double> {};

TEST_P(NoiseAtRate, AllanDeviationAtOneSecondIsTheDensity) {
  RandomErrorParameters parameters;
  parameters.noise_density = 0.03;
  EXPECT_NEAR(allan(parameters, GetParam(), 3000.0, 1.0, 2), 0.03, 0.03 * 0.03);
}

TEST_P(NoiseAtRate, RandomWalkGrowsWithTimeNotWithSamples) {
  // Allan deviation of a random walk K at tau: K sqrt(tau / 3).
  RandomErrorParameters parameters;
  parameters.random_walk = 0.1;
  EXPECT_NEAR(allan(parameters, GetParam(), 2000.0, 1.0, 2), 0.1 / std::sqrt(3.0),
              0.04 * 0.1 / std::sqrt(3.0));
}

TEST_P(NoiseAtRate, FloorIsThatOfTheDataSheet) {
  RandomErrorParameters parameters;
  parameters.bias_instability = 18.0;
  EXPECT_NEAR(allan(parameters, GetParam(), 1500.0, 5.0, 1), 18.0, 1.8);
}

INSTANTIATE_TEST_SUITE_P(Rates, NoiseAtRate, testing::Values(50.0, 200.0, 1000.0),
                         [](const auto& test) {
                           return "at_" + rigwire::test::number_word(test.param) + "_hz";
                         });

TEST(BiasInstability, FloorIsThatOfTheDataSheetAtEveryRate) {
  RandomErrorParameters parameters;
  parameters.bias_instability = 18.0;
  for (const double rate_hz : {2.0, 10.0}) {
    for (const double tau_s : {30.0, 100.0}) {
      EXPECT_NEAR(allan(parameters, rate_hz, 20'000.0, tau_s, 4), 18.0, 1.8)
          << rate_hz << " Hz, " << tau_s << " s";
    }
  }
}

TEST(BiasInstability, TogetherWithNoiseFollowsBothAsymptotes) {
  RandomErrorParameters parameters;
  parameters.noise_density = 108.0;  // deg/h at 1 s: 0.03 deg/s/sqrt(Hz)
  parameters.bias_instability = 18.0;
  EXPECT_NEAR(allan(parameters, 20.0, 10'000.0, 1.0, 2), std::hypot(108.0, 18.0), 0.03 * 109.0);
}

}  // namespace
}  // namespace rigwire::sim
