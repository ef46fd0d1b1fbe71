#include "sim/lidar/depth_image_lidar.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "depth_image_head.h"
#include "sim/lidar/spinning_lidar.h"

namespace rigwire::sim {
namespace {

using Eigen::Vector3d;
using std::chrono::milliseconds;

constexpr double kDepthImageLidarHeight_m = 2.5;

Material depth_image_lidar_white() {
  return {.reflectance = 0.9, .label = "white"};
}

std::vector<LidarFiring> revolution_over_level_ground(const DepthImageParameters& parameters,
                                                      const LidarPattern& head) {
  Scene scene;
  scene.add_terrain(level_ground(), depth_image_lidar_white());
  DepthImageLidar lidar(parameters, noiseless(), head, firing_plan(), turning(), 1, "lidar");
  return revolution(lidar, scene, standing(0.0, 0.0, kDepthImageLidarHeight_m));
}

/// Radii on the ground of one laser's points, by their ranges alone.
struct Ring {
  double mean_m = 0.0;
  double deviation_m = 0.0;
  double least_m = 1e9;
  double greatest_m = 0.0;
};
Ring ring(const std::vector<LidarFiring>& firings, std::size_t laser) {
  Ring found;
  double sum = 0.0;
  double squares = 0.0;
  for (const LidarFiring& firing : firings) {
    const double range = firing.strongest[laser].range_m;
    const double radius =
        std::sqrt(range * range - kDepthImageLidarHeight_m * kDepthImageLidarHeight_m);
    sum += radius;
    squares += radius * radius;
    found.least_m = std::min(found.least_m, radius);
    found.greatest_m = std::max(found.greatest_m, radius);
  }
  const auto count = static_cast<double>(firings.size());
  found.mean_m = sum / count;
  found.deviation_m = std::sqrt(std::max(0.0, squares / count - found.mean_m * found.mean_m));
  return found;
}

TEST(DepthImageLidar, RingsOnLevelGroundAreCirclesWithTheExactRules) {
  const LidarPattern head = ideal_head();
  for (const DepthSampling sampling :
       {DepthSampling::bilinear_inverse_depth, DepthSampling::tangent_plane}) {
    DepthImageParameters parameters;
    parameters.sampling = sampling;
    const auto firings = revolution_over_level_ground(parameters, head);
    ASSERT_EQ(firings.size(), 2170U);
    for (std::size_t laser = 0; laser < 16; ++laser) {
      const Ring found = ring(firings, laser);
      const double radius = kDepthImageLidarHeight_m / std::tan(-head.lasers[laser].elevation_rad);
      EXPECT_NEAR(found.mean_m / radius, 1.0, 1e-6) << laser;
      EXPECT_LT(found.deviation_m / radius, 1e-6) << laser;
    }
  }
}

TEST(DepthImageLidar, RingsAsPrintedAreTrianglesWithThreeCameras) {
  DepthImageParameters parameters = as_printed();
  parameters.width_px = 512;
  parameters.sampling = DepthSampling::bilinear_inverse_depth;
  const auto edge_over_middle = [&](int cameras) {
    parameters.cameras = cameras;
    const Ring found = ring(revolution_over_level_ground(parameters, ideal_head()), 0);
    return found.greatest_m / found.least_m;
  };
  EXPECT_NEAR(edge_over_middle(3), std::sqrt(2.0), 2e-3);
  EXPECT_NEAR(edge_over_middle(4), 1.0, 1e-3);
  // Six cameras err to the other side: the edge is nearer than the middle.
  EXPECT_NEAR(edge_over_middle(6), std::sqrt(1.5), 2e-3);
}

double rms_error_m(const DepthImageParameters& parameters, double least_m, double greatest_m) {
  const LidarPattern head = ideal_head();
  const auto firings = revolution_over_level_ground(parameters, head);
  double squares = 0.0;
  int count = 0;
  for (const LidarFiring& firing : firings) {
    for (std::size_t j = 0; j < head.lasers.size(); ++j) {
      const double truth = kDepthImageLidarHeight_m / std::sin(-head.lasers[j].elevation_rad);
      if (truth > least_m && truth < greatest_m && firing.strongest[j].range_m > 0.0F) {
        squares += std::pow(firing.strongest[j].range_m - truth, 2);
        ++count;
      }
    }
  }
  return std::sqrt(squares / count);
}

TEST(DepthImageLidar, NearestPixelErrsByTheSquareOfTheRangeOverThePixels) {
  DepthImageParameters parameters;
  parameters.cameras = 4;
  parameters.sampling = DepthSampling::nearest;
  for (const int width_px : {384, 768}) {
    parameters.width_px = width_px;
    // A row is 1/f in tan(elevation): r^2 / (h f), uniform within half a pixel either way.
    const double f_px = 0.5 * width_px;
    const double at_9_m = 9.0 * 9.0 / (kDepthImageLidarHeight_m * f_px * std::sqrt(12.0));
    const double found = rms_error_m(parameters, 8.0, 10.0);
    EXPECT_GT(found, 0.6 * at_9_m) << width_px;
    EXPECT_LT(found, 1.6 * at_9_m) << width_px;
  }
  parameters.width_px = 512;
  parameters.sampling = DepthSampling::edge_aware;
  EXPECT_LT(rms_error_m(parameters, 4.0, 20.0), 1e-4);
}

TEST(DepthImageLidar, ParallaxStepsFindWhereEachBeamLeaves) {
  LidarPattern head = real_head();
  const auto worst_error_m = [&](int steps) {
    DepthImageParameters parameters;
    parameters.parallax_steps = steps;
    const auto firings = revolution_over_level_ground(parameters, head);
    double worst = 0.0;
    for (const LidarFiring& firing : firings) {
      for (std::size_t j = 0; j < 16; ++j) {
        const LaserGeometry& laser = head.lasers[j];
        const double truth =
            (kDepthImageLidarHeight_m + laser.vertical_offset_m) / std::sin(-laser.elevation_rad);
        worst = std::max(worst, std::abs(firing.strongest[j].range_m - truth));
      }
    }
    return worst;
  };
  EXPECT_GT(worst_error_m(0), 0.03);
  EXPECT_LT(worst_error_m(2), 1e-4);
  for (LaserGeometry& laser : head.lasers) {
    laser.horizontal_offset_m = 0.026;  // Along level ground it changes nothing.
  }
  EXPECT_LT(worst_error_m(2), 1e-4);
}

TEST(DepthImageLidar, FiringsAzimuthsAndNoiseAreThoseOfTheRays) {
  Scene scene;
  scene.add_terrain(level_ground(), {.reflectance = 0.4, .label = "ground"});
  const LinkMotion mount = standing(3.0, -2.0, kDepthImageLidarHeight_m);
  const LidarPattern head = real_head();
  DepthImageParameters parameters;
  parameters.near_plane_m = 0.1;
  SpinningLidarParameters spinning;
  spinning.laser_bias_sigma_m = 0.01;
  spinning.drop_rate = 0.1;
  DepthImageLidar images(parameters, spinning, head, firing_plan(), turning(), 7, "lidar");
  SpinningLidar rays(spinning, head, firing_plan(), turning(), 7, "lidar");
  const auto found = revolution(images, scene, mount);
  const auto expected = revolution(rays, scene, mount);
  ASSERT_EQ(found.size(), expected.size());
  std::size_t only_one = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].time, expected[i].time);
    EXPECT_EQ(found[i].rotor_azimuth_rad, expected[i].rotor_azimuth_rad);
    EXPECT_EQ(found[i].rotor_rate_radps, expected[i].rotor_rate_radps);
    for (std::size_t j = 0; j < head.lasers.size(); ++j) {
      const LidarReturn& one = found[i].strongest[j];
      const LidarReturn& other = expected[i].strongest[j];
      if ((one.range_m > 0.0F) != (other.range_m > 0.0F)) {
        ++only_one;  // At the limit of reach, which is a matter of rounding.
        continue;
      }
      EXPECT_NEAR(one.range_m, other.range_m, 1e-3) << i << " " << j;
      EXPECT_NEAR(one.reflectivity, other.reflectivity, 1e-5);
    }
  }
  EXPECT_LT(only_one, 20U);
}

