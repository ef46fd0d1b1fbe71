#include "bench/depth_image_bench.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "bench/lidar_peer.h"
#include "bench/lidar_rebase_bench.h"

namespace rigwire::bench {
namespace {

DepthImageVariant variant(const std::string& name, int width_px) {
  const auto variants = depth_image_variants(width_px);
  const auto found = std::ranges::find(variants, name, &DepthImageVariant::name);
  return found == variants.end() ? DepthImageVariant{} : *found;
}

TEST(DepthImageBench, ExactMappingIsExactOnLevelGround) {
  const auto errors = measure_depth_images(level_ground_case(), variant("exact", 256));
  ASSERT_EQ(errors.size(), 5U);
  for (const DepthImageError& error : errors) {
    EXPECT_GT(error.pixels, 3U * 256U * 120U);
    EXPECT_GT(error.shots, 45000U);
    const bool exact = error.parameters.sampling == sim::DepthSampling::bilinear_inverse_depth ||
                       error.parameters.sampling == sim::DepthSampling::tangent_plane;
    for (const RangeClassError& range : error.classes) {
      EXPECT_LE(range.rms_m, range.p999_m + 1e-9);
      if (exact) {
        EXPECT_LT(range.p999_m, 1e-4) << range.to_m;
      }
    }
  }
  EXPECT_GT(errors[0].classes[1].rms_m, 0.1) << "nearest pixel at 10 to 20 m";
}

TEST(DepthImageBench, PrintedRingsAreTrianglesAndExactOnesCircles) {
  const auto spread = [](const std::string& name) {
    sim::DepthImageParameters parameters = variant(name, 512).parameters;
    parameters.sampling = sim::DepthSampling::bilinear_inverse_depth;
    const auto rings = depth_image_rings(parameters);
    EXPECT_EQ(rings.size(), 20U);
    const auto [least, greatest] = std::ranges::minmax(rings.front().radius_m);
    return greatest / least;
  };
  EXPECT_NEAR(spread("b = W/2"), std::sqrt(2.0), 0.01);
  EXPECT_NEAR(spread("straight rows"), 2.0, 0.02);
  EXPECT_NEAR(spread("b = W/2, 4 cameras"), 1.0, 1e-5);
}

TEST(LidarRebaseBench, RawFloatsLoseWhatTheLocalOriginKeeps) {
  const auto errors = measure_rebasing({0.0, 500e3});
  ASSERT_EQ(errors.size(), 2U);
  for (const RebaseError& error : errors) {
    EXPECT_EQ(error.rebased.leaks, 0U);
    EXPECT_LT(error.rebased.worst_m, 1e-3);
  }
  EXPECT_LT(errors[0].raw.worst_m, 2e-3);
  EXPECT_GT(errors[1].raw.rms_m, 5e-3);
}

TEST(LidarPeer, SceneAndRaysAreWrittenForOthers) {
  namespace fs = std::filesystem;
  const fs::path folder =
      fs::temp_directory_path() / ("rigwire_lidar_peer_" + std::to_string(::getpid()));
  const LidarPeerFigures figures = measure_and_write_for_peers(folder, 1);
  EXPECT_EQ(figures.rays, 69440U);
  EXPECT_GT(figures.hits, 60000U);
  EXPECT_EQ(fs::file_size(folder / "rays.f64"), figures.rays * 6 * sizeof(double));
  EXPECT_EQ(fs::file_size(folder / "ranges.f32"), figures.rays * sizeof(float));
  EXPECT_GT(fs::file_size(folder / "scene.ply"), figures.triangles * 13);
  fs::remove_all(folder);
  EXPECT_THROW((void)measure_and_write_for_peers({}, 0), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::bench
