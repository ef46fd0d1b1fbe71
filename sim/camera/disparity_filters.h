// Filters that clean a picture of disparities after the search: a median, and removal of speckles.
//
// Pictures are row-major, `width` columns wide, in steps of disparity_steps.h with 16 bits and a
// sign. A filter keeps its working memory from one picture to the next.
//
// Results are equal, number by number, to those of OpenCV 4.6's cv::medianBlur with an aperture of
// 3 and cv::filterSpeckles (tests/sim/camera/disparity_filters_test.cpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rigwire::sim {

/// The median of the 3 by 3 pixels around each pixel. A pixel beyond the picture's edge has the
/// value of the nearest one inside.
class MedianFilter {
 public:
  /// Writes the median of `picture` to `filtered`, which has the same size and other memory.
  void apply(std::span<const std::int16_t> picture, int width, std::span<std::int16_t> filtered);

 private:
  /// The three pixels of each column, sorted, with one more column on each side.
  std::vector<std::int16_t> low_, middle_, high_;
};

/// Separates speckles from other islands. An island is a set of pixels connected by differences of
/// at most `max_difference`, each to the pixel beside, above or below it.
struct SpeckleRule {
  int max_pixels = 0;      ///< Islands of at most so many pixels are removed.
  int max_difference = 0;  ///< In the picture's steps.
  std::int16_t none = 0;   ///< Marks a pixel without a disparity; it belongs to no island.
};

/// Removes speckles. Islands are found as runs of a row that are joined with those of the row above
/// by a disjoint-set forest (R. E. Tarjan, "Efficiency of a good but not linear set union
/// algorithm", Journal of the ACM 22(2), 1975).
class SpeckleFilter {
 public:
  /// Sets each pixel of each speckle in `picture` to `rule.none`.
  void apply(std::span<std::int16_t> picture, int width, const SpeckleRule& rule);

 private:
  /// Pixels of a row that belong to one island: columns from `begin` up to before `end`.
  struct Run {
    int row = 0;
    int begin = 0;
    int end = 0;
    std::size_t parent = 0;  ///< Another run of the island, or itself if it is the root.
    int pixels = 0;          ///< Pixels of the island; only the root's number is right.
  };

  [[nodiscard]] std::size_t root_of(std::size_t run);
  void join(std::size_t one, std::size_t other);
  void add_runs(std::span<const std::int16_t> row, int index, const SpeckleRule& rule);

  std::vector<Run> runs_;
};

}  // namespace rigwire::sim