/// Everywhere the same: half the light comes through, and an echo as from 2 % at 3 m.
class Mist final : public Weather {
 public:
  AirPath along(const WeatherBeam& beam) const override {
    AirPath path;
    path.transmission = 0.5;
    if (beam.far_m > 3.0) {
      path.echoes[0] = {3.0, 0.02 / 9.0};
      path.echo_count = 1;
    }
    return path;
  }
  bool present() const override { return true; }
};

TEST(DepthImageLidar, MistWeakensSurfacesAndReturnsWhereTheyAreFaint) {
  Scene scene;
  scene.add_terrain(level_ground(), depth_image_lidar_white());
  scene.begin_slice(kStart, kStart + kRevolution, Vector3d::Zero(), {});
  const LinkMotion mount = standing(0.0, 0.0, kDepthImageLidarHeight_m);
  const LidarPattern head = ideal_head();
  const auto run = [&](LidarSensor& lidar) {
    std::vector<LidarFiring> firings;
    lidar.cast(scene, {kStart, kStart + kRevolution, mount, mount}, nullptr, firings, nullptr);
    const auto clear = firings.front();
    lidar.command(kStart + kRevolution, turning());
    scene.begin_slice(kStart + kRevolution, kStart + 2 * kRevolution, Vector3d::Zero(), {});
    const Mist mist;
    lidar.cast(scene, {kStart + kRevolution, kStart + 2 * kRevolution, mount, mount}, &mist,
               firings, nullptr);
    return std::pair(clear, firings.front());
  };
  DepthImageLidar images({}, noiseless(), head, firing_plan(), turning(), 1, "lidar");
  const auto [clear, misty] = run(images);
  EXPECT_NEAR(misty.strongest[0].range_m, clear.strongest[0].range_m, 1e-4);
  EXPECT_NEAR(misty.strongest[0].reflectivity, 0.5 * clear.strongest[0].reflectivity, 1e-4);
  EXPECT_EQ(misty.strongest[31].range_m, 3.0F);  // Sky.
  EXPECT_NEAR(misty.strongest[31].reflectivity, 0.02, 1e-5);
  EXPECT_EQ(clear.strongest[31].range_m, 0.0F);
}

