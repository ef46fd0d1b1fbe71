#include "sim/camera/stereo_matcher.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <tuple>

#include <cmath>

#include "sim/random.h"

namespace rigwire::sim {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 60;
constexpr std::size_t kPixels = static_cast<std::size_t>(kWidth) * kHeight;

/// Noise with a pattern of a few pixels, the right picture `shift` columns farther left.
struct Shifted {
  explicit Shifted(int shift) : left(kPixels), right(kPixels) {
    RandomStream random(5, "pattern");
    std::vector<double> wide(static_cast<std::size_t>(kWidth + 64) * kHeight);
    for (double& value : wide) {
      value = random.uniform(0.0, 255.0);
    }
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const auto value = [&](int column) {
          const std::size_t at =
              static_cast<std::size_t>(y) * (kWidth + 64) + static_cast<std::size_t>(column);
          return static_cast<std::uint8_t>((wide[at] + wide[at + 1]) / 2.0);
        };
        const std::size_t at = static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x);
        left[at] = value(x);
        right[at] = value(x + shift);
      }
    }
  }
  [[nodiscard]] StereoPair pair() const {
    StereoPair pair;
    pair.width = kWidth;
    pair.height = kHeight;
    pair.left = left;
    pair.right = right;
    return pair;
  }
  std::vector<std::uint8_t> left;
  std::vector<std::uint8_t> right;
};

TEST(StereoMatcher, AShiftedPictureHasThatDisparityEverywhere) {
  StereoMatchingParameters parameters;
  parameters.disparities = 32;
  using Case = std::tuple<int, int, MatchingPaths>;
  for (const auto& [least, shift, paths] :
       {Case{0, 1, MatchingPaths::five}, Case{0, 9, MatchingPaths::five},
        Case{0, 30, MatchingPaths::five}, Case{4, 20, MatchingPaths::five},
        Case{4, 20, MatchingPaths::three}, Case{0, 9, MatchingPaths::eight}}) {
    parameters.least_disparity = least;
    parameters.paths = paths;
    const auto matcher = make_stereo_matcher(parameters);
    const Shifted shifted(shift);
    DisparityPicture found;
    matcher->match(shifted.pair(), true, found);
    const int searched = least + 32;
    for (int y = 5; y < kHeight - 5; ++y) {
      for (int x = 0; x < kWidth - 5; ++x) {
        const std::size_t at = static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x);
        if (x < searched - 1) {
          // The search would leave the right picture.
          ASSERT_EQ(found.disparity_px[at], DisparityPicture::kNone) << x;
          ASSERT_EQ(found.confidence[at], 0);
        } else if (x > searched + 4) {
          ASSERT_NEAR(found.disparity_px[at], shift, 0.25) << x << ", " << y;
          ASSERT_GT(found.confidence[at], 200) << x << ", " << y;
        }
      }
    }
  }
}

TEST(StereoMatcher, OpenCVsThreadsDoNotChangeIt) {
  StereoMatchingParameters parameters;
  parameters.disparities = 32;
  parameters.paths = MatchingPaths::three;
  const Shifted shifted(9);
  DisparityPicture alone;
  make_stereo_matcher(parameters)->match(shifted.pair(), true, alone);
  const int before = cv::getNumThreads();
  cv::setNumThreads(7);
  DisparityPicture found;
  make_stereo_matcher(parameters)->match(shifted.pair(), true, found);
  cv::setNumThreads(before);
  EXPECT_EQ(alone.disparity_px, found.disparity_px);
  EXPECT_EQ(alone.confidence, found.confidence);
}

TEST(StereoMatcher, TheWayBackBesideTheOtherDoesNotChangeIt) {
  StereoMatchingParameters parameters;
  parameters.disparities = 32;
  const Shifted shifted(9);
  for (const MatchingPaths paths : {MatchingPaths::three, MatchingPaths::five}) {
    parameters.paths = paths;
    DisparityPicture alone;
    make_stereo_matcher(parameters, 1)->match(shifted.pair(), true, alone);
    const auto beside = make_stereo_matcher(parameters, 2);
    for (int i = 0; i < 5; ++i) {
      DisparityPicture found;
      beside->match(shifted.pair(), true, found);
      EXPECT_EQ(alone.disparity_px, found.disparity_px);
      EXPECT_EQ(alone.confidence, found.confidence);
    }
  }
}

TEST(StereoMatcher, FlatPicturesHaveNoDisparity) {
  StereoMatchingParameters parameters;
  parameters.disparities = 32;
  const auto matcher = make_stereo_matcher(parameters);
  const std::vector<std::uint8_t> flat(kPixels, 120);
  StereoPair pair;
  pair.width = kWidth;
  pair.height = kHeight;
  pair.left = flat;
  pair.right = flat;
  DisparityPicture found;
  matcher->match(pair, true, found);
  for (std::size_t i = 0; i < kPixels; ++i) {
    ASSERT_EQ(found.disparity_px[i], DisparityPicture::kNone);
    ASSERT_EQ(found.confidence[i], 0);
  }
}

TEST(StereoMatcher, TruthNeedsNoPicture) {
  StereoMatchingParameters parameters;
  parameters.method = MatchingMethod::truth;
  parameters.disparities = 32;
  const auto matcher = make_stereo_matcher(parameters);
  EXPECT_TRUE(matcher->needs_truth());
  // A step: near on the right half.
  std::vector<float> left(kPixels, 10.0F);
  std::vector<float> right(kPixels, 10.0F);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x);
      left[at] = x >= 80 ? 5.0F : 10.0F;
      right[at] = x >= 60 ? 5.0F : 10.0F;
    }
  }
  left[0] = 0.0F;
  StereoPair pair;
  pair.width = kWidth;
  pair.height = kHeight;
  pair.left_depth_m = left;
  pair.right_depth_m = right;
  pair.focal_baseline_px_m = 100.0;  // 10 pixels at 10 m, 20 at 5 m
  DisparityPicture found;
  matcher->match(pair, true, found);
  for (int x = 0; x < kWidth; ++x) {
    const bool off = x < 10;                // leaves the right picture
    const bool hidden = x >= 70 && x < 80;  // behind the near half
    const float expected = off || hidden ? DisparityPicture::kNone : x >= 80 ? 20.0F : 10.0F;
    EXPECT_EQ(found.disparity_px[static_cast<std::size_t>(x) + 5 * kWidth], expected) << x;
  }
  EXPECT_EQ(found.disparity_px[0], DisparityPicture::kNone);
}

}  // namespace
}  // namespace rigwire::sim
