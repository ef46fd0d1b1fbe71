#include "sim/camera/lens_blur.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace rigwire::sim {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 40;

std::vector<float> blurred(const std::vector<float>& sharp, float weight) {
  std::vector<float> result(sharp.size());
  std::vector<float> row_sum(3 * kWidth);
  for (int row = 0; row < kHeight; ++row) {
    blur_row(sharp, {kWidth, kHeight}, 0, row, weight, row_sum,
             std::span(result).subspan(3U * kWidth * static_cast<std::size_t>(row), 3U * kWidth));
  }
  return result;
}

/// Amplitude that is left of waves across and down the picture, away from its edges.
double transfer(double cycles_per_pixel, bool down, float weight) {
  std::vector<float> sharp(3U * kWidth * kHeight);
  const auto at = [](int row, int column) {
    return 3U * (static_cast<std::size_t>(row) * kWidth + static_cast<std::size_t>(column));
  };
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      const double phase = 2.0 * std::numbers::pi * cycles_per_pixel * (down ? row : column);
      for (std::size_t band = 0; band < 3; ++band) {
        sharp[at(row, column) + band] =
            static_cast<float>(std::cos(phase)) * static_cast<float>(band + 1);
      }
    }
  }
  const std::vector<float> seen = blurred(sharp, weight);
  double product = 0.0;
  double square = 0.0;
  for (int row = 4; row < 36; ++row) {
    for (int column = 4; column < 60; ++column) {
      product += static_cast<double>(seen[at(row, column) + 2] * sharp[at(row, column) + 2]);
      square += static_cast<double>(sharp[at(row, column) + 2] * sharp[at(row, column) + 2]);
    }
  }
  return product / square;
}

TEST(LensBlur, LeavesOfWavesWhatItsTransferSays) {
  for (const double mtf : {0.5, 0.72, 0.9}) {
    const float weight = neighbour_weight(mtf, false);
    for (const bool down : {false, true}) {
      EXPECT_NEAR(transfer(0.25, down, weight), mtf, 1e-5);
      EXPECT_NEAR(transfer(0.125, down, weight), 1.0 - (1.0 - mtf) * (1.0 - std::sqrt(0.5)), 1e-5);
      EXPECT_NEAR(transfer(0.5, down, weight), 2.0 * mtf - 1.0, 1e-5);
    }
  }
}

TEST(LensBlur, APixelThatIsAMeanOfItsAreaIsBlurredLess) {
  // sin(x) / x at a quarter of a cycle is 0.9003.
  EXPECT_NEAR(1.0 - 2.0 * static_cast<double>(neighbour_weight(0.72, true)), 0.72 / 0.9003, 1e-4);
  EXPECT_EQ(neighbour_weight(1.0, false), 0.0F);
  EXPECT_EQ(neighbour_weight(0.95, true), 0.0F);
}

TEST(LensBlur, KeepsEvenLightToTheEdgeAndTheSumOfAPoint) {
  std::vector<float> sharp(3U * kWidth * kHeight, 7.0F);
  for (const float number : blurred(sharp, 0.2F)) {
    EXPECT_FLOAT_EQ(number, 7.0F);
  }
  std::ranges::fill(sharp, 0.0F);
  sharp[3U * (20U * kWidth + 30U) + 1U] = 1.0F;
  double sum = 0.0;
  for (const float number : blurred(sharp, 0.2F)) {
    sum += static_cast<double>(number);
  }
  EXPECT_NEAR(sum, 1.0, 1e-6);
}

}  // namespace
}  // namespace rigwire::sim