TEST(DepthImageLidar, NeitherThreadsNorSlicesChangeAnything) {
  Scene scene;
  scene.add_terrain(level_ground(), depth_image_lidar_white());
  const LinkMotion mount = standing(0.0, 0.0, kDepthImageLidarHeight_m);
  const auto run = [&](int threads, int slice_ms) {
    DepthImageParameters parameters;
    SpinningLidarParameters receiver;
    receiver.threads = threads;
    parameters.width_px = 256;
    parameters.images_per_revolution = 5;
    DepthImageLidar lidar(parameters, receiver, real_head(), firing_plan(), turning(), 7, "lidar");
    std::vector<LidarFiring> all;
    std::vector<LidarFiring> part;
    for (int ms = 0; ms < 40; ms += slice_ms) {
      const SimTime t0 = kStart + milliseconds{ms};
      const SimTime t1 = t0 + milliseconds{slice_ms};
      scene.begin_slice(t0, t1, Vector3d::Zero(), {});
      lidar.cast(scene, {t0, t1, mount, mount}, nullptr, part, nullptr);
      all.insert(all.end(), part.begin(), part.end());
    }
    return all;
  };
  const auto expected = run(1, 40);
  for (const auto& other : {run(3, 40), run(1, 5), run(2, 8)}) {
    ASSERT_EQ(other.size(), expected.size());
    for (std::size_t i = 0; i < other.size(); ++i) {
      EXPECT_EQ(other[i].strongest, expected[i].strongest) << i;
    }
  }
}

TEST(DepthImageLidar, AStandingRotorStillSeesTheWorldMove) {
  Scene scene;
  const auto mesh = scene.add_mesh(make_box("boom", {1.0, 40.0, 40.0}));
  const auto body = scene.add_body("boom");
  scene.add_body_part(body, mesh, Eigen::Isometry3d::Identity(), depth_image_lidar_white());
  DepthImageParameters parameters;
  parameters.width_px = 64;
  DepthImageLidar lidar(parameters, noiseless(), ideal_head(), firing_plan(), turning(0.0), 1,
                        "lidar");
  std::vector<LidarFiring> firings;
  const LinkMotion mount = standing(0.0, 0.0, 0.0);
  float last = 0.0F;
  for (int ms = 0; ms < 400; ms += 100) {
    BodyMotion motion;
    motion.X_WB_start.translation() << 5.5 + 0.01 * ms, 0.0, 0.0;
    motion.X_WB_end = motion.X_WB_start;
    const SimTime t0 = kStart + milliseconds{ms};
    scene.begin_slice(t0, t0 + milliseconds{100}, Vector3d::Zero(), std::vector{motion});
    lidar.cast(scene, {t0, t0 + milliseconds{100}, mount, mount}, nullptr, firings, nullptr);
    last = firings.back().strongest[23].range_m;  // 0 degrees
  }
  EXPECT_NEAR(last, 7.0, 0.01);  // Rendered 250 ms after the first image.
}

