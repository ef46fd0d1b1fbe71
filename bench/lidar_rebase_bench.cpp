#include "bench/lidar_rebase_bench.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/random.h"
#include "sim/scene/scene.h"

namespace rigwire::bench {
namespace {

using Eigen::Vector3d;

constexpr double kAbove_m = 2.5;
constexpr double kEastSlope = 0.3;
constexpr double kNorthSlope = 0.2;
constexpr double kNearest_m = 1.0;
constexpr double kReach_m = 100.0;
constexpr double kLeak_m = 1.0;
constexpr std::size_t kNodes = 231;
constexpr std::size_t kRays = 40000;
constexpr std::uint64_t kSeed = 1;

double height_m(double x_m, double y_m) {
  return kEastSlope * x_m + kNorthSlope * y_m;
}

/// The plane in world coordinates, as floats.
sim::TriangleMesh baked_plane(const Vector3d& centre_W) {
  sim::TriangleMesh mesh;
  mesh.name = "plane";
  const double half = 0.5 * static_cast<double>(kNodes - 1);
  for (std::size_t r = 0; r < kNodes; ++r) {
    for (std::size_t c = 0; c < kNodes; ++c) {
      const Vector3d node(static_cast<double>(c) - half, static_cast<double>(r) - half, 0.0);
      const Vector3d on_plane(node.x(), node.y(), height_m(node.x(), node.y()));
      mesh.vertices.push_back((centre_W + on_plane).cast<float>());
    }
  }
  for (std::uint32_t r = 0; r + 1 < kNodes; ++r) {
    for (std::uint32_t c = 0; c + 1 < kNodes; ++c) {
      const auto south_west = static_cast<std::uint32_t>(r * kNodes + c);
      const auto north_west = static_cast<std::uint32_t>(south_west + kNodes);
      mesh.triangles.push_back({south_west, south_west + 1, north_west});
      mesh.triangles.push_back({south_west + 1, north_west + 1, north_west});
    }
  }
  return mesh;
}

/// `from_centre` is the rays' start.
RangeErrorSummary errors_of(const sim::Scene& scene, const Vector3d& centre_W,
                            const Vector3d& from_centre, SimTime time) {
  const Vector3d normal = Vector3d(-kEastSlope, -kNorthSlope, 1.0).normalized();
  const Vector3d p_W = centre_W + from_centre;
  sim::RandomStream random(kSeed, "bench/rebase");
  RangeErrorSummary summary;
  std::vector<double> errors_m;
  double squares = 0.0;
  while (summary.rays < kRays) {
    const double azimuth_rad = 2.0 * std::numbers::pi * random.uniform();
    const double elevation_rad = random.uniform(-1.5, 0.5);
    const Vector3d direction_W(std::cos(elevation_rad) * std::cos(azimuth_rad),
                               std::cos(elevation_rad) * std::sin(azimuth_rad),
                               std::sin(elevation_rad));
    const double range_m = -normal.dot(from_centre) / normal.dot(direction_W);
    if (!(range_m > kNearest_m && range_m < kReach_m)) {
      continue;
    }
    const auto hit = scene.cast(p_W, direction_W, 0.1, 1.2 * kReach_m, time);
    ++summary.rays;
    if (!hit || std::abs(hit->range_m - range_m) > kLeak_m) {
      ++summary.leaks;
      continue;
    }
    errors_m.push_back(std::abs(hit->range_m - range_m));
    squares += errors_m.back() * errors_m.back();
  }
  if (!errors_m.empty()) {
    std::ranges::sort(errors_m);
    summary.rms_m = std::sqrt(squares / static_cast<double>(errors_m.size()));
    summary.p99_m = errors_m[errors_m.size() * 99 / 100];
    summary.worst_m = errors_m.back();
  }
  return summary;
}

}  // namespace

std::vector<RebaseError> measure_rebasing(const std::vector<double>& map_offsets_m) {
  constexpr SimTime kEnd = kStart + std::chrono::milliseconds{1};
  std::vector<RebaseError> errors;
  for (const double offset_m : map_offsets_m) {
    const Vector3d centre_W(offset_m * std::numbers::sqrt2 / 2.0 + 0.37,
                            -offset_m * std::numbers::sqrt2 / 2.0 + 0.11, 100.0);
    const Vector3d from_centre(0.21, 0.43, height_m(0.21, 0.43) + kAbove_m);
    RebaseError error;
    error.map_offset_m = offset_m;
    {
      sim::Scene scene;
      Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
      X_WM.translation() = centre_W;
      scene.add_object(scene.add_mesh(baked_plane(Vector3d::Zero())), X_WM, 1.0, {});
      scene.begin_slice(kStart, kEnd, centre_W, {});
      error.rebased = errors_of(scene, centre_W, from_centre, kEnd);
    }
    {
      // The scene is given the map origin as the sensor's place, so its local origin stays there.
      sim::Scene scene;
      scene.add_object(scene.add_mesh(baked_plane(centre_W)), Eigen::Isometry3d::Identity(), 1.0,
                       {});
      scene.begin_slice(kStart, kEnd, Vector3d::Zero(), {});
      error.raw = errors_of(scene, centre_W, from_centre, kEnd);
    }
    errors.push_back(error);
  }
  return errors;
}

}  // namespace rigwire::bench
