// Disparities in steps of a sixteenth of a pixel, the resolution of OpenCV's matchers.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "sim/camera/stereo_matcher.h"

namespace rigwire::sim {

inline constexpr int kDisparitySteps = 16;
inline constexpr float kPerStep_px = 1.0F / static_cast<float>(kDisparitySteps);

/// Returns whether there is a disparity: not at infinity, where surfaces without texture end up,
/// and not below the searched ones.
[[nodiscard]] inline bool found_at(int steps, int least_disparity) {
  return steps > 0 && steps >= least_disparity * kDisparitySteps;
}

/// Converts `steps` to pixels; DisparityPicture::kNone where found_at() is false.
void take_steps(std::span<const std::int16_t> steps, int least_disparity,
                std::vector<float>& disparity_px);

/// Returns how well a disparity and the one that leads back agree: 255 if they are within a step, 0
/// if they are more than kDisagreement_px apart.
[[nodiscard]] inline int agreement(int steps, int returned_steps) {
  constexpr int kMost = kDisagreement_px * kDisparitySteps;
  const int apart = std::max(0, std::abs(steps - returned_steps) - 1);
  return (255 * std::max(0, kMost - apart) + kMost / 2) / kMost;
}

/// The column of the other picture that a disparity leads to; below 0: none.
[[nodiscard]] inline int led_to(int column, int steps) {
  return column - (steps + kDisparitySteps / 2) / kDisparitySteps;
}

}  // namespace rigwire::sim
