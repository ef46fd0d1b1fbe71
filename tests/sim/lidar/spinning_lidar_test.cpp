#include "sim/lidar/spinning_lidar.h"
#include "fields/constants.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "rough_surface.h"
#include "sim/lidar/counter_noise.h"
#include "sim/lidar/ray_lanes.h"
#include "sim/scene/scene_description.h"

namespace rigwire::sim {
namespace {

using Eigen::Vector3d;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr double kSpinningLidarRate = 10.0 * kTurn;

LidarPattern spinning_lidar_pattern() {
  LidarPattern result;
  for (int i = 0; i < 32; ++i) {
    result.lasers.push_back({.elevation_rad = (-30.67 + 4.0 / 3.0 * ((i * 7) % 32)) * kTurn / 360.0,
                             .vertical_offset_m = 0.017 - 0.0007 * ((i * 7) % 32),
                             .time_offset = nanoseconds{1152 * i}});
  }
  result.firing_period = nanoseconds{46080};
  result.minimum_range_m = 1.0;
  result.maximum_range_m = 100.0;
  return result;
}

SamplePlan plan() {
  return {kStart + nanoseconds{46080}, nanoseconds{46080}};
}

LidarCommand spinning_lidar_turning(double rate_radps = kSpinningLidarRate) {
  LidarCommand command;
  command.rotor_rate_radps = rate_radps;
  return command;
}

SpinningLidarParameters exact() {
  SpinningLidarParameters parameters;
  parameters.range_sigma_m = 0.0;
  return parameters;
}

LinkMotion spinning_lidar_still(double x, double y, double z) {
  LinkMotion motion;
  motion.X_WL.translation() << x, y, z;
  return motion;
}

HeightField flat(double height) {
  HeightField field;
  field.cell_m = 1.0;
  field.columns = 401;
  field.rows = 401;
  field.origin_m = {-200.0, -200.0};
  field.heights_m.assign(field.columns * field.rows, height);
  return field;
}

/// The ray of one shot by the definition, in double.
struct SpinningLidarShot {
  Vector3d start_S;
  Vector3d direction_S;
};
SpinningLidarShot shot(const LidarPattern& head, std::size_t laser, SimTime firing) {
  const double time = to_seconds(firing + head.lasers[laser].time_offset);
  const double a = kSpinningLidarRate * time;
  const double w = head.lasers[laser].elevation_rad;
  return {{0.0, 0.0, head.lasers[laser].vertical_offset_m},
          {std::cos(w) * std::cos(a), -std::cos(w) * std::sin(a), std::sin(w)}};
}

Material spinning_lidar_white() {
  return {.reflectance = 0.9, .label = "white"};
}

TEST(SpinningLidar, FiringsFollowThePlanWhateverTheSlices) {
  Scene scene;
  scene.add_terrain(flat(0.0), spinning_lidar_white());
  SpinningLidar whole(exact(), spinning_lidar_pattern(), plan(), spinning_lidar_turning(), 1,
                      "lidar");
  SpinningLidar sliced(exact(), spinning_lidar_pattern(), plan(), spinning_lidar_turning(), 1,
                       "lidar");
  const LinkMotion mount = spinning_lidar_still(0.0, 0.0, 3.0);
  const SimTime end = kStart + milliseconds{20};
  std::vector<LidarFiring> expected;
  scene.begin_slice(kStart, end, Vector3d::Zero(), {});
  whole.cast(scene, {kStart, end, mount, mount}, nullptr, expected, nullptr);
  ASSERT_EQ(expected.size(), 434U);  // floor(20 ms / 46.08 us)
  std::vector<LidarFiring> all;
  std::vector<LidarFiring> part;
  for (int ms = 0; ms < 20; ++ms) {
    const SimTime t0 = kStart + milliseconds{ms};
    scene.begin_slice(t0, t0 + milliseconds{1}, Vector3d::Zero(), {});
    sliced.cast(scene, {t0, t0 + milliseconds{1}, mount, mount}, nullptr, part, nullptr);
    all.insert(all.end(), part.begin(), part.end());
  }
  ASSERT_EQ(all.size(), expected.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].time, kStart + nanoseconds{46080} * (static_cast<int>(i) + 1));
    EXPECT_EQ(all[i].time, expected[i].time);
    EXPECT_EQ(all[i].rotor_azimuth_rad, expected[i].rotor_azimuth_rad);
    for (std::size_t j = 0; j < 32; ++j) {
      EXPECT_NEAR(all[i].strongest[j].range_m, expected[i].strongest[j].range_m, 1e-4F);
    }
  }
}

