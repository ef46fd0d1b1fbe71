// Our filters against OpenCV's, number by number.
#include "sim/camera/disparity_filters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "sim/random.h"

namespace rigwire::sim {
namespace {

constexpr std::int16_t kNoStep = -16;

struct StepPicture {
  int width = 0;
  int height = 0;
  std::vector<std::int16_t> steps;
};

/// Returns a picture with value(x, y) at each pixel.
template <class Value>
StepPicture step_picture(int width, int height, const Value& value) {
  StepPicture picture{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      picture.steps.push_back(static_cast<std::int16_t>(value(x, y)));
    }
  }
  return picture;
}

/// Sizes at and around the border rules and the width of vector registers.
constexpr std::array<std::pair<int, int>, 15> kPictureSizes{{{1, 1},
                                                             {1, 2},
                                                             {2, 1},
                                                             {1, 40},
                                                             {40, 1},
                                                             {2, 2},
                                                             {2, 33},
                                                             {33, 2},
                                                             {3, 3},
                                                             {15, 4},
                                                             {16, 5},
                                                             {17, 6},
                                                             {31, 9},
                                                             {64, 20},
                                                             {131, 67}}};

/// Pictures of one size: random, steep, flat, none at all, lines, and surfaces with holes.
std::vector<StepPicture> step_pictures(int width, int height) {
  RandomStream random(7, "disparities " + std::to_string(width) + " " + std::to_string(height));
  const auto uniform = [&random](double from, double to) {
    return static_cast<int>(random.uniform(from, to));
  };
  return {
      step_picture(width, height, [&](int, int) { return uniform(-32768.0, 32767.9); }),
      step_picture(width, height,
                   [&](int, int) { return uniform(0.0, 2.0) == 0 ? -32768 : 32767; }),
      step_picture(width, height, [&](int, int) { return uniform(0.0, 64.0); }),
      step_picture(
          width, height,
          [&](int, int) { return uniform(0.0, 3.0) == 0 ? kNoStep : uniform(100.0, 180.0); }),
      step_picture(width, height,
                   [&](int x, int y) {
                     return uniform(0.0, 9.0) == 0 ? kNoStep : 400 * (x / 7) + 300 * (y / 5);
                   }),
      step_picture(width, height, [&](int x, int y) { return 33 * x + 31 * y; }),
      step_picture(width, height, [](int, int) { return 240; }),
      step_picture(width, height, [](int, int) { return kNoStep; }),
      step_picture(width, height, [](int x, int) { return x % 2 == 0 ? 240 : kNoStep; }),
      step_picture(width, height, [](int, int y) { return y % 2 == 0 ? 240 : kNoStep; }),
      step_picture(width, height, [](int x, int y) { return (x + y) % 2 == 0 ? 240 : kNoStep; }),
      // A spiral of arms one pixel wide, and a comb that joins its teeth only in the last row.
      step_picture(width, height,
                   [&](int x, int y) {
                     const int ring = std::min({x, y, width - 1 - x, height - 1 - y});
                     return ring % 2 == 0 || (x == ring && y == ring + 1) ? 240 : kNoStep;
                   }),
      step_picture(width, height,
                   [&](int x, int y) { return x % 2 == 0 || y == height - 1 ? 240 : kNoStep; }),
  };
}

cv::Mat step_matrix(StepPicture& picture) {
  return {picture.height, picture.width, CV_16S, picture.steps.data()};
}

TEST(DisparityFilters, MedianIsOpenCvs) {
  MedianFilter filter;
  for (const auto& [width, height] : kPictureSizes) {
    const std::vector<StepPicture> pictures = step_pictures(width, height);
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      StepPicture expected = pictures[i];
      cv::Mat matrix = step_matrix(expected);
      cv::medianBlur(matrix, matrix, 3);
      std::vector<std::int16_t> found(expected.steps.size());
      filter.apply(pictures[i].steps, width, found);
      ASSERT_EQ(found, expected.steps) << width << " x " << height << ", picture " << i;
    }
  }
}

TEST(DisparityFilters, SpecklesAreOpenCvs) {
  SpeckleFilter filter;
  for (const auto& [width, height] : kPictureSizes) {
    const std::vector<StepPicture> pictures = step_pictures(width, height);
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      for (const int max_pixels : {0, 1, 2, 3, 10, 100, width * height - 1, width * height}) {
        for (const int max_difference : {0, 1, 16, 32, 33, 1024, 65535}) {
          StepPicture expected = pictures[i];
          cv::Mat matrix = step_matrix(expected);
          cv::filterSpeckles(matrix, kNoStep, max_pixels, max_difference);
          StepPicture found = pictures[i];
          filter.apply(found.steps, width, {max_pixels, max_difference, kNoStep});
          ASSERT_EQ(found.steps, expected.steps)
              << width << " x " << height << ", picture " << i << ", islands up to " << max_pixels
              << " pixels within " << max_difference;
        }
      }
    }
  }
}

/// The number of pixels with a disparity.
int pixels_left(const StepPicture& picture) {
  return static_cast<int>(
      std::ranges::count_if(picture.steps, [](std::int16_t step) { return step != kNoStep; }));
}

TEST(DisparityFilters, AnIslandAtTheLimitIsRemovedAndALargerOneStays) {
  SpeckleFilter filter;
  // Two islands that touch at a corner only: 12 and 13 pixels.
  const StepPicture islands = step_picture(20, 20, [](int x, int y) {
    const bool square = x >= 2 && x < 6 && y >= 3 && y < 6;
    const bool line = x >= 6 && x < 19 && y == 6;
    return square ? 200 : line ? 201 : kNoStep;
  });
  for (const auto& [max_pixels, left] : {std::pair{11, 25}, std::pair{12, 13}, std::pair{13, 0}}) {
    StepPicture filtered = islands;
    filter.apply(filtered.steps, 20, {max_pixels, 5, kNoStep});
    EXPECT_EQ(pixels_left(filtered), left) << max_pixels;
  }
  // A difference at the limit joins, one above it parts.
  const StepPicture slope = step_picture(10, 4, [](int x, int) { return 100 + 16 * x; });
  for (const auto& [max_difference, left] : {std::pair{16, 40}, std::pair{15, 0}}) {
    StepPicture filtered = slope;
    filter.apply(filtered.steps, 10, {4, max_difference, kNoStep});
    EXPECT_EQ(pixels_left(filtered), left) << max_difference;
  }
}

TEST(DisparityFilters, AnEmptyPictureStaysEmpty) {
  std::vector<std::int16_t> none;
  MedianFilter().apply(none, 0, none);
  SpeckleFilter().apply(none, 0, {10, 10, kNoStep});
  EXPECT_TRUE(none.empty());
}

}  // namespace
}  // namespace rigwire::sim
