#include "bench/beam_bench.h"

#include <gtest/gtest.h>

#include <chrono>
#include <map>
#include <stdexcept>

namespace rigwire::bench {
namespace {

TEST(BeamBench, MoreSubRaysAreNearerToABeamOfAThousand) {
  std::map<int, double> wrong;
  std::map<int, double> wrong_last;
  for (const SubRayError& error : measure_sub_rays(std::chrono::milliseconds{2})) {
    EXPECT_GT(error.shots, 500U) << error.scene;
    EXPECT_GT(error.rays_per_s, 0.0);
    wrong[error.sub_rays] += error.wrong_strongest;
    wrong_last[error.sub_rays] += error.wrong_last;
  }
  ASSERT_EQ(wrong.size(), 3U);
  EXPECT_LT(wrong[5], 0.6 * wrong[1]);
  EXPECT_LT(wrong[19], 0.6 * wrong[5]);
  EXPECT_LT(wrong_last[5], wrong_last[1]);
  EXPECT_LT(wrong_last[19], wrong_last[5]);
}

TEST(BeamBench, ASectorWithoutAFiringIsRefused) {
  EXPECT_THROW((void)measure_sub_rays(Duration{0}), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::bench
