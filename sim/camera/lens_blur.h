// What lens and pixels take off the contrast of fine patterns.
//
// A pixel's value is a weighted mean of what it and its eight neighbours see: along each axis
// (a, 1 - 2 a, a). Its modulation transfer at f cycles per pixel is 1 - 2 a (1 - cos 2 pi f), so
// that the transfer m at a quarter of a cycle gives a = (1 - m) / 2. A real lens and sensor have
// half of the contrast left between 0.25 and 0.4 cycles per pixel; m = 0.72 has it at 0.39.
//
// With one ray through each pixel's middle, patterns finer than a pixel leave independent errors.
// The weighted mean takes their standard deviation down to (1 - 2 a)^2 + 2 a^2 of it: 0.56 at m =
// 0.72.
#pragma once

#include <span>

namespace rigwire::sim {

/// Minimum transfer at a quarter of a cycle; below it the highest frequency would be inverted.
inline constexpr double kLeastTransfer = 0.5;

/// The weight `a` of both neighbours for that transfer at 0.25 cycles per pixel, kLeastTransfer ..
/// 1. `averaged`: the pixel is already a mean over its own area, whose transfer is sin(x) / x.
[[nodiscard]] float neighbour_weight(double transfer, bool averaged);

/// Rows and columns of pixels, three bands each, row by row.
struct BandGrid {
  int width = 0;
  int height = 0;
};

/// Row `row` of a part of a picture: `sharp` is the picture of size `grid`, the part begins at its
/// column `left` and row 0 = `top`, and `blurred` has room for one row of it. Beyond the picture's
/// edge the pixel at the edge goes on. `row_sum` has room for three numbers per column of `grid`.
void blur_row(std::span<const float> sharp, const BandGrid& grid, int left, int row, float weight,
              std::span<float> row_sum, std::span<float> blurred);

}  // namespace rigwire::sim