TEST(DepthImageLidar, AnotherRevolutionIsAnotherImageThoughTheViewSkipsForward) {
  Scene scene;
  scene.add_terrain(level_ground(), depth_image_lidar_white());
  LidarCommand command = turning();
  command.view_start_rad = 0.25 * kTurn;
  command.view_end_rad = 0.75 * kTurn;
  DepthImageParameters parameters;
  parameters.width_px = 64;
  DepthImageLidar lidar(parameters, noiseless(), ideal_head(), firing_plan(), command, 1, "lidar");
  std::vector<LidarFiring> firings;
  const LinkMotion mount = standing(0.0, 0.0, kDepthImageLidarHeight_m);
  std::uint64_t first = 0;
  for (int i = 0; i < 2; ++i) {
    const SimTime t0 = kStart + i * kRevolution;
    scene.begin_slice(t0, t0 + kRevolution, Vector3d::Zero(), {});
    lidar.cast(scene, {t0, t0 + kRevolution, mount, mount}, nullptr, firings, nullptr);
    first = i == 0 ? lidar.rays() : first;
    for (const LidarFiring& firing : firings) {
      const double turns = firing.rotor_azimuth_rad / kTurn;
      EXPECT_EQ(firing.strongest[0].range_m > 0.0F, turns >= 0.25 && turns < 0.75) << turns;
    }
  }
  EXPECT_EQ(lidar.rays(), 2 * first);
  command.laser_on = false;
  lidar.command(kStart + 2 * kRevolution, command);
  const SimTime t0 = kStart + 2 * kRevolution;
  scene.begin_slice(t0, t0 + kRevolution, Vector3d::Zero(), {});
  lidar.cast(scene, {t0, t0 + kRevolution, mount, mount}, nullptr, firings, nullptr);
  EXPECT_FALSE(firings.empty());
  EXPECT_TRUE(std::ranges::all_of(
      firings, [](const LidarFiring& firing) { return firing.strongest == BankReturns{}; }));
  EXPECT_EQ(lidar.rays(), 2 * first);
}

TEST(DepthImageLidar, AHeadOfSixtyFourLasersFiresTwoBanks) {
  LidarPattern head = ideal_head();
  for (int i = 0; i < 32; ++i) {
    head.lasers.push_back(
        {.elevation_rad = (-30.0 + 0.5 * i) * kTurn / 360.0, .azimuth_offset_rad = 0.07});
  }
  DepthImageParameters parameters;
  parameters.images_per_revolution = 6;
  const auto firings = revolution_over_level_ground(parameters, head);
  ASSERT_EQ(firings.size(), 2U * 2170U);
  for (std::size_t i = 0; i < firings.size(); i += 2) {
    EXPECT_EQ(firings[i].first_laser, 0U);
    EXPECT_EQ(firings[i + 1].first_laser, 32U);
    EXPECT_EQ(firings[i].time, firings[i + 1].time);
    for (std::size_t j = 0; j < 32; ++j) {
      const double truth = kDepthImageLidarHeight_m / std::sin(-head.lasers[32 + j].elevation_rad);
      EXPECT_NEAR(firings[i + 1].strongest[j].range_m, truth, 1e-4);
    }
  }
}

TEST(DepthImageLidar, RefusesAPatternThatItCannotFire) {
  EXPECT_THROW(DepthImageLidar({}, {}, ideal_head(), SamplePlan{}, turning(), 1, "lidar"),
               std::invalid_argument);
  LidarPattern blind = ideal_head();
  blind.maximum_range_m = blind.minimum_range_m;
  EXPECT_THROW(DepthImageLidar({}, {}, blind, firing_plan(), turning(), 1, "lidar"),
               std::invalid_argument);
  SpinningLidarParameters wide;
  wide.sub_rays = 5;
  EXPECT_THROW(DepthImageLidar({}, wide, ideal_head(), firing_plan(), turning(), 1, "lidar"),
               std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