TEST(SpinningLidar, EveryLaserMeetsThePlaneOfItsOwnInstantFromAMovingTurningSensor) {
  Scene scene;
  scene.add_terrain(flat(0.0), spinning_lidar_white());
  const auto wall = scene.add_mesh(make_box("wall", {0.2, 400.0, 40.0}));
  Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
  X_WM.translation() << 20.1, 0.0, 0.0;
  scene.add_object(wall, X_WM, 1.0, spinning_lidar_white());
  const SimTime t0 = kStart + milliseconds{100};
  const SimTime t1 = kStart + milliseconds{110};
  const Vector3d velocity(3.0, -5.0, 0.4);
  const double yaw_rate = 1.05;
  LinkMotion a = spinning_lidar_still(0.0, 0.0, 3.0);
  a.v_WL_W = velocity;
  a.w_WL_W = {0.0, 0.0, yaw_rate};
  LinkMotion b = a;
  b.X_WL.translation() += 0.01 * velocity;
  b.X_WL.linear() = Eigen::AngleAxisd(0.01 * yaw_rate, Vector3d::UnitZ()).toRotationMatrix();
  scene.begin_slice(t0, t1, Vector3d::Zero(), {});
  const LidarPattern head = spinning_lidar_pattern();
  SpinningLidar lidar(exact(), head, plan(), spinning_lidar_turning(), 1, "lidar");
  std::vector<LidarFiring> firings;
  lidar.cast(scene, {t0, t1, a, b}, nullptr, firings, nullptr);
  ASSERT_GT(firings.size(), 200U);
  double worst = 0.0;
  std::size_t compared = 0;
  for (const LidarFiring& firing : firings) {
    for (std::size_t j = 0; j < head.lasers.size(); ++j) {
      const double age = to_seconds(firing.time + head.lasers[j].time_offset - t0);
      const Eigen::Matrix3d R_WS =
          Eigen::AngleAxisd(yaw_rate * age, Vector3d::UnitZ()).toRotationMatrix();
      const SpinningLidarShot ray = shot(head, j, firing.time);
      const Vector3d p = Vector3d(0.0, 0.0, 3.0) + age * velocity + R_WS * ray.start_S;
      const Vector3d d = R_WS * ray.direction_S;
      double truth = std::numeric_limits<double>::infinity();
      if (d.z() < 0.0) {
        truth = -p.z() / d.z();
      }
      if (d.x() > 0.0) {
        const double to_wall = (20.0 - p.x()) / d.x();
        if (p.z() + to_wall * d.z() < 20.0) {
          truth = std::min(truth, to_wall);
        }
      }
      if (truth > 60.0) {
        continue;  // too faint at grazing incidence, or sky
      }
      ASSERT_GT(firing.strongest[j].range_m, 0.0F) << "laser " << j << " expected " << truth;
      worst = std::max(worst, std::abs(firing.strongest[j].range_m - truth));
      ++compared;
    }
  }
  EXPECT_GT(compared, 5000U);
  EXPECT_LT(worst, 0.5e-3);
}

TEST(SpinningLidar, SeesTheMachinesOwnLinkWhereItIsAtTheShot) {
  Scene scene;
  const auto mesh = scene.add_mesh(make_box("boom", {1.0, 40.0, 40.0}));
  const auto body = scene.add_body("boom");
  scene.add_body_part(body, mesh, Eigen::Isometry3d::Identity(), spinning_lidar_white());
  const SimTime t0 = kStart;
  const SimTime t1 = kStart + milliseconds{5};
  BodyMotion motion;
  motion.X_WB_start.translation() << 4.5, 0.0, 0.0;
  motion.X_WB_end.translation() << 5.5, 0.0, 0.0;
  scene.begin_slice(t0, t1, Vector3d::Zero(), std::vector{motion});
  const LidarPattern head = spinning_lidar_pattern();
  SpinningLidar lidar(exact(), head, plan(), spinning_lidar_turning(), 1, "lidar");
  std::vector<LidarFiring> firings;
  const LinkMotion mount = spinning_lidar_still(0.0, 0.0, 0.0);
  lidar.cast(scene, {t0, t1, mount, mount}, nullptr, firings, nullptr);
  for (const LidarFiring& firing : firings) {
    for (std::size_t j = 0; j < head.lasers.size(); ++j) {
      const double share = to_seconds(firing.time + head.lasers[j].time_offset - t0) / 5e-3;
      const SpinningLidarShot ray = shot(head, j, firing.time);
      const double truth = (4.0 + std::min(share, 1.0)) / ray.direction_S.x();
      ASSERT_NEAR(firing.strongest[j].range_m, truth, 1e-3) << "laser " << j;
    }
  }
  lidar.cast(scene, {t0, t1, mount, mount, ~Scene::body_mask(body)}, nullptr, firings, nullptr);
  EXPECT_EQ(firings.front().strongest[0].range_m, 0.0F);
}

