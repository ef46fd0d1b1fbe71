// Random errors of an inertial sensor, discretised so that their statistics do not depend on the
// sample rate.
//
// - White noise of density N: an averaging sensor's sample has standard deviation N / sqrt(dt).
// - Random walk K: grows by K sqrt(dt) per sample.
// - Bias instability: flicker noise with Allan floor F, as the sum of five first-order Gauss-Markov
//   processes, correlation times 1, 10, 100, 1000, 10000 s, each of standard deviation
//   F / 0.664 * sqrt(ln 10 / pi), advanced by their exact transition. The Allan floor of the sum is
//   within 3 % of F over 1 .. 1000 s (IEEE Std 952-1997, Annex C; 0.664 = sqrt(2 ln 2 / pi)).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "sim/random.h"

namespace rigwire::sim {

/// Returns independent standard normal numbers of the three axes, drawn in the order x, y, z.
[[nodiscard]] inline Eigen::Vector3d gaussian3(RandomStream& random) {
  const double x = random.gaussian();
  const double y = random.gaussian();
  const double z = random.gaussian();
  return {x, y, z};
}

/// Units are those of the sensor's quantity: rad/s for a gyroscope, m/s2 for an accelerometer.
struct RandomErrorParameters {
  double noise_density = 0.0;     ///< Unit / sqrt(Hz).
  double bias_instability = 0.0;  ///< Floor of the Allan deviation, unit.
  double random_walk = 0.0;       ///< Unit / sqrt(s) of bias growth.
};

/// Three independent axes.
class RandomErrors {
 public:
  /// The first flicker state is drawn from its stationary distribution.
  RandomErrors(const RandomErrorParameters& parameters, RandomStream& random);

  /// Error of the sample that ends `dt_s` after the previous one. Precondition: dt_s > 0.
  [[nodiscard]] Eigen::Vector3d next(double dt_s, RandomStream& random);

 private:
  static constexpr std::size_t kProcesses = 5;

  RandomErrorParameters parameters_;
  double flicker_deviation_;  ///< Standard deviation of each process.
  std::array<Eigen::Vector3d, kProcesses> flicker_{};
  Eigen::Vector3d walk_ = Eigen::Vector3d::Zero();
  double dt_s_ = 0.0;  ///< Time step of the stored decay and drive.
  std::array<double, kProcesses> decay_{};
  std::array<double, kProcesses> drive_{};
};

}  // namespace rigwire::sim
