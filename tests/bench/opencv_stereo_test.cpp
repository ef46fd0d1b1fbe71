// Our stereo matcher against OpenCV's, which searches from as many directions.
#include <gtest/gtest.h>

#include "bench/camera_kinds_bench.h"
#include "opencv_matcher.h"

namespace rigwire::bench {
namespace {

/// Share of the pixels that have no disparity or one that is off by more than a pixel: whoever
/// refuses more has fewer wrong ones.
double missing_or_wrong(const StereoCost& cost) {
  return 1.0 - cost.all.density * (1.0 - cost.all.bad1);
}

TEST(OpenCvStereo, OurErrorsAreNoLarger) {
  const sim::StereoMatchingParameters parameters;
  oracle::OpenCvMatcherParameters theirs;
  theirs.least_disparity = parameters.least_disparity;
  theirs.disparities = parameters.disparities;
  theirs.paths = oracle::OpenCvPaths::three;
  for (const CameraCase& scene : camera_cases()) {
    const StereoCost own =
        measure_matcher(scene, "census", *sim::make_stereo_matcher(parameters), parameters, 1);
    const StereoCost opencv =
        measure_matcher(scene, "OpenCV", *make_opencv_matcher(theirs), parameters, 1);
    EXPECT_GT(opencv.all.density, 0.9) << scene.name();
    EXPECT_LT(opencv.all.median_px, 0.25) << scene.name();
    EXPECT_LE(own.all.median_px, opencv.all.median_px) << scene.name();
    // One pixel of 200 more is no difference.
    EXPECT_LE(missing_or_wrong(own), missing_or_wrong(opencv) + 0.005) << scene.name();
  }
}

}  // namespace
}  // namespace rigwire::bench
