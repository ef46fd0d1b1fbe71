// Our stereo matcher against OpenCV's, which searches from as many directions.
#include <gtest/gtest.h>

#include "bench/camera_kinds_bench.h"
#include "opencv_matcher.h"

namespace rigwire::bench {
namespace {

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
    EXPECT_GE(own.all.density, opencv.all.density) << scene.name();
    EXPECT_LE(own.all.median_px, opencv.all.median_px) << scene.name();
    // Where hardly any is wrong, one of a thousand more is no difference.
    EXPECT_LE(own.all.bad1, opencv.all.bad1 + 0.001) << scene.name();
  }
}

}  // namespace
}  // namespace rigwire::bench
