#include "emulators/inertial/filter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fields/constants.h"

namespace rigwire::emulators {
namespace {

constexpr double kTrustedDeviation_mps2 = 0.05 * kGravity_mps2;
constexpr double kInitialGainFactor = 10.0;

Triad cross(const Triad& a, const Triad& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double norm(const Triad& a) {
  return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

Triad scaled(double factor, const Triad& a) {
  return {factor * a[0], factor * a[1], factor * a[2]};
}

Triad sum(const Triad& a, const Triad& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

}  // namespace

LowPass::LowPass(double cut_off_hz, double sample_rate_hz) : pass_through_(cut_off_hz == 0.0) {
  if (!pass_through_) {
    // Butterworth of order 2 by the bilinear transform, pre-warped: k = tan(pi f_c / f_s).
    const double k = std::tan(std::numbers::pi * cut_off_hz / sample_rate_hz);
    const double scale = 1.0 / (1.0 + std::numbers::sqrt2 * k + k * k);
    b0_ = k * k * scale;
    a1_ = 2.0 * (k * k - 1.0) * scale;
    a2_ = (1.0 - std::numbers::sqrt2 * k + k * k) * scale;
  }
}

Triad LowPass::filter(const Triad& input) {
  if (pass_through_) {
    return input;
  }
  Triad output{};
  for (std::size_t i = 0; i < input.size(); ++i) {
    State& state = state_[i];
    if (!settled_) {
      // Steady state of a constant input: gain 1.
      state = {input[i] * (1.0 - b0_), input[i] * (b0_ - a2_)};
    }
    // Transposed direct form II; numerator b0 (1 + 2 z^-1 + z^-2).
    output[i] = b0_ * input[i] + state.first;
    state.first = 2.0 * b0_ * input[i] - a1_ * output[i] + state.second;
    state.second = b0_ * input[i] - a2_ * output[i];
  }
  settled_ = true;
  return output;
}

void TiltFilter::step(const Triad& rate_radps, const Triad& specific_force_mps2, double period_s) {
  const double magnitude = norm(specific_force_mps2);
  if (!started_) {
    if (magnitude > 0.5 * kGravity_mps2) {
      up_ = scaled(1.0 / magnitude, specific_force_mps2);
      started_ = true;
    }
    previous_rate_radps_ = rate_radps;
    return;
  }
  const bool initial = initialising();
  // Gain of the pull, faded where |f| is off gravity; bias gain k_P^2 / 8.
  const double trust =
      std::max(0.0, 1.0 - std::abs(magnitude - kGravity_mps2) / kTrustedDeviation_mps2);
  const double gain = trust * (initial ? kInitialGainFactor : 1.0) / kTimeConstant_s;
  const double bias_gain = initial ? 0.0 : trust / (8.0 * kTimeConstant_s * kTimeConstant_s);

  Triad error{};
  if (trust > 0.0) {
    // Mahony et al. 2008: the error is the cross product of measured and carried direction.
    error = cross(scaled(1.0 / magnitude, specific_force_mps2), up_);
  }
  const Triad mean_rate = scaled(0.5, sum(rate_radps, previous_rate_radps_));
  previous_rate_radps_ = rate_radps;
  bias_radps_ = sum(bias_radps_, scaled(-bias_gain * period_s, error));
  const Triad rate = sum(sum(mean_rate, scaled(-1.0, bias_radps_)), scaled(gain, error));
  // up' = up x w, by its Taylor series to second order, then back to unit length.
  const Triad first = cross(up_, rate);
  const Triad second = cross(first, rate);
  up_ = sum(up_, sum(scaled(period_s, first), scaled(0.5 * period_s * period_s, second)));
  up_ = scaled(1.0 / norm(up_), up_);
  age_s_ += period_s;
}

double TiltFilter::pitch_rad() const {
  return std::asin(std::clamp(up_[0], -1.0, 1.0));
}

double TiltFilter::roll_rad() const {
  return std::atan2(-up_[1], -up_[2]);
}

}  // namespace rigwire::emulators
