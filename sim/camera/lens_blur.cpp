#include "sim/camera/lens_blur.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace rigwire::sim {
namespace {

constexpr std::size_t kBands = 3;

/// Transfer of a mean over a pixel's width at 0.25 cycles per pixel: sin(pi / 4) / (pi / 4).
const double kPixelTransfer = std::sin(0.25 * std::numbers::pi) / (0.25 * std::numbers::pi);

}  // namespace

float neighbour_weight(double transfer, bool averaged) {
  const double left = averaged ? std::min(1.0, transfer / kPixelTransfer) : transfer;
  return static_cast<float>(0.5 * (1.0 - left));
}

void blur_row(std::span<const float> sharp, const BandGrid& grid, int left, int row, float weight,
              std::span<float> row_sum, std::span<float> blurred) {
  const std::size_t width = kBands * static_cast<std::size_t>(grid.width);
  const auto row_at = [&](int r) {
    return sharp.data() + width * static_cast<std::size_t>(std::clamp(r, 0, grid.height - 1));
  };
  const float* const above = row_at(row - 1);
  const float* const here = row_at(row);
  const float* const below = row_at(row + 1);
  const float own = 1.0F - 2.0F * weight;
  for (std::size_t i = 0; i < width; ++i) {
    row_sum[i] = own * here[i] + weight * (above[i] + below[i]);
  }
  const std::size_t first = kBands * static_cast<std::size_t>(left);
  const std::size_t last = width - kBands;
  for (std::size_t i = 0; i < blurred.size(); ++i) {
    const std::size_t at = first + i;
    const std::size_t before = at >= kBands ? at - kBands : at;
    const std::size_t after = at < last ? at + kBands : at;
    blurred[i] = own * row_sum[at] + weight * (row_sum[before] + row_sum[after]);
  }
}

}  // namespace rigwire::sim
