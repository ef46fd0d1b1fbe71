// Rays against closed forms in double.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "fields/constants.h"
#include "sim/lidar/spinning_lidar.h"
#include "sim/random.h"

namespace rigwire::sim {
namespace {

using Eigen::Vector3d;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr double kRate = 10.0 * kTurn;
constexpr double kHalfUnit_m = 1e-3;

LidarPattern pattern() {
  LidarPattern result;
  for (int i = 0; i < 32; ++i) {
    result.lasers.push_back({.elevation_rad = (-30.67 + 4.0 / 3.0 * ((i * 7) % 32)) * kDegree,
                             .vertical_offset_m = 0.017 - 0.0007 * ((i * 7) % 32),
                             .time_offset = nanoseconds{1152 * i}});
  }
  result.firing_period = nanoseconds{46'080};
  result.minimum_range_m = 0.5;
  result.maximum_range_m = 100.0;
  return result;
}

LidarCommand turning() {
  LidarCommand command;
  command.rotor_rate_radps = kRate;
  return command;
}

SpinningLidar exact_lidar(const LidarPattern& head) {
  return {{.range_sigma_m = 0.0},
          head,
          {kStart + head.firing_period, head.firing_period},
          turning(),
          1,
          "lidar"};
}

/// A shot in the sensor's frame, by the definition.
struct Shot {
  double time_s = 0.0;
  Vector3d start_S;
  Vector3d direction_S;
};
Shot shot_of(const LidarFiring& firing, const LaserGeometry& laser) {
  const double t = to_seconds(firing.time + laser.time_offset);
  const double a = kRate * t;
  const double w = laser.elevation_rad;
  return {t,
          {0.0, 0.0, laser.vertical_offset_m},
          {std::cos(w) * std::cos(a), -std::cos(w) * std::sin(a), std::sin(w)}};
}

LinkMotion still(const Vector3d& p_W) {
  LinkMotion motion;
  motion.X_WL.translation() = p_W;
  return motion;
}

/// A surface of revolution about z, given by (radius, height) from bottom to top; closed where the
/// radius is 0 at both ends.
TriangleMesh revolve(const std::vector<Eigen::Vector2d>& profile, std::uint32_t segments) {
  TriangleMesh mesh;
  mesh.name = "revolved";
  for (const Eigen::Vector2d& ring : profile) {
    for (std::uint32_t s = 0; s < segments; ++s) {
      const double angle = kTurn * s / segments;
      mesh.vertices.push_back(
          Vector3d(ring.x() * std::cos(angle), ring.x() * std::sin(angle), ring.y()).cast<float>());
    }
  }
  for (std::uint32_t r = 0; r + 1 < profile.size(); ++r) {
    for (std::uint32_t s = 0; s < segments; ++s) {
      const std::uint32_t a = r * segments + s;
      const std::uint32_t b = r * segments + (s + 1) % segments;
      mesh.triangles.push_back({a, b, a + segments});
      mesh.triangles.push_back({b, b + segments, a + segments});
    }
  }
  return mesh;
}

TriangleMesh make_sphere(double radius_m, int rings, std::uint32_t segments) {
  std::vector<Eigen::Vector2d> profile;
  for (int i = 0; i <= rings; ++i) {
    const double angle = std::numbers::pi * i / rings;
    const bool pole = i == 0 || i == rings;
    profile.emplace_back(pole ? 0.0 : radius_m * std::sin(angle), -radius_m * std::cos(angle));
  }
  return revolve(profile, segments);
}

/// Nearest positive root of |p + r d|^2 = radius^2 with d of length `length`, 0 when there is none.
double sphere_range(const Vector3d& p, const Vector3d& d, double radius_m) {
  const double a = d.squaredNorm();
  const double b = p.dot(d);
  const double under = b * b - a * (p.squaredNorm() - radius_m * radius_m);
  return under < 0.0 ? 0.0 : (-b - std::sqrt(under)) / a;
}

/// Worst difference of truth from `range_of` over all shots for which that tells a range.
template <class RangeOf>
double worst_error(Scene& scene, const Vector3d& p_W, const RangeOf& range_of,
                   std::size_t least_compared) {
  const LidarPattern head = pattern();
  SpinningLidar lidar = exact_lidar(head);
  std::vector<LidarFiring> firings;
  std::vector<LidarBankTruth> truth;
  const SimTime t1 = kStart + milliseconds{100};
  scene.begin_slice(kStart, t1, p_W, {});
  lidar.cast(scene, {kStart, t1, still(p_W), still(p_W)}, nullptr, firings, &truth);
  double worst = 0.0;
  std::size_t compared = 0;
  for (std::size_t k = 0; k < firings.size(); ++k) {
    for (std::size_t i = 0; i < head.lasers.size(); ++i) {
      const Shot shot = shot_of(firings[k], head.lasers[i]);
      const double expected = range_of(shot);
      if (expected > 0.0) {
        worst = std::max(worst, std::abs(truth[k][i].range_m - expected));
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, least_compared);
  return worst;
}

TEST(RayGeometry, ASphereIsWithinHalfAUnitWhereverTheMapBegins) {
  constexpr double kRadius_m = 3.0;
  for (const double offset : {0.0, 10e3, 1000e3}) {
    Scene scene;
    const Vector3d centre(offset + 0.3, -offset + 0.7, 1.0);
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.translation() = centre;
    scene.add_object(scene.add_mesh(make_sphere(kRadius_m, 250, 500)), X, 1.0,
                     {.reflectance = 0.9, .label = "sphere"});
    const Vector3d p_W = centre + Vector3d(-5.0, 2.0, 1.0);
    const auto range_of = [&](const Shot& shot) {
      const Vector3d p = p_W - centre + shot.start_S;
      const double range = sphere_range(p, shot.direction_S, kRadius_m);
      // The facets lie 0.12 mm inside at most; at a slant that counts for more.
      const Vector3d normal = (p + range * shot.direction_S) / kRadius_m;
      return -normal.dot(shot.direction_S) > 0.3 ? range : 0.0;
    };
    EXPECT_LT(worst_error(scene, p_W, range_of, 5000), kHalfUnit_m) << offset;
  }
}

TEST(RayGeometry, ACylinderIsWithinHalfAUnit) {
  constexpr double kRadius_m = 0.8;
  Scene scene;
  scene.add_object(scene.add_mesh(revolve({{kRadius_m, -3.0}, {kRadius_m, 9.0}}, 400)),
                   Eigen::Isometry3d::Identity(), 1.0, {.reflectance = 0.9, .label = "mast"});
  const Vector3d p_W(-4.0, 3.0, 2.5);
  const auto range_of = [&](const Shot& shot) {
    Vector3d p = p_W + shot.start_S;
    Vector3d d = shot.direction_S;
    const double z0 = p.z();
    const double dz = d.z();
    p.z() = d.z() = 0.0;
    const double range = sphere_range(p, d, kRadius_m);
    const double z = z0 + range * dz;
    const Vector3d normal = (p + range * d) / kRadius_m;
    return z > -2.9 && z < 8.9 && -normal.dot(d) > 0.3 ? range : 0.0;
  };
  EXPECT_LT(worst_error(scene, p_W, range_of, 1000), kHalfUnit_m);
}

TEST(RayGeometry, GrazingRaysMeetTheGroundAndNoneSlipsThrough) {
  Scene scene;
  HeightField flat;
  flat.cell_m = 1.0;
  flat.columns = flat.rows = 401;
  flat.origin_m = {-200.0, -200.0};
  flat.heights_m.assign(flat.columns * flat.rows, 0.0);
  scene.add_terrain(flat, {.reflectance = 0.9, .label = "ground"});
  LidarPattern head = pattern();
  for (std::size_t i = 0; i < head.lasers.size(); ++i) {
    head.lasers[i].elevation_rad = -(0.12 + 0.02 * static_cast<double>(i)) * kDegree;
    head.lasers[i].vertical_offset_m = 0.0;
  }
  SpinningLidar lidar = exact_lidar(head);
  const SimTime t1 = kStart + milliseconds{100};
  const double height_m = 0.2;
  const LinkMotion mount = still({0.013, 0.027, height_m});
  scene.begin_slice(kStart, t1, Vector3d::Zero(), {});
  std::vector<LidarFiring> firings;
  std::vector<LidarBankTruth> truth;
  lidar.cast(scene, {kStart, t1, mount, mount}, nullptr, firings, &truth);
  for (std::size_t k = 0; k < truth.size(); ++k) {
    for (std::size_t i = 0; i < head.lasers.size(); ++i) {
      const double expected = height_m / std::sin(-head.lasers[i].elevation_rad);
      if (expected < 99.0) {
        // A direction in floats is good for 1e-7 rad, which a slant of height / range stretches.
        const double tolerance = 1e-4 + 2e-7 * expected * expected / height_m;
        ASSERT_NEAR(truth[k][i].range_m, expected, tolerance) << "laser " << i;
      }
    }
  }
}

TEST(RayGeometry, AMillionRaysStayInsideAClosedMesh) {
  Scene scene;
  scene.add_object(scene.add_mesh(make_sphere(20.0, 50, 100)), Eigen::Isometry3d::Identity(), 1.0,
                   {.reflectance = 0.9, .label = "shell"});
  const LidarPattern head = pattern();
  SpinningLidar lidar = exact_lidar(head);
  RandomStream random(5, "leaks");
  std::vector<LidarFiring> firings;
  std::vector<LidarBankTruth> truth;
  std::uint64_t leaks = 0;
  for (SimTime t0 = kStart; lidar.rays() < 1'000'000; t0 += milliseconds{2}) {
    LinkMotion mount =
        still({random.uniform(-8.0, 8.0), random.uniform(-8.0, 8.0), random.uniform(-8.0, 8.0)});
    mount.X_WL.linear() = Eigen::Quaterniond(random.gaussian(), random.gaussian(),
                                             random.gaussian(), random.gaussian())
                              .normalized()
                              .toRotationMatrix();
    scene.begin_slice(t0, t0 + milliseconds{2}, Vector3d::Zero(), {});
    lidar.cast(scene, {t0, t0 + milliseconds{2}, mount, mount}, nullptr, firings, &truth);
    for (const LidarBankTruth& bank : truth) {
      leaks += static_cast<std::uint64_t>(std::ranges::count_if(
          bank, [](const LidarShotTruth& shot) { return shot.range_m == 0.0F; }));
    }
  }
  EXPECT_EQ(leaks, 0U);
}

TEST(RayGeometry, ABoxThatTurnsAndMovesIsMetWhereItIsAtEachShot) {
  Scene scene;
  const auto mesh = scene.add_mesh(make_box("box", {4.0, 4.0, 8.0}));
  const auto body = scene.add_body("box");
  scene.add_body_part(body, mesh, Eigen::Isometry3d::Identity(),
                      {.reflectance = 0.9, .label = "box"});
  const auto pose = [](double t) {
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.translation() << 6.0 + 3.0 * t, -1.0 - 2.0 * t, 0.5 * t;
    X.rotate(Eigen::AngleAxisd(0.4 + 0.8 * t, Vector3d::UnitZ()));
    return X;
  };
  const LidarPattern head = pattern();
  SpinningLidar lidar = exact_lidar(head);
  std::vector<LidarFiring> firings;
  std::vector<LidarBankTruth> truth;
  double worst = 0.0;
  std::size_t compared = 0;
  for (SimTime t0 = kStart; t0 < kStart + milliseconds{200}; t0 += milliseconds{5}) {
    const SimTime t1 = t0 + milliseconds{5};
    const BodyMotion motion{pose(to_seconds(t0)), pose(to_seconds(t1))};
    scene.begin_slice(t0, t1, Vector3d::Zero(), {&motion, 1});
    lidar.cast(scene, {t0, t1, still(Vector3d::Zero()), still(Vector3d::Zero())}, nullptr, firings,
               &truth);
    for (std::size_t k = 0; k < firings.size(); ++k) {
      for (std::size_t i = 0; i < head.lasers.size(); ++i) {
        const Shot shot = shot_of(firings[k], head.lasers[i]);
        if (firings[k].time + head.lasers[i].time_offset > t1 || truth[k][i].range_m == 0.0F) {
          continue;
        }
        // What was hit lies on one of the box's sides, as it stood then.
        const Eigen::Isometry3d X_BW = pose(shot.time_s).inverse();
        const Vector3d p_B = X_BW * shot.start_S;
        const Vector3d d_B = X_BW.linear() * shot.direction_S;
        double expected = 0.0;
        for (int axis = 0; axis < 2; ++axis) {
          if (std::abs(p_B(axis)) > 2.0 && p_B(axis) * d_B(axis) < 0.0) {
            expected = std::max(expected, (std::copysign(2.0, p_B(axis)) - p_B(axis)) / d_B(axis));
          }
        }
        worst = std::max(worst, std::abs(truth[k][i].range_m - expected));
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 10'000U);
  EXPECT_LT(worst, 0.2 * kHalfUnit_m);
}

TEST(RayGeometry, TheTimesOfThePointsUndoTheMotionOfTheSensor) {
  constexpr double kWall_m = 10.0;
  Scene scene;
  const auto mesh = scene.add_mesh(make_box("wall", {400.0, 1.0, 60.0}));
  Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
  X_WM.translation() << 0.0, kWall_m + 0.5, 0.0;
  scene.add_object(mesh, X_WM, 1.0, {.reflectance = 0.9, .label = "wall"});
  const Vector3d velocity(5.0, 0.0, 0.0);
  const double yaw_rate = 60.0 * kDegree;
  const auto mount_at = [&](double t) {
    LinkMotion mount = still(t * velocity);
    mount.X_WL.linear() = Eigen::AngleAxisd(yaw_rate * t, Vector3d::UnitZ()).toRotationMatrix();
    mount.v_WL_W = velocity;
    mount.w_WL_W = {0.0, 0.0, yaw_rate};
    return mount;
  };
  const LidarPattern head = pattern();
  SpinningLidar lidar = exact_lidar(head);
  std::vector<LidarFiring> firings;
  double worst_corrected = 0.0;
  double worst_uncorrected = 0.0;
  double worst_prediction = 0.0;
  for (SimTime t0 = kStart; t0 < kStart + milliseconds{100}; t0 += milliseconds{5}) {
    const SimTime t1 = t0 + milliseconds{5};
    scene.begin_slice(t0, t1, Vector3d::Zero(), {});
    lidar.cast(scene, {t0, t1, mount_at(to_seconds(t0)), mount_at(to_seconds(t1))}, nullptr,
               firings, nullptr);
    for (const LidarFiring& firing : firings) {
      for (std::size_t i = 0; i < head.lasers.size(); ++i) {
        const double range = firing.strongest[i].range_m;
        if (range == 0.0) {
          continue;
        }
        // A client computes the azimuth like this: that of the firing, moved on by its rate.
        const double w = head.lasers[i].elevation_rad;
        const double a = firing.rotor_azimuth_rad +
                         firing.rotor_rate_radps * to_seconds(head.lasers[i].time_offset);
        const Vector3d direction_S(std::cos(w) * std::cos(a), -std::cos(w) * std::sin(a),
                                   std::sin(w));
        const Vector3d start_S(0.0, 0.0, head.lasers[i].vertical_offset_m);
        const Vector3d point_S = start_S + range * direction_S;
        const Eigen::Isometry3d X_WS =
            mount_at(to_seconds(firing.time + head.lasers[i].time_offset)).X_WL;
        worst_corrected = std::max(worst_corrected, std::abs((X_WS * point_S).y() - kWall_m));
        const double uncorrected = point_S.y() - kWall_m;  // all at the start's pose
        const Vector3d d_W = X_WS.linear() * direction_S;
        const double exact = (kWall_m - (X_WS * start_S).y()) / d_W.y();
        const double predicted = (start_S + exact * direction_S).y() - kWall_m;
        worst_uncorrected = std::max(worst_uncorrected, std::abs(uncorrected));
        worst_prediction = std::max(worst_prediction, std::abs(uncorrected - predicted));
      }
    }
  }
  EXPECT_LT(worst_corrected, 2e-3);
  EXPECT_LT(worst_prediction, 2e-3);
  EXPECT_GT(worst_uncorrected, 1.0) << "6 degrees in a revolution";
}

}  // namespace
}  // namespace rigwire::sim
