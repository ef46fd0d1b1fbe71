// Semi-global matching by OpenCV; the one place that knows it. See stereo_matcher.h.
#pragma once

#include <memory>

#include "sim/camera/stereo_matcher.h"

namespace rigwire::sim {

/// `parameters` are valid.
[[nodiscard]] std::unique_ptr<StereoMatcher> make_semi_global_matcher(
    const StereoMatchingParameters& parameters, int threads);

}  // namespace rigwire::sim
