#include "sim/lidar/echo_model.h"

#include <string>

#include "sim/lidar/counter_noise.h"
#include "sim/lidar/link_budget.h"
#include "sim/random.h"

namespace rigwire::sim {
namespace {

/// Errors beyond this are not looked for at the end of the range window.
constexpr double kErrorReach_sigma = 6.0;

}  // namespace

EchoModel::EchoModel(const SpinningLidarParameters& parameters, const LidarPattern& pattern,
                     std::uint64_t seed, std::string_view name)
    : noise_(parameters.range_noise),
      sigma_m_(static_cast<float>(parameters.range_sigma_m)),
      resolution_m_(static_cast<float>(parameters.range_resolution_m)),
      minimum_m_(static_cast<float>(pattern.minimum_range_m)),
      maximum_m_(static_cast<float>(pattern.maximum_range_m)),
      drop_rate_(parameters.drop_rate),
      drop_limit_(parameters.drop_limit),
      drop_at_zero_(parameters.drop_at_zero),
      biased_(parameters.laser_bias_sigma_m > 0.0) {
  validate(parameters);
  const double reference_m =
      parameters.reference_range_m > 0.0 ? parameters.reference_range_m : pattern.maximum_range_m;
  threshold_ = static_cast<float>(detection_energy(reference_m));
  double sigma_m = parameters.range_sigma_m;
  if (noise_ == RangeNoise::signal) {
    sigma_m = range_sigma_m(sigma_m, parameters.range_resolution_m, 1.0);
  }
  reach_m_ =
      pattern.maximum_range_m + kErrorReach_sigma * (sigma_m + parameters.laser_bias_sigma_m);
  const std::string prefix(name);
  RandomStream bias(seed, prefix + "/bias");
  for (float& bias_m : biases_m_) {
    bias_m = static_cast<float>(parameters.laser_bias_sigma_m * bias.gaussian());
  }
  RandomStream noise(seed, prefix + "/range");
  RandomStream loss(seed, prefix + "/loss");
  for (std::size_t i = 0; i < kRanks; ++i) {
    noise_keys_[i] = noise.bits();
    loss_keys_[i] = loss.bits();
  }
  shot_loss_key_ = loss.bits();
}

EightReturns EchoModel::report(const EchoLanes& echo, const ShotNumbers& shots,
                               EchoRank rank) const {
  Lanes measured = echo.range_m;
  const std::uint64_t key = noise_keys_[static_cast<std::size_t>(rank)];
  if (noise_ == RangeNoise::signal) {
    // Echoes below the threshold are not reported; the limit keeps their spread finite.
    const Lanes signal_to_noise = (echo.energy / threshold_).max(1.0F);
    measured +=
        range_sigma_m(sigma_m_, resolution_m_, signal_to_noise) * gaussian_lanes(key, shots);
  } else if (sigma_m_ > 0.0F) {
    measured += sigma_m_ * gaussian_lanes(key, shots);
  }
  if (biased_) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      measured(static_cast<Eigen::Index>(lane)) += biases_m_[shots[lane] % kMaxLasers];
    }
  }
  const Lanes reflectivity = reported_reflectivity<float>(echo.brightness);
  EightReturns returns{};
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const auto i = static_cast<Eigen::Index>(lane);
    const bool seen = echo.energy(i) >= threshold_ && echo.range_m(i) >= minimum_m_;
    if (seen && measured(i) >= minimum_m_ && measured(i) <= maximum_m_) {
      returns[lane] = {measured(i), reflectivity(i)};
    }
  }
  if (drop_rate_ > 0.0 || (drop_at_zero_ > 0.0 && drop_limit_ > 0.0)) {
    lose(reflectivity, shots, rank, returns);
  }
  return returns;
}

void EchoModel::lose(const Lanes& reflectivity, const ShotNumbers& shots, EchoRank rank,
                     EightReturns& returns) const {
  const std::uint64_t key = loss_keys_[static_cast<std::size_t>(rank)];
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const double intensity = static_cast<double>(reflectivity(static_cast<Eigen::Index>(lane)));
    const double faint =
        intensity < drop_limit_ ? drop_at_zero_ * (1.0 - intensity / drop_limit_) : 0.0;
    if (counter_uniform(shot_loss_key_, shots[lane]) < drop_rate_ ||
        counter_uniform(key, shots[lane]) < faint) {
      returns[lane] = {};
    }
  }
}

}  // namespace rigwire::sim