TEST(SpinningLidar, FaintSurfacesVanishAtTheirOwnRange) {
  const auto range_of = [](double reflectance, double distance) {
    Scene scene;
    const auto wall = scene.add_mesh(make_box("wall", {1.0, 60.0, 60.0}));
    Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
    X_WM.translation() << distance + 0.5, 0.0, 0.0;
    scene.add_object(wall, X_WM, 1.0, {.reflectance = reflectance, .label = "wall"});
    const SimTime t1 = kStart + milliseconds{1};
    scene.begin_slice(kStart, t1, Vector3d::Zero(), {});
    LidarPattern head = spinning_lidar_pattern();
    head.lasers.resize(1);
    head.lasers[0] = {.elevation_rad = 0.0, .vertical_offset_m = 0.0, .time_offset = {}};
    SpinningLidar lidar(exact(), head, plan(), LidarCommand{}, 1, "lidar");
    std::vector<LidarFiring> firings;
    lidar.cast(scene, {kStart, t1, spinning_lidar_still(0, 0, 0), spinning_lidar_still(0, 0, 0)},
               nullptr, firings, nullptr);
    return firings.front().strongest[0];
  };
  EXPECT_NEAR(range_of(0.9, 99.0).range_m, 99.0, 1e-3);
  EXPECT_EQ(range_of(0.9, 101.0).range_m, 0.0F);
  const double limit = 100.0 * std::sqrt(0.1 / 0.9);
  EXPECT_NEAR(range_of(0.1, limit - 0.1).range_m, limit - 0.1, 1e-3);
  EXPECT_EQ(range_of(0.1, limit + 0.1).range_m, 0.0F);
  EXPECT_NEAR(range_of(0.4, 20.0).reflectivity, 0.4, 1e-6);
  EXPECT_EQ(range_of(0.9, 0.6).range_m, 0.0F) << "nearer than the minimum blocks the ray";
}

TEST(SpinningLidar, ReflectivityFallsWithTheIncidenceAsOfARoughSurface) {
  Scene scene;
  scene.add_terrain(flat(0.0), {.reflectance = 0.5, .label = "ground"});
  const SimTime t1 = kStart + milliseconds{1};
  scene.begin_slice(kStart, t1, Vector3d::Zero(), {});
  const LidarPattern head = spinning_lidar_pattern();
  SpinningLidar lidar(exact(), head, plan(), spinning_lidar_turning(), 1, "lidar");
  std::vector<LidarFiring> firings;
  lidar.cast(scene, {kStart, t1, spinning_lidar_still(0, 0, 2), spinning_lidar_still(0, 0, 2)},
             nullptr, firings, nullptr);
  std::size_t echoes = 0;
  for (std::size_t j = 0; j < head.lasers.size(); ++j) {
    if (firings[0].strongest[j].range_m > 0.0F) {
      ++echoes;
      EXPECT_NEAR(firings[0].strongest[j].reflectivity,
                  0.5 * rough_surface(std::sin(-head.lasers[j].elevation_rad)), 1e-4);
    }
  }
  EXPECT_GE(echoes, 20U);
}

TEST(SpinningLidar, ThreadsDoNotChangeAnything) {
  SceneDescription description;
  description.rocks.emplace_back();
  BuiltScene built = build_scene(description, {}, 7);
  std::vector<std::vector<LidarFiring>> results;
  for (const int threads : {1, 2, 5}) {
    SpinningLidarParameters parameters;
    parameters.threads = threads;
    SpinningLidar lidar(parameters, spinning_lidar_pattern(), plan(), spinning_lidar_turning(), 7,
                        "lidar");
    std::vector<LidarFiring> all;
    std::vector<LidarFiring> part;
    for (int ms = 0; ms < 100; ms += 5) {
      const SimTime t0 = kStart + milliseconds{ms};
      const SimTime t1 = t0 + milliseconds{5};
      built.scene->begin_slice(t0, t1, Vector3d::Zero(), {});
      lidar.cast(*built.scene,
                 {t0, t1, spinning_lidar_still(0, 0, 3), spinning_lidar_still(0, 0, 3)}, nullptr,
                 part, nullptr);
      all.insert(all.end(), part.begin(), part.end());
    }
    results.push_back(std::move(all));
  }
  for (const std::size_t other : {1U, 2U}) {
    ASSERT_EQ(results[0].size(), results[other].size());
    for (std::size_t i = 0; i < results[0].size(); ++i) {
      ASSERT_EQ(results[0][i].strongest, results[other][i].strongest) << "firing " << i;
    }
  }
}

