#include "bench/lidar_geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "bench/lidar_plan.h"
#include "hil/executive/cpu_time.h"
#include "sim/lidar/spinning_lidar.h"
#include "sim/random.h"

namespace rigwire::bench {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kSphere_m = 20.0;

/// An icosahedron whose triangles are cut in four `times` over, on a sphere.
sim::TriangleMesh make_sphere(double radius_m, int times) {
  std::vector<Vector3d> corners;
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  for (const double a : {-1.0, 1.0}) {
    for (const double b : {-g, g}) {
      corners.emplace_back(0.0, a, b);
      corners.emplace_back(a, b, 0.0);
      corners.emplace_back(b, 0.0, a);
    }
  }
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const auto count = static_cast<std::uint32_t>(corners.size());
  for (std::uint32_t i = 0; i < count; ++i) {
    for (std::uint32_t j = i + 1; j < count; ++j) {
      for (std::uint32_t k = j + 1; k < count; ++k) {
        const auto edge = [&](std::uint32_t p, std::uint32_t q) {
          return (corners[p] - corners[q]).norm() < 2.1;
        };
        if (edge(i, j) && edge(j, k) && edge(k, i)) {
          triangles.push_back({i, j, k});
        }
      }
    }
  }
  for (int time = 0; time < times; ++time) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t p, std::uint32_t q) {
      const auto [place, is_new] =
          middles.try_emplace(std::minmax(p, q), static_cast<std::uint32_t>(corners.size()));
      if (is_new) {
        corners.push_back((corners[p].normalized() + corners[q].normalized()) / 2.0);
      }
      return place->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [p, q, r] : triangles) {
      const std::uint32_t a = middle(p, q);
      const std::uint32_t b = middle(q, r);
      const std::uint32_t c = middle(r, p);
      finer.insert(finer.end(), {{p, a, c}, {a, q, b}, {c, b, r}, {a, b, c}});
    }
    triangles = std::move(finer);
  }
  sim::TriangleMesh mesh;
  mesh.name = "sphere";
  mesh.triangles = std::move(triangles);
  for (const Vector3d& corner : corners) {
    const Eigen::Vector3f vertex = (radius_m * corner.normalized()).cast<float>();
    mesh.vertices.push_back({vertex.x(), vertex.y(), vertex.z()});
  }
  return mesh;
}

constexpr double kBoom_m = 8.0;
constexpr double kSwing_radps = 1.0;
constexpr double kHalfWidth_m = 0.8;
constexpr double kHalfHeight_m = 1.5;

Isometry3d boom_at(double t) {
  Isometry3d X = Isometry3d::Identity();
  X.rotate(Eigen::AngleAxisd(kSwing_radps * t, Vector3d::UnitZ()));
  return X;
}

/// Where a ray from `p` along `d` at time `t` hits the plate's near side, and how far inside its
/// rim (negative: outside).
struct PlateHit {
  double range_m = 0.0;
  double inside_m = -1.0;
};
PlateHit plate_hit(const Vector3d& p, const Vector3d& d, double t) {
  const Isometry3d X_BW = boom_at(t).inverse();
  const Vector3d p_B = X_BW * p;
  const Vector3d d_B = X_BW.linear() * d;
  if (d_B.x() <= 1e-3) {
    return {};
  }
  const double range = (kBoom_m - p_B.x()) / d_B.x();
  const Vector3d at = p_B + range * d_B;
  return {range, std::min(kHalfWidth_m - std::abs(at.y()), kHalfHeight_m - std::abs(at.z()))};
}

