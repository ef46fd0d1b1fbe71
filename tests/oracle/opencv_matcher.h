// OpenCV's StereoSGBM behind the interface of our matchers, as the oracle of stereo matching
// (H. Hirschmueller, "Stereo processing by semiglobal matching and mutual information", IEEE PAMI
// 30(2), 2008, with the costs of S. Birchfield, C. Tomasi, IEEE PAMI 20(4), 1998).
//
// Its confidence is how well the way back agrees: the right picture is matched against the left
// one, too, from three directions in pairs of rows taken together. That is a third of the cost of
// the same search in all rows, and fewer errors are common to both ways.
#pragma once

#include <memory>

#include "sim/camera/stereo_matcher.h"

namespace rigwire::oracle {

/// Directions from which costs are summed up: 5 in one pass over the picture, 8 in two.
enum class OpenCvPaths { three, five, eight };

/// Defaults are those that OpenCV's documentation advises for grey pictures and blocks of 5 pixels:
/// P1 = 8 b^2, P2 = 32 b^2. All else is as StereoMatchingParameters has it.
struct OpenCvMatcherParameters {
  int least_disparity = 0;
  int disparities = 128;
  OpenCvPaths paths = OpenCvPaths::five;
  int block_px = 5;               ///< Side of the square that is compared, odd.
  int small_step_cost = 200;      ///< P1, of a step by one pixel between neighbours.
  int large_step_cost = 800;      ///< P2, of every larger step.
  int uniqueness_percent = 10;    ///< By which the best cost must be below the next one.
  int gradient_limit = 31;        ///< Gradients are cut off here before they are compared.
  int left_right_difference = 1;  ///< More than this between both directions: no disparity.
  int speckle_px = 100;           ///< Islands of at most so many pixels are removed; 0: none.
  int speckle_difference = 2;     ///< An island's edge is a larger step than this.
};

/// Makes a matcher that runs on the calling thread.
[[nodiscard]] std::unique_ptr<sim::StereoMatcher> make_opencv_matcher(
    const OpenCvMatcherParameters& parameters);

}  // namespace rigwire::oracle