TEST(SpinningLidar, RangeNoiseHasItsDeviationAndIsReproducible) {
  Scene scene;
  scene.add_terrain(flat(0.0), spinning_lidar_white());
  SpinningLidarParameters noisy;
  noisy.range_sigma_m = 0.02;
  const LidarPattern head = spinning_lidar_pattern();
  const SimTime t1 = kStart + milliseconds{200};
  scene.begin_slice(kStart, t1, Vector3d::Zero(), {});
  std::vector<LidarFiring> truth;
  std::vector<LidarFiring> measured;
  SpinningLidar(exact(), head, plan(), spinning_lidar_turning(), 3, "a")
      .cast(scene, {kStart, t1, spinning_lidar_still(0, 0, 3), spinning_lidar_still(0, 0, 3)},
            nullptr, truth, nullptr);
  SpinningLidar(noisy, head, plan(), spinning_lidar_turning(), 3, "a")
      .cast(scene, {kStart, t1, spinning_lidar_still(0, 0, 3), spinning_lidar_still(0, 0, 3)},
            nullptr, measured, nullptr);
  double sum = 0.0;
  double squares = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    for (std::size_t j = 0; j < head.lasers.size(); ++j) {
      const float range = truth[i].strongest[j].range_m;
      if (range > 2.0F && range < 90.0F) {
        const double error = measured[i].strongest[j].range_m - range;
        sum += error;
        squares += error * error;
        count += 1.0;
      }
    }
  }
  ASSERT_GT(count, 50000.0);
  EXPECT_NEAR(sum / count, 0.0, 4.0 * 0.02 / std::sqrt(count));
  EXPECT_NEAR(std::sqrt(squares / count), 0.02, 4.0 * 0.02 / std::sqrt(2.0 * count));
}

TEST(CounterNoise, QuantileInvertsTheNormalDistribution) {
  for (const double p : {1e-14, 1e-9, 1e-4, 0.01, 0.07}) {
    const double size = outer_normal_quantile<double>(std::sqrt(-std::log(p)));
    EXPECT_NEAR(0.5 * std::erfc(size / std::numbers::sqrt2) / p, 1.0, p < 1e-11 ? 0.3 : 1e-5) << p;
  }
  for (const double q : {-0.42, -0.2, 0.0, 0.2, 0.42}) {
    const double value = central_normal_quantile<double>(q);
    EXPECT_NEAR(0.5 * std::erfc(-value / std::numbers::sqrt2), 0.5 + q, 1e-7) << q;
  }
}

TEST(CounterNoise, AMillionLanesAreNormal) {
  double sum = 0.0;
  double square = 0.0;
  double fourth = 0.0;
  int beyond_three = 0;
  constexpr int kCount = 1'000'000;
  for (std::uint64_t i = 0; i < kCount; i += kLanes) {
    std::array<std::uint64_t, kLanes> shots{};
    std::iota(shots.begin(), shots.end(), i);
    std::array<float, kLanes> values{};
    gaussian(42, shots, values);
    for (const float value : values) {
      sum += value;
      square += value * value;
      fourth += std::pow(value, 4);
      beyond_three += std::abs(value) > 3.0F ? 1 : 0;
    }
  }
  EXPECT_NEAR(sum / kCount, 0.0, 4e-3);
  EXPECT_NEAR(square / kCount, 1.0, 6e-3);
  EXPECT_NEAR(fourth / kCount, 3.0, 0.05);
  EXPECT_NEAR(beyond_three / 2700.0, 1.0, 0.1);
}

TEST(SpinningLidar, RefusesNonsense) {
  SpinningLidarParameters parameters;
  parameters.threads = 0;
  EXPECT_THROW(
      SpinningLidar(parameters, spinning_lidar_pattern(), plan(), spinning_lidar_turning(), 1, "x"),
      std::invalid_argument);
  parameters = {};
  parameters.range_sigma_m = std::nan("");
  EXPECT_THROW(
      SpinningLidar(parameters, spinning_lidar_pattern(), plan(), spinning_lidar_turning(), 1, "x"),
      std::invalid_argument);
  EXPECT_THROW(SpinningLidar(exact(), LidarPattern{}, plan(), spinning_lidar_turning(), 1, "x"),
               std::invalid_argument);
  EXPECT_THROW(SpinningLidar(exact(), spinning_lidar_pattern(), SamplePlan{},
                             spinning_lidar_turning(), 1, "x"),
               std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
