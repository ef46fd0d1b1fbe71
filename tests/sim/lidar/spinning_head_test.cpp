#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "fields/constants.h"
#include "rough_surface.h"
#include "sim/lidar/spinning_lidar.h"

namespace rigwire::sim {
namespace {

using Eigen::Vector3d;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr double kSpinningHeadRate = 10.0 * kTurn;
constexpr double kSpinningHeadHalfUnit_m = 1e-3;

LidarPattern head(std::size_t lasers, nanoseconds period) {
  LidarPattern result;
  result.firing_period = period;
  result.minimum_range_m = 0.5;
  result.maximum_range_m = 100.0;
  for (std::size_t i = 0; i < lasers; ++i) {
    // Scattered over the head as in the real ones: neighbours in number are none in space.
    const double place = static_cast<double>((i * 37) % lasers) / static_cast<double>(lasers);
    result.lasers.push_back(
        {.elevation_rad = (-25.0 + 40.0 * place) * kDegree,
         .vertical_offset_m = 0.02 * (0.5 - place),
         .time_offset = period * static_cast<int>(i) / static_cast<int>(lasers + 8)});
  }
  return result;
}

/// Heads as those of the models: one bank or several, with and without offsets.
struct Head {
  std::string name;
  LidarPattern pattern;
};
std::vector<Head> heads() {
  // 13: packets with lanes left over.
  std::vector<Head> all{{"16 lasers", head(16, nanoseconds{55'296})},
                        {"32 lasers", head(32, nanoseconds{46'080})},
                        {"32 lasers in a zigzag", head(32, nanoseconds{55'296})},
                        {"64 lasers beside the axis", head(64, nanoseconds{48'000})},
                        {"128 lasers", head(128, nanoseconds{53'300})}};
  for (std::size_t i = 0; i < 32; ++i) {
    constexpr std::array kZigzag{-4.2, -1.4, 1.4, 4.2};
    all[2].pattern.lasers[i].azimuth_offset_rad = kZigzag[i % 4] * kDegree;
  }
  for (std::size_t i = 0; i < 64; ++i) {
    LaserGeometry& laser = all[3].pattern.lasers[i];
    laser.azimuth_offset_rad = (i % 2 == 0 ? 5.0 : -4.0) * kDegree;
    laser.horizontal_offset_m = i % 2 == 0 ? 0.026 : -0.026;
    laser.vertical_offset_m = 0.2 + 0.001 * static_cast<double>(i % 8);
  }
  for (std::size_t i = 0; i < 128; ++i) {
    all[4].pattern.lasers[i].azimuth_offset_rad =
        (static_cast<double>(i % 8) - 3.5) * 1.8 * kDegree;
  }
  all.push_back({"13 lasers", head(13, nanoseconds{50'000})});
  return all;
}

SamplePlan plan_of(const LidarPattern& pattern) {
  return {kStart + pattern.firing_period, pattern.firing_period};
}

LidarCommand spinning_head_turning() {
  LidarCommand command;
  command.rotor_rate_radps = kSpinningHeadRate;
  return command;
}

Material white() {
  return {.reflectance = 0.9, .label = "white"};
}

LinkMotion still(double x, double y, double z) {
  LinkMotion motion;
  motion.X_WL.translation() << x, y, z;
  return motion;
}

/// A room of four walls, floor and ceiling around the origin.
struct Room {
  Vector3d half{9.0, 7.0, 4.0};
  Scene scene;
  Room() {
    const auto wall = [&](const Vector3d& size, const Vector3d& centre) {
      Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
      X.translation() = centre;
      scene.add_object(scene.add_mesh(make_box("wall", size)), X, 1.0, white());
    };
    for (const double side : {-1.0, 1.0}) {
      wall({1.0, 40.0, 40.0}, {side * (half.x() + 0.5), 0.0, 0.0});
      wall({40.0, 1.0, 40.0}, {0.0, side * (half.y() + 0.5), 0.0});
      wall({40.0, 40.0, 1.0}, {0.0, 0.0, side * (half.z() + 0.5)});
    }
  }
  [[nodiscard]] double range(const Vector3d& p, const Vector3d& d) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      if (d(axis) != 0.0) {
        nearest = std::min(nearest, (std::copysign(half(axis), d(axis)) - p(axis)) / d(axis));
      }
    }
    return nearest;
  }
};

TEST(SpinningHead, EveryLaserOfEveryHeadLeavesWhereAndWhenItsGeometrySays) {
  Room room;
  const SimTime t1 = kStart + milliseconds{20};
  room.scene.begin_slice(kStart, t1, Vector3d::Zero(), {});
  for (const Head& of : heads()) {
    const LidarPattern& pattern = of.pattern;
    SpinningLidar lidar({.range_sigma_m = 0.0}, pattern, plan_of(pattern), spinning_head_turning(),
                        1, "lidar");
    std::vector<LidarFiring> firings;
    std::vector<LidarBankTruth> truth;
    const LinkMotion mount = still(0.4, -0.3, 0.2);
    lidar.cast(room.scene, {kStart, t1, mount, mount}, nullptr, firings, &truth);
    const auto expected_firings =
        static_cast<std::size_t>((t1 - kStart) / pattern.firing_period) * pattern.banks();
    ASSERT_EQ(firings.size(), expected_firings) << of.name;
    ASSERT_EQ(truth.size(), expected_firings) << of.name;
    EXPECT_EQ(lidar.rays(), expected_firings / pattern.banks() * pattern.lasers.size());
    double worst = 0.0;
    for (std::size_t k = 0; k < firings.size(); ++k) {
      const LidarFiring& firing = firings[k];
      ASSERT_EQ(firing.first_laser, k % pattern.banks() * kBankLasers) << of.name;
      ASSERT_EQ(firing.time,
                kStart + pattern.firing_period * static_cast<int>(k / pattern.banks() + 1));
      for (std::size_t i = 0; i < kBankLasers; ++i) {
        const std::size_t number = firing.first_laser + i;
        if (number >= pattern.lasers.size()) {
          ASSERT_EQ(firing.strongest[i], LidarReturn{}) << of.name;
          ASSERT_EQ(truth[k][i].range_m, 0.0F) << of.name;
          continue;
        }
        const LaserGeometry& laser = pattern.lasers[number];
        const double w = laser.elevation_rad;
        const double b = kSpinningHeadRate * to_seconds(firing.time + laser.time_offset) +
                         laser.azimuth_offset_rad;
        const Vector3d d(std::cos(w) * std::cos(b), -std::cos(w) * std::sin(b), std::sin(w));
        const Vector3d p =
            mount.X_WL.translation() + Vector3d(-laser.horizontal_offset_m * std::sin(b),
                                                -laser.horizontal_offset_m * std::cos(b),
                                                laser.vertical_offset_m);
        const double expected = room.range(p, d);
        worst = std::max(worst, std::abs(firing.strongest[i].range_m - expected));
        ASSERT_EQ(truth[k][i].range_m, firing.strongest[i].range_m) << of.name;
        ASSERT_LT(truth[k][i].instance, 6U) << of.name;
        ASSERT_NEAR(firing.strongest[i].reflectivity,
                    0.9 * rough_surface(truth[k][i].cosine_of_incidence), 1e-5);
      }
    }
    EXPECT_LT(worst, 0.1 * kSpinningHeadHalfUnit_m) << of.name;
  }
}

TEST(SpinningHead, TruthTellsWhatTheReceiverDoesNot) {
  Scene scene;
  const auto mesh = scene.add_mesh(make_box("wall", {1.0, 60.0, 60.0}));
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() << 30.5, 0.0, 0.0;
  scene.add_object(mesh, X, 1.0, {.reflectance = 0.01, .label = "soot"});
  const SimTime t1 = kStart + milliseconds{1};
  scene.begin_slice(kStart, t1, Vector3d::Zero(), {});
  LidarPattern pattern = head(1, nanoseconds{46'080});
  pattern.lasers[0] = {};
  SpinningLidar lidar({}, pattern, plan_of(pattern), LidarCommand{}, 1, "lidar");
  std::vector<LidarFiring> firings;
  std::vector<LidarBankTruth> truth;
  lidar.cast(scene, {kStart, t1, still(0, 0, 0), still(0, 0, 0)}, nullptr, firings, &truth);
  EXPECT_EQ(firings[0].strongest[0], LidarReturn{}) << "too faint to be seen";
  EXPECT_NEAR(truth[0][0].range_m, 30.0, 1e-4);
  EXPECT_EQ(truth[0][0].instance, 0U);
  EXPECT_NEAR(truth[0][0].cosine_of_incidence, 1.0, 1e-6);
}

TEST(SpinningHead, FiresWithinTheViewOnlyAndStillReportsEachFiring) {
  Room room;
  const SimTime t1 = kStart + milliseconds{100};
  room.scene.begin_slice(kStart, t1, Vector3d::Zero(), {});
  for (const Head& of : heads()) {
    LidarCommand command = spinning_head_turning();
    command.view_start_rad = 300.07 * kDegree;  // through 0
    command.view_end_rad = 45.03 * kDegree;
    SpinningLidar lidar({.range_sigma_m = 0.0}, of.pattern, plan_of(of.pattern), command, 1,
                        "lidar");
    std::vector<LidarFiring> firings(5000);
    for (LidarFiring& stale : firings) {
      stale.several = true;
      stale.strongest.fill({7.0F, 1.0F});
      stale.last = stale.second = stale.strongest;
    }
    lidar.cast(room.scene, {kStart, t1, still(0, 0, 0), still(0, 0, 0)}, nullptr, firings, nullptr);
    ASSERT_EQ(firings.size() / of.pattern.banks(),
              static_cast<std::size_t>((t1 - kStart) / of.pattern.firing_period));
    std::size_t seen = 0;
    for (const LidarFiring& firing : firings) {
      const double azimuth = firing.rotor_azimuth_rad / kDegree;
      const bool inside = azimuth >= 300.07 || azimuth < 45.03;
      const std::size_t used = std::min(kBankLasers, of.pattern.lasers.size() - firing.first_laser);
      for (std::size_t i = 0; i < used; ++i) {
        ASSERT_EQ(firing.strongest[i].range_m > 0.0F, inside) << of.name << " at " << azimuth;
      }
      seen += inside ? used : 0;
      ASSERT_FALSE(firing.several);
      ASSERT_EQ(firing.last, BankReturns{});
      ASSERT_EQ(firing.second, BankReturns{});
    }
    EXPECT_EQ(lidar.rays(), seen) << of.name << ": nothing is cast outside";
  }
}

TEST(SpinningHead, WithTheLaserOffFiringsAreThereAndEmpty) {
  Room room;
  const SimTime t1 = kStart + milliseconds{10};
  const SimTime t2 = kStart + milliseconds{20};
  const LidarPattern pattern = head(32, nanoseconds{46'080});
  SpinningLidar lidar({}, pattern, plan_of(pattern), spinning_head_turning(), 1, "lidar");
  std::vector<LidarFiring> firings;
  room.scene.begin_slice(kStart, t1, Vector3d::Zero(), {});
  lidar.cast(room.scene, {kStart, t1, still(0, 0, 0), still(0, 0, 0)}, nullptr, firings, nullptr);
  const std::uint64_t rays = lidar.rays();
  LidarCommand command = spinning_head_turning();
  command.laser_on = false;
  lidar.command(t1, command);
  room.scene.begin_slice(t1, t2, Vector3d::Zero(), {});
  lidar.cast(room.scene, {t1, t2, still(0, 0, 0), still(0, 0, 0)}, nullptr, firings, nullptr);
  ASSERT_EQ(firings.size(), 217U);
  for (const LidarFiring& firing : firings) {
    ASSERT_EQ(firing.strongest, BankReturns{});
    EXPECT_EQ(firing.rotor_rate_radps, kSpinningHeadRate) << "the motor turns on";
  }
  EXPECT_EQ(lidar.rays(), rays);
}

TEST(SpinningHead, AStandingRotorLooksAtOnePlace) {
  Room room;
  const LidarPattern pattern = head(16, nanoseconds{55'296});
  SpinningLidar lidar({.range_sigma_m = 0.0}, pattern, plan_of(pattern), LidarCommand{}, 1,
                      "lidar");
  const SimTime t1 = kStart + milliseconds{5};
  room.scene.begin_slice(kStart, t1, Vector3d::Zero(), {});
  std::vector<LidarFiring> firings;
  lidar.cast(room.scene, {kStart, t1, still(0, 0, 0), still(0, 0, 0)}, nullptr, firings, nullptr);
  for (const LidarFiring& firing : firings) {
    ASSERT_EQ(firing.rotor_azimuth_rad, 0.0);
    ASSERT_EQ(firing.rotor_rate_radps, 0.0);
    for (std::size_t i = 0; i < 16; ++i) {
      ASSERT_NEAR(firing.strongest[i].range_m, firings.front().strongest[i].range_m, 1e-6);
    }
  }
}

TEST(SpinningHead, AzimuthWrapsWithoutAStepInWhatIsSeen) {
  Room room;
  const LidarPattern pattern = head(32, nanoseconds{46'080});
  SpinningLidar lidar({.range_sigma_m = 0.0}, pattern, plan_of(pattern), spinning_head_turning(), 1,
                      "lidar");
  const SimTime t0 = kStart + milliseconds{90};
  const SimTime t1 = kStart + milliseconds{110};
  room.scene.begin_slice(t0, t1, Vector3d::Zero(), {});
  std::vector<LidarFiring> firings;
  lidar.cast(room.scene, {t0, t1, still(0, 0, 0), still(0, 0, 0)}, nullptr, firings, nullptr);
  int wraps = 0;
  for (std::size_t k = 1; k < firings.size(); ++k) {
    const double step = firings[k].rotor_azimuth_rad - firings[k - 1].rotor_azimuth_rad;
    EXPECT_NEAR(std::remainder(step, kTurn), kSpinningHeadRate * 46.08e-6, 1e-12);
    if (step < 0.0) {
      ++wraps;
      for (std::size_t i = 0; i < kBankLasers; ++i) {
        EXPECT_NEAR(firings[k].strongest[i].range_m, firings[k - 1].strongest[i].range_m, 2e-3);
      }
    }
  }
  EXPECT_EQ(wraps, 1);
}

TEST(SpinningHead, RefusesHeadsAndCommandsThatMakeNoSense) {
  LidarPattern pattern = head(128, nanoseconds{53'300});
  LidarCommand command = spinning_head_turning();
  command.view_start_rad = std::nan("");
  EXPECT_THROW(SpinningLidar({}, pattern, plan_of(pattern), command, 1, "x"),
               std::invalid_argument);
  SpinningLidar lidar({}, pattern, plan_of(pattern), spinning_head_turning(), 1, "x");
  EXPECT_THROW(lidar.command(kStart, command), std::invalid_argument);
  pattern.lasers.push_back(pattern.lasers.front());
  EXPECT_THROW(SpinningLidar({}, pattern, plan_of(pattern), spinning_head_turning(), 1, "x"),
               std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
