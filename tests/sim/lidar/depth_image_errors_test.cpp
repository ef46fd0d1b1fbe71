// What depth images get wrong by their nature: motion, and points between two surfaces.
#include <gtest/gtest.h>

#include <algorithm>

#include "depth_image_head.h"
#include "sim/lidar/depth_image_lidar.h"

namespace rigwire::sim {
namespace {

using Eigen::Vector3d;
using std::chrono::milliseconds;

constexpr double kHeight_m = 2.5;

Material white() {
  return {.reflectance = 0.9, .label = "white"};
}

/// Greatest range error at a wall that the sensor drives towards, truth at each shot's instant.
struct MotionError {
  double worst_m = 0.0;
  double worst_told_m = 0.0;  ///< Greatest error of the truth output.
  std::uint64_t pixels = 0;
};
MotionError error_while_moving(int images_per_revolution) {
  constexpr double kSpeed_mps = 5.0;
  Scene scene;
  const auto wall = scene.add_mesh(make_box("wall", {1.0, 4000.0, 4000.0}));
  for (const double x : {-20.5, 20.5}) {
    Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
    X_WM.translation() << x, 0.0, 0.0;
    scene.add_object(wall, X_WM, 1.0, white());
  }
  LidarPattern head = ideal_head();
  DepthImageParameters parameters;
  parameters.width_px = 256;
  parameters.images_per_revolution = images_per_revolution;
  DepthImageLidar lidar(parameters, noiseless(), head, firing_plan(), turning(), 1, "lidar");
  MotionError error;
  std::vector<LidarFiring> firings;
  std::vector<LidarBankTruth> truth;
  for (int ms = 0; ms < 100; ms += 5) {
    const SimTime t0 = kStart + milliseconds{ms};
    const SimTime t1 = t0 + milliseconds{5};
    LinkMotion before = standing(kSpeed_mps * to_seconds(t0), 0.0, 0.0);
    before.v_WL_W << kSpeed_mps, 0.0, 0.0;
    LinkMotion after = before;
    after.X_WL.translation().x() = kSpeed_mps * to_seconds(t1);
    scene.begin_slice(t0, t1, Vector3d::Zero(), {});
    lidar.cast(scene, {t0, t1, before, after}, nullptr, firings, &truth);
    EXPECT_EQ(truth.size(), firings.size());
    for (std::size_t i = 0; i < firings.size(); ++i) {
      const LidarFiring& firing = firings[i];
      for (std::size_t j = 0; j < head.lasers.size(); ++j) {
        const double along =
            std::cos(head.lasers[j].elevation_rad) * std::cos(firing.rotor_azimuth_rad);
        const double distance = 20.0 - std::copysign(kSpeed_mps, along) * to_seconds(firing.time);
        if (std::abs(along) < 0.5) {
          continue;
        }
        const double expected = distance / std::abs(along);
        // What is missing along the direction of travel.
        error.worst_m = std::max(
            error.worst_m, std::abs(firing.strongest[j].range_m - expected) * std::abs(along));
        error.worst_told_m = std::max(error.worst_told_m, std::abs(truth[i][j].range_m - expected));
        EXPECT_EQ(truth[i][j].instance, along > 0.0 ? 1U : 0U);
        EXPECT_NEAR(truth[i][j].cosine_of_incidence, std::abs(along), 1e-5);
      }
    }
  }
  error.pixels = lidar.rays();
  return error;
}

TEST(DepthImageErrors, MissesTheMotionSinceItsImage) {
  const MotionError one = error_while_moving(1);
  EXPECT_NEAR(one.worst_m, 0.5, 0.01);  // 5 m/s for 100 ms
  EXPECT_LT(one.worst_told_m, 1e-4);
  const MotionError ten = error_while_moving(10);
  EXPECT_NEAR(ten.worst_m, 0.05, 0.01);
  // Both render the same columns, once each; ten images add a margin at the parts' ends.
  EXPECT_GE(ten.pixels, one.pixels);
  EXPECT_LT(static_cast<double>(ten.pixels), 1.3 * static_cast<double>(one.pixels));
}

/// Points farther than 0.3 m from ground, post and wall.
int ghosts(DepthSampling sampling) {
  Scene scene;
  scene.add_terrain(level_ground(), white());
  const auto wall = scene.add_mesh(make_box("wall", {1.0, 60.0, 20.0}));
  const auto post = scene.add_mesh(make_box("post", {0.2, 1.0, 6.0}));
  Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
  X_WM.translation() << 20.5, 0.0, 10.0;
  scene.add_object(wall, X_WM, 1.0, white());
  for (int i = -5; i <= 5; ++i) {
    X_WM.translation() << 8.1, 2.2 * i, 3.0;
    scene.add_object(post, X_WM, 1.0, white());
  }
  DepthImageParameters parameters;
  parameters.sampling = sampling;
  parameters.cameras = 4;
  parameters.width_px = 640;
  const LidarPattern head = ideal_head();
  DepthImageLidar lidar(parameters, noiseless(), head, firing_plan(), turning(), 1, "lidar");
  int count = 0;
  for (const LidarFiring& firing : revolution(lidar, scene, standing(0.0, 0.0, kHeight_m))) {
    const double a = firing.rotor_azimuth_rad;
    for (std::size_t j = 0; j < head.lasers.size(); ++j) {
      const double w = head.lasers[j].elevation_rad;
      const double range = firing.strongest[j].range_m;
      if (range == 0.0) {
        continue;
      }
      const double x = range * std::cos(w) * std::cos(a);
      const double z = kHeight_m + range * std::sin(w);
      const double off_ground = std::abs(z);
      const double off_wall = std::abs(x - 20.0);
      const double off_posts = std::max(0.0, std::abs(x - 8.1) - 0.1);
      count += std::min({off_ground, off_wall, off_posts}) > 0.3 ? 1 : 0;
    }
  }
  return count;
}

TEST(DepthImageErrors, InterpolationAcrossSilhouettesMakesPointsInMidAir) {
  EXPECT_GT(ghosts(DepthSampling::bilinear_depth), 50);
  EXPECT_GT(ghosts(DepthSampling::bilinear_inverse_depth), 50);
  EXPECT_EQ(ghosts(DepthSampling::nearest), 0);
  EXPECT_EQ(ghosts(DepthSampling::edge_aware), 0);
  EXPECT_EQ(ghosts(DepthSampling::tangent_plane), 0);
}

}  // namespace
}  // namespace rigwire::sim
