#include "sim/lidar/echo_model.h"

#include <algorithm>
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
      onset_(noise_ == RangeNoise::jitter ? static_cast<float>(parameters.noise_onset) : 0.0F),
      reflectivity_sigma_(static_cast<float>(parameters.reflectivity_sigma)),
      air_focus_m_(parameters.air_focus_range_m),
      minimum_m_(static_cast<float>(pattern.minimum_range_m)),
      maximum_m_(static_cast<float>(pattern.maximum_range_m)),
      drop_rate_(parameters.drop_rate),
      drop_limit_(parameters.drop_limit),
      drop_at_zero_(parameters.drop_at_zero),
      biased_(parameters.laser_bias_sigma_m > 0.0 || parameters.laser_reflectivity_sigma > 0.0) {
  validate(parameters);
  const double reference_m =
      parameters.reference_range_m > 0.0 ? parameters.reference_range_m : pattern.maximum_range_m;
  threshold_ = static_cast<float>(detection_energy(reference_m));
  air_threshold_ = detection_energy(
      parameters.air_reference_range_m > 0.0 ? parameters.air_reference_range_m : reference_m);
  air_minimum_m_ = parameters.air_minimum_range_m > 0.0 ? parameters.air_minimum_range_m
                                                        : pattern.minimum_range_m;
  double sigma_m = parameters.range_sigma_m;
  if (noise_ == RangeNoise::signal) {
    sigma_m = range_spread_m(sigma_m, parameters.range_resolution_m, 1.0);
  }
  sigma_m *= noise_growth(static_cast<double>(onset_), 1.0);
  reach_m_ =
      pattern.maximum_range_m + kErrorReach_sigma * (sigma_m + parameters.laser_bias_sigma_m);
  const std::string prefix(name);
  RandomStream bias(seed, prefix + "/bias");
  for (float& bias_m : biases_m_) {
    bias_m =
        static_cast<float>(parameters.laser_bias_sigma_m *
                           std::clamp(bias.gaussian(), -kGreatestBias_sigma, kGreatestBias_sigma));
  }
  RandomStream gain(seed, prefix + "/reflectivity");
  for (float& one : gains_) {
    one = static_cast<float>(
        1.0 + parameters.laser_reflectivity_sigma *
                  std::clamp(gain.gaussian(), -kGreatestBias_sigma, kGreatestBias_sigma));
  }
  RandomStream noise(seed, prefix + "/range");
  RandomStream loss(seed, prefix + "/loss");
  for (std::size_t i = 0; i < kRanks; ++i) {
    noise_keys_[i] = noise.bits();
    loss_keys_[i] = loss.bits();
  }
  shot_loss_key_ = loss.bits();
}

void EchoModel::measure(const EchoLanes& echo, const ShotNumbers& shots, EchoRank rank,
                        LaneArray& measured_m, LaneArray& brightness) const {
  measured_m = echo.range_m;
  brightness = echo.brightness;
  if (sigma_m_ > 0.0F || reflectivity_sigma_ > 0.0F || noise_ == RangeNoise::signal) {
    LaneArray normal;
    LaneArray speckle;
    gaussian(noise_keys_[static_cast<std::size_t>(rank)], shots, normal, speckle);
    LaneArray growth;
    LaneArray spread_m;
    for (std::size_t i = 0; i < kLanes; ++i) {
      // What is below the threshold is not reported; the limit keeps its errors finite.
      const float energy = std::max(echo.energy[i], threshold_);
      growth[i] = noise_growth(onset_, threshold_ / energy);
      spread_m[i] = noise_ == RangeNoise::signal
                        ? range_spread_m(sigma_m_, resolution_m_, energy / threshold_)
                        : sigma_m_ * growth[i];
    }
    for (std::size_t i = 0; i < kLanes; ++i) {
      // Gaussian range noise, by the signal where asked for (link_budget.h).
      measured_m[i] += spread_m[i] * normal[i];
      brightness[i] *= 1.0F + reflectivity_sigma_ * growth[i] * speckle[i];
    }
  }
  if (biased_) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      measured_m[i] += biases_m_[shots[i] % kMaxLasers];
      brightness[i] *= gains_[shots[i] % kMaxLasers];
    }
  }
}

EightReturns EchoModel::report(const EchoLanes& echo, const ShotNumbers& shots,
                               EchoRank rank) const {
  LaneArray measured_m;
  LaneArray brightness;
  measure(echo, shots, rank, measured_m, brightness);
  LaneArray reflectivity;
  EightReturns returns;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const bool seen = (echo.energy[i] >= threshold_) & (echo.range_m[i] >= minimum_m_) &
                      (measured_m[i] >= minimum_m_) & (measured_m[i] <= maximum_m_);
    reflectivity[i] = reported_reflectivity(brightness[i]);
    returns[i] = seen ? LidarReturn{measured_m[i], reflectivity[i]} : LidarReturn{};
  }
  if (drop_rate_ > 0.0 || (drop_at_zero_ > 0.0 && drop_limit_ > 0.0)) {
    lose(reflectivity, shots, rank, returns);
  }
  return returns;
}

void EchoModel::lose(const LaneArray& reflectivity, const ShotNumbers& shots, EchoRank rank,
                     EightReturns& returns) const {
  const std::uint64_t key = loss_keys_[static_cast<std::size_t>(rank)];
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const double intensity = static_cast<double>(reflectivity[lane]);
    // Probability of a loss: falls linearly with the reflectivity to 0 at the limit.
    const double faint =
        intensity < drop_limit_ ? drop_at_zero_ * (1.0 - intensity / drop_limit_) : 0.0;
    if (counter_uniform(shot_loss_key_, shots[lane]) < drop_rate_ ||
        counter_uniform(key, shots[lane]) < faint) {
      returns[lane] = {};
    }
  }
}

}  // namespace rigwire::sim
