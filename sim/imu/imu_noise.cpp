#include "sim/imu/imu_noise.h"

#include <cmath>
#include <numbers>

namespace rigwire::sim {
namespace {

constexpr std::array<double, 5> kCorrelationTimes_s{1.0, 10.0, 100.0, 1000.0, 10000.0};
constexpr double kSpacing = 10.0;
/// Allan floor of flicker noise over its coefficient B: sqrt(2 ln 2 / pi).
const double kFloorOfFlicker = std::sqrt(2.0 * std::numbers::ln2 / std::numbers::pi);

}  // namespace

RandomErrors::RandomErrors(const RandomErrorParameters& parameters, RandomStream& random)
    : parameters_(parameters),
      flicker_deviation_(parameters.bias_instability / kFloorOfFlicker *
                         std::sqrt(std::log(kSpacing) / std::numbers::pi)) {
  static_assert(kCorrelationTimes_s.size() == kProcesses);
  for (Eigen::Vector3d& state : flicker_) {
    state = flicker_deviation_ * gaussian3(random);
  }
}

Eigen::Vector3d RandomErrors::next(double dt_s, RandomStream& random) {
  Eigen::Vector3d error = Eigen::Vector3d::Zero();
  if (parameters_.noise_density > 0.0) {
    // White: N / sqrt(dt).
    error += parameters_.noise_density / std::sqrt(dt_s) * gaussian3(random);
  }
  if (parameters_.random_walk > 0.0) {
    // Random walk: K sqrt(dt) per sample.
    walk_ += parameters_.random_walk * std::sqrt(dt_s) * gaussian3(random);
    error += walk_;
  }
  if (flicker_deviation_ > 0.0) {
    if (dt_s != dt_s_) {
      dt_s_ = dt_s;
      for (std::size_t i = 0; i < kProcesses; ++i) {
        // Flicker: exact transition of each Gauss-Markov process, exp(-dt / tau).
        decay_[i] = std::exp(-dt_s / kCorrelationTimes_s[i]);
        drive_[i] =
            flicker_deviation_ * std::sqrt(-std::expm1(-2.0 * dt_s / kCorrelationTimes_s[i]));
      }
    }
    for (std::size_t i = 0; i < kProcesses; ++i) {
      flicker_[i] = decay_[i] * flicker_[i] + drive_[i] * gaussian3(random);
      error += flicker_[i];
    }
  }
  return error;
}

}  // namespace rigwire::sim