RebuildInterval measure(int slice_ms, bool blended) {
  constexpr double kRim_m = 0.02;
  constexpr Duration kTime = std::chrono::seconds{1};
  const FiringPlan plan = firing_plan({});
  sim::Scene scene;
  const auto plate =
      scene.add_mesh(sim::make_box("plate", {0.2, 2.0 * kHalfWidth_m, 2.0 * kHalfHeight_m}));
  const auto boom = scene.add_body("boom");
  Isometry3d X_BM = Isometry3d::Identity();
  X_BM.translation() << kBoom_m + 0.1, 0.0, 0.0;
  scene.add_body_part(boom, plate, X_BM, {.reflectance = 0.9, .label = "plate"});
  sim::SpinningLidar lidar({.range_sigma_m = 0.0}, plan.pattern, plan.plan, plan.command, 1,
                           "bench");
  sim::LinkMotion mount;
  mount.X_WL.translation() << 1.0, 0.5, 0.0;

  RebuildInterval result{.slice_ms = slice_ms, .blended = blended};
  const Duration slice = std::chrono::milliseconds{slice_ms};
  std::vector<LidarFiring> firings;
  std::vector<sim::LidarBankTruth> truth;
  double squares = 0.0;
  std::size_t slices = 0;
  for (SimTime t0 = kStart; t0 < kStart + kTime; t0 += slice, ++slices) {
    const SimTime t1 = t0 + slice;
    const Isometry3d middle = boom_at(to_seconds(t0 + slice / 2));
    const sim::BodyMotion motion{blended ? boom_at(to_seconds(t0)) : middle,
                                 blended ? boom_at(to_seconds(t1)) : middle};
    const double before_s = hil::thread_cpu_seconds();
    scene.begin_slice(t0, t1, Vector3d::Zero(), {&motion, 1});
    result.begin_slice_s += hil::thread_cpu_seconds() - before_s;
    lidar.cast(scene, {.t0 = t0, .t1 = t1, .mount_at_t0 = mount, .mount_at_t1 = mount}, nullptr,
               firings, &truth);
    for (std::size_t i = 0; i < firings.size(); ++i) {
      for (std::size_t j = 0; j < plan.pattern.lasers.size(); ++j) {
        const LaserGeometry& laser = plan.pattern.lasers[j];
        const SimTime shot = firings[i].time + laser.time_offset;
        if (shot > t1) {
          continue;  // sees the bodies where they are at the slice's end
        }
        const double azimuth = plan.command.rotor_rate_radps * to_seconds(shot);
        const Vector3d d(std::cos(laser.elevation_rad) * std::cos(azimuth),
                         -std::cos(laser.elevation_rad) * std::sin(azimuth),
                         std::sin(laser.elevation_rad));
        const PlateHit expected =
            plate_hit(mount.X_WL.translation() + laser.vertical_offset_m * Vector3d::UnitZ(), d,
                      to_seconds(shot));
        const double found = truth[i][j].range_m;
        if (expected.inside_m < kRim_m) {
          result.missed +=
              expected.inside_m < -kRim_m && found > 0.0 && std::abs(found - expected.range_m) < 0.1
                  ? 1U
                  : 0U;
          continue;
        }
        ++result.rays;
        if (found == 0.0) {
          ++result.missed;
          continue;
        }
        squares += (found - expected.range_m) * (found - expected.range_m);
        result.worst_m = std::max(result.worst_m, std::abs(found - expected.range_m));
      }
    }
  }
  result.rms_m = std::sqrt(squares / static_cast<double>(std::max<std::size_t>(result.rays, 1)));
  result.core_share = result.begin_slice_s / to_seconds(kTime);
  result.begin_slice_s /= static_cast<double>(slices);
  return result;
}

}  // namespace

/// Casts rays from random poses inside a closed sphere: each must hit, at most a radius and the 15
/// m of the poses away.
LidarLeaks count_lidar_leaks(std::uint64_t rays) {
  const FiringPlan plan = firing_plan({});
  sim::Scene scene;
  scene.add_object(scene.add_mesh(make_sphere(kSphere_m, 5)), Isometry3d::Identity(), 1.0,
                   {.reflectance = 0.9, .label = "sphere"});
  sim::SpinningLidar lidar({.range_sigma_m = 0.0}, plan.pattern, plan.plan, plan.command, 1,
                           "bench");
  sim::RandomStream random(1, "bench/leaks");
  std::vector<LidarFiring> firings;
  std::vector<sim::LidarBankTruth> truth;
  LidarLeaks result;
  const Duration slice = std::chrono::milliseconds{2};
  for (SimTime t0 = kStart; result.rays < rays; t0 += slice) {
    sim::LinkMotion mount;
    mount.X_WL.linear() = Eigen::Quaterniond(random.gaussian(), random.gaussian(),
                                             random.gaussian(), random.gaussian())
                              .normalized()
                              .toRotationMatrix();
    do {
      for (double& coordinate : mount.X_WL.translation()) {
        coordinate = random.uniform(-15.0, 15.0);
      }
    } while (mount.X_WL.translation().norm() > 15.0);
    scene.begin_slice(t0, t0 + slice, Vector3d::Zero(), {});
    lidar.cast(scene, {.t0 = t0, .t1 = t0 + slice, .mount_at_t0 = mount, .mount_at_t1 = mount},
               nullptr, firings, &truth);
    for (const sim::LidarBankTruth& bank : truth) {
      for (std::size_t j = 0; j < plan.pattern.lasers.size(); ++j) {
        result.leaks += bank[j].range_m == 0.0F ? 1U : 0U;
        result.strayed += bank[j].range_m > kSphere_m + 15.0 ? 1U : 0U;
      }
    }
    result.rays = lidar.rays();
  }
  return result;
}

std::vector<RebuildInterval> measure_rebuild_intervals(const std::vector<int>& slices_ms) {
  std::vector<RebuildInterval> results;
  for (const int slice_ms : slices_ms) {
    if (slice_ms < 1) {
      throw std::invalid_argument("rebuild interval: slices must be 1 ms at least");
    }
    for (const bool blended : {true, false}) {
      results.push_back(measure(slice_ms, blended));
    }
  }
  return results;
}

}  // namespace rigwire::bench
