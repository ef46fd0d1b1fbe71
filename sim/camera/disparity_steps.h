// Disparities in OpenCV's steps of a sixteenth of a pixel, as both ways of matching have them.
#pragma once

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "sim/camera/stereo_matcher.h"

namespace rigwire::sim {

inline constexpr int kDisparitySteps = 16;
inline constexpr float kPerStep_px = 1.0F / static_cast<float>(kDisparitySteps);

/// Not at infinity, where surfaces without texture end up.
[[nodiscard]] inline bool found_at(int steps, int least_disparity) {
  return steps > 0 && steps >= least_disparity * kDisparitySteps;
}

/// `steps` of 16 bits with sign, row by row.
void take_steps(const cv::Mat& steps, int least_disparity, std::vector<float>& disparity_px);

/// How well a disparity and the one that leads back agree: 1 within a step, 0 from kDisagreement_px
/// on.
[[nodiscard]] inline float agreement(float disparity_px, float returned_px) {
  const float apart_px = std::max(0.0F, std::abs(disparity_px - returned_px) - kPerStep_px);
  return std::max(0.0F, 1.0F - apart_px / kDisagreement_px);
}

}  // namespace rigwire::sim
