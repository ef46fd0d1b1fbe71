#include "sim/camera/stereo_matcher.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <span>
#include <tuple>
#include <utility>

#include "sim/camera/disparity_steps.h"
#include "sim/random.h"

namespace rigwire::sim {
namespace {

constexpr int kPairWidth = 160;
constexpr int kPairHeight = 60;
constexpr std::size_t kPairPixels = static_cast<std::size_t>(kPairWidth) * kPairHeight;

/// Noise with a pattern of a few pixels, the right picture `shift` columns farther left.
struct Shifted {
  explicit Shifted(int shift) : left(kPairPixels), right(kPairPixels) {
    RandomStream random(5, "pattern");
    std::vector<double> wide(static_cast<std::size_t>(kPairWidth + 64) * kPairHeight);
    for (double& value : wide) {
      value = random.uniform(0.0, 255.0);
    }
    for (int y = 0; y < kPairHeight; ++y) {
      for (int x = 0; x < kPairWidth; ++x) {
        const auto value = [&](int column) {
          const std::size_t at =
              static_cast<std::size_t>(y) * (kPairWidth + 64) + static_cast<std::size_t>(column);
          return static_cast<std::uint8_t>((wide[at] + wide[at + 1]) / 2.0);
        };
        const std::size_t at =
            static_cast<std::size_t>(y) * kPairWidth + static_cast<std::size_t>(x);
        left[at] = value(x);
        right[at] = value(x + shift);
      }
    }
  }
  [[nodiscard]] StereoPair pair() const {
    StereoPair pair;
    pair.width = kPairWidth;
    pair.height = kPairHeight;
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
       {Case{0, 1, MatchingPaths::three}, Case{0, 9, MatchingPaths::five},
        Case{0, 30, MatchingPaths::three}, Case{4, 20, MatchingPaths::five}}) {
    parameters.least_disparity = least;
    parameters.paths = paths;
    const auto matcher = make_stereo_matcher(parameters);
    const Shifted shifted(shift);
    DisparityPicture found;
    matcher->match(shifted.pair(), true, found);
    const int searched = least + 32;
    for (int y = 5; y < kPairHeight - 5; ++y) {
      for (int x = 0; x < kPairWidth - 5; ++x) {
        const std::size_t at =
            static_cast<std::size_t>(y) * kPairWidth + static_cast<std::size_t>(x);
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

TEST(StereoMatcher, ThreadsDoNotChangeIt) {
  StereoMatchingParameters parameters;
  parameters.disparities = 32;
  const Shifted shifted(9);
  for (const MatchingPaths paths : {MatchingPaths::three, MatchingPaths::five}) {
    parameters.paths = paths;
    DisparityPicture alone;
    make_stereo_matcher(parameters, 1)->match(shifted.pair(), true, alone);
    const auto beside = make_stereo_matcher(parameters, 3);
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
  const std::vector<std::uint8_t> flat(kPairPixels, 120);
  StereoPair pair;
  pair.width = kPairWidth;
  pair.height = kPairHeight;
  pair.left = flat;
  pair.right = flat;
  DisparityPicture found;
  make_stereo_matcher(parameters)->match(pair, true, found);
  for (std::size_t i = 0; i < kPairPixels; ++i) {
    ASSERT_EQ(found.disparity_px[i], DisparityPicture::kNone);
    ASSERT_EQ(found.confidence[i], 0);
  }
}

/// The census way by its equations, with loops that say no more than these do.
std::vector<float> plain_census(const StereoPair& pair, const StereoMatchingParameters& p) {
  const int W = pair.width;
  const int H = pair.height;
  const int D = p.disparities;
  const auto bits = [&](std::span<const std::uint8_t> picture, int x, int y) {
    const auto value = [&](int c, int r) {
      return picture[static_cast<std::size_t>(std::clamp(r, 0, H - 1) * W +
                                              std::clamp(c, 0, W - 1))];
    };
    std::vector<bool> brighter;
    for (int dy = -3; dy <= 3; ++dy) {
      for (int dx = -4; dx <= 4; ++dx) {
        if (dy > 0 || (dy == 0 && dx > 0)) {
          brighter.push_back(value(x + dx, y + dy) > value(x - dx, y - dy));
        }
      }
    }
    return brighter;
  };
  const auto at = [&](int x, int y, int d) {
    return static_cast<std::size_t>((y * W + x) * D + d);
  };
  std::vector<int> cost(static_cast<std::size_t>(W * H * D));
  std::vector<std::vector<bool>> left;
  std::vector<std::vector<bool>> right;
  for (int i = 0; i < W * H; ++i) {
    left.push_back(bits(pair.left, i % W, i / W));
    right.push_back(bits(pair.right, i % W, i / W));
  }
  for (int y = 0; y < H; ++y) {
    for (int x = 0; x < W; ++x) {
      for (int d = 0; d < D; ++d) {
        const int other = x - d - p.least_disparity;
        int differ = 31;
        if (other >= 0) {
          differ = 0;
          for (std::size_t k = 0; k < 31; ++k) {
            differ += left[static_cast<std::size_t>(y * W + x)][k] !=
                              right[static_cast<std::size_t>(y * W + other)][k]
                          ? 1
                          : 0;
          }
        }
        cost[at(x, y, d)] = differ;
      }
    }
  }
  std::vector<std::pair<int, int>> ways{{1, 0}, {-1, 0}, {0, 1}};
  if (p.paths == MatchingPaths::five) {
    ways.insert(ways.end(), {{1, 1}, {-1, 1}});
  }
  std::vector<int> sums(cost.size(), 0);
  const auto add = [&](int dx, int dy, int start, int first, int end) {
    std::vector<int> path(cost.size());
    for (int y = start; y < end; ++y) {
      for (int i = 0; i < W; ++i) {
        const int x = dx < 0 ? W - 1 - i : i;
        const bool begins = x - dx < 0 || x - dx >= W || y - dy < start;
        int least = begins ? 0 : 1000;
        for (int d = 0; !begins && d < D; ++d) {
          least = std::min(least, path[at(x - dx, y - dy, d)]);
        }
        for (int d = 0; d < D; ++d) {
          const auto before = [&](int k) {
            return k < 0 || k >= D ? 1000 : begins ? 0 : path[at(x - dx, y - dy, k)];
          };
          const int best = std::min({before(d), before(d - 1) + p.small_step_bits,
                                     before(d + 1) + p.small_step_bits, least + p.large_step_bits});
          path[at(x, y, d)] = cost[at(x, y, d)] + best - least;
          sums[at(x, y, d)] += y >= first ? path[at(x, y, d)] : 0;
        }
      }
    }
  };
  // In four strips, their paths from above 24 rows longer.
  const int rows = (H + 3) / 4;
  for (int first = 0; first < H; first += rows) {
    for (const auto& [dx, dy] : ways) {
      add(dx, dy, std::max(0, first - 24), first, std::min(H, first + rows));
    }
  }
  const auto fine = [](int before, int middle, int after) {
    const int steep = std::max(before, after) - middle;
    return steep > 0 ? (before - after) * 16 / (2 * steep) : 0;
  };
  cv::Mat steps(H, W, CV_16S);
  for (int y = 0; y < H; ++y) {
    std::vector<int> back(static_cast<std::size_t>(W), -16);
    for (int r = 0; r < W; ++r) {
      int best = -1;
      for (int d = D - 1; d >= 0; --d) {
        const int x = r + d + p.least_disparity;
        // Among equal ones the right most wins.
        if (x < W &&
            (best < 0 || sums[at(x, y, d)] < sums[at(r + best + p.least_disparity, y, best)])) {
          best = d;
        }
      }
      if (best >= 0) {
        const int x = r + best + p.least_disparity;
        const bool within = best > 0 && best < D - 1 && x + 1 < W;
        back[static_cast<std::size_t>(r)] =
            16 * (best + p.least_disparity) +
            (within ? fine(sums[at(x - 1, y, best - 1)], sums[at(x, y, best)],
                           sums[at(x + 1, y, best + 1)])
                    : 0);
      }
    }
    for (int x = 0; x < W; ++x) {
      int best = 0;
      for (int d = 1; d < D; ++d) {
        best = sums[at(x, y, d)] < sums[at(x, y, best)] ? d : best;
      }
      int next = 65535;
      for (int d = 0; d < D; ++d) {
        next = std::abs(d - best) > 1 ? std::min(next, sums[at(x, y, d)]) : next;
      }
      int found = 16 * (best + p.least_disparity);
      if (best > 0 && best < D - 1) {
        found += fine(sums[at(x, y, best - 1)], sums[at(x, y, best)], sums[at(x, y, best + 1)]);
      }
      const auto disagrees = [&](int disparity) {
        const int to = x - disparity;
        return to >= 0 && back[static_cast<std::size_t>(to)] >= 0 &&
               std::abs(back[static_cast<std::size_t>(to)] - found) >
                   16 * p.left_right_difference + 8;
      };
      const bool clear = x + 1 >= p.least_disparity + D &&
                         next * (100 - p.uniqueness_percent) > 100 * sums[at(x, y, best)];
      const bool agree = !disagrees(found / 16) || !disagrees((found + 15) / 16);
      steps.at<short>(y, x) = static_cast<short>(clear && agree ? found : -16);
    }
  }
  cv::medianBlur(steps, steps, 3);
  std::vector<float> disparity_px;
  take_steps({steps.ptr<std::int16_t>(), steps.total()}, p.least_disparity, disparity_px);
  return disparity_px;
}

TEST(StereoMatcher, TheCensusWayIsThatOfItsEquations) {
  StereoMatchingParameters parameters;
  parameters.speckle_px = 0;
  RandomStream random(9, "noise");
  Shifted shifted(9);
  // A nearer square, a darker head, noise.
  for (int y = 20; y < 40; ++y) {
    for (int x = 60; x < 100; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * kPairWidth + static_cast<std::size_t>(x);
      shifted.right[at - 14] = shifted.left[at];
    }
  }
  for (std::uint8_t& value : shifted.right) {
    value = static_cast<std::uint8_t>(0.7 * value + random.uniform(0.0, 40.0));
  }
  // Sums that reach 252 and 255, on either side of what bytes hold; disparities that do not fit.
  using enum MatchingPaths;
  for (const auto& [least, disparities, paths, large_step_bits] : {std::tuple{0, 32, three, 20},
                                                                   {0, 48, five, 20},
                                                                   {3, 16, three, 20},
                                                                   {5, 32, five, 19},
                                                                   {0, 32, three, 53},
                                                                   {0, 32, three, 54},
                                                                   {2, 32, five, 150},
                                                                   {0, 256, three, 20}}) {
    parameters.least_disparity = least;
    parameters.disparities = disparities;
    parameters.paths = paths;
    parameters.large_step_bits = large_step_bits;
    const std::vector<float> plain = plain_census(shifted.pair(), parameters);
    DisparityPicture found;
    const auto matcher = make_stereo_matcher(parameters);
    for (int again = 0; again < 2; ++again) {
      matcher->match(shifted.pair(), false, found);
      EXPECT_EQ(found.disparity_px, plain) << least << ' ' << disparities << ' ' << large_step_bits;
    }
  }
}

TEST(StereoMatcher, ABrighterHeadDoesNotChangeTheCensusWay) {
  StereoMatchingParameters parameters;
  parameters.disparities = 32;
  const Shifted shifted(9);
  DisparityPicture alike;
  make_stereo_matcher(parameters)->match(shifted.pair(), true, alike);
  Shifted brighter = shifted;
  for (std::uint8_t& value : brighter.left) {
    value = static_cast<std::uint8_t>(value / 2);
  }
  Shifted half = brighter;
  for (std::uint8_t& value : brighter.left) {
    value = static_cast<std::uint8_t>(value + 60);
  }
  DisparityPicture first;
  DisparityPicture second;
  make_stereo_matcher(parameters)->match(half.pair(), true, first);
  make_stereo_matcher(parameters)->match(brighter.pair(), true, second);
  EXPECT_EQ(first.disparity_px, second.disparity_px);
  EXPECT_EQ(first.confidence, second.confidence);
}

TEST(StereoMatcher, ADoubtfulDisparityHasLessConfidence) {
  StereoMatchingParameters parameters;
  parameters.disparities = 32;
  parameters.uniqueness_percent = 0;
  parameters.speckle_px = 0;
  RandomStream random(3, "noise");
  Shifted shifted(9);
  // In its lower half the right picture is noise.
  for (std::size_t at = kPairPixels / 2; at < kPairPixels; ++at) {
    shifted.right[at] = static_cast<std::uint8_t>(random.uniform(0.0, 200.0));
  }
  DisparityPicture found;
  make_stereo_matcher(parameters)->match(shifted.pair(), true, found);
  double clear = 0.0;
  double noisy = 0.0;
  for (int y = 5; y < kPairHeight - 5; ++y) {
    for (int x = 40; x < kPairWidth - 5; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * kPairWidth + static_cast<std::size_t>(x);
      (y < kPairHeight / 2 ? clear : noisy) += found.confidence[at];
    }
  }
  EXPECT_GT(clear, 5.0 * noisy);
}

TEST(StereoMatcher, PenaltiesThatDoNotFitAreRefused) {
  StereoMatchingParameters parameters;
  parameters.large_step_bits = parameters.small_step_bits;
  EXPECT_THROW(make_stereo_matcher(parameters), std::invalid_argument);
  parameters.large_step_bits = 151;
  EXPECT_THROW(make_stereo_matcher(parameters), std::invalid_argument);
}

TEST(StereoMatcher, TruthNeedsNoPicture) {
  StereoMatchingParameters parameters;
  parameters.method = MatchingMethod::truth;
  parameters.disparities = 32;
  const auto matcher = make_stereo_matcher(parameters);
  EXPECT_TRUE(matcher->needs_truth());
  // A step: near on the right half.
  std::vector<float> left(kPairPixels, 10.0F);
  std::vector<float> right(kPairPixels, 10.0F);
  for (int y = 0; y < kPairHeight; ++y) {
    for (int x = 0; x < kPairWidth; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * kPairWidth + static_cast<std::size_t>(x);
      left[at] = x >= 80 ? 5.0F : 10.0F;
      right[at] = x >= 60 ? 5.0F : 10.0F;
    }
  }
  left[0] = 0.0F;
  StereoPair pair;
  pair.width = kPairWidth;
  pair.height = kPairHeight;
  pair.left_depth_m = left;
  pair.right_depth_m = right;
  pair.focal_baseline_px_m = 100.0;  // 10 pixels at 10 m, 20 at 5 m
  DisparityPicture found;
  matcher->match(pair, true, found);
  for (int x = 0; x < kPairWidth; ++x) {
    const bool off = x < 10;                // leaves the right picture
    const bool hidden = x >= 70 && x < 80;  // behind the near half
    const float expected = off || hidden ? DisparityPicture::kNone : x >= 80 ? 20.0F : 10.0F;
    EXPECT_EQ(found.disparity_px[static_cast<std::size_t>(x) + 5 * kPairWidth], expected) << x;
  }
  EXPECT_EQ(found.disparity_px[0], DisparityPicture::kNone);
}

}  // namespace
}  // namespace rigwire::sim
