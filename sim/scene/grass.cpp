#include "sim/scene/grass.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "sim/scene/range_checks.h"

namespace rigwire::sim {
namespace {

constexpr double kPi = std::numbers::pi;
/// A patch lies flat on uneven ground; its stalks begin this much below.
constexpr double kBelowGround_m = 0.05;

/// Axes of a patch that tilts as the ground does over it.
Eigen::Matrix3d tilted_frame(const HeightField& ground, const Eigen::Vector2d& p, double reach_m) {
  // Tilt by central differences of the ground's height.
  const double east =
      ground.height_m(p.x() + reach_m, p.y()) - ground.height_m(p.x() - reach_m, p.y());
  const double north =
      ground.height_m(p.x(), p.y() + reach_m) - ground.height_m(p.x(), p.y() - reach_m);
  Eigen::Matrix3d axes;
  axes.col(0) = Eigen::Vector3d(2.0 * reach_m, 0.0, east).normalized();
  axes.col(2) = Eigen::Vector3d(-east, -north, 2.0 * reach_m).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

bool within_any(std::span<const KeepOut> discs, const Eigen::Vector2d& spot) {
  return std::ranges::any_of(
      discs, [&](const KeepOut& disc) { return (spot - disc.centre_m).norm() < disc.radius_m; });
}

}  // namespace

void validate(const GrassField& grass) {
  require_within(grass.centre_m.norm(), 0.0, 8000.0, "grass.centre_m");
  require_within(grass.half_lengths_m.minCoeff(), 0.1, 4000.0, "grass.half_lengths_m");
  require_within(grass.half_lengths_m.maxCoeff(), 0.1, 4000.0, "grass.half_lengths_m");
  require_within(grass.stalks_per_m2, 0.0, 20000.0, "grass.stalks_per_m2");
  require_within(grass.height_m, 0.01, 10.0, "grass.height_m");
  require_within(grass.diameter_m, 1e-4, 0.5, "grass.diameter_m");
  require_within(grass.lean_rad, 0.0, 1.0, "grass.lean_rad");
  require_within(grass.patch_m, 0.2, 50.0, "grass.patch_m");
  require_within(grass.track_distance_m, 0.0, 1000.0, "grass.track_distance_m");
  require_within(grass.stalks_per_m2 * grass.patch_m * grass.patch_m, 0.0, 200000.0,
                 "grass: stalks of a patch");
  require_within(4.0 * grass.half_lengths_m.prod() / (grass.patch_m * grass.patch_m), 0.0, 500000.0,
                 "grass: patches of the field");
  validate(grass.material);
}

TriangleMesh make_grass_patch(const GrassField& grass, RandomStream& random) {
  TriangleMesh patch;
  patch.name = "grass";
  const auto stalks =
      static_cast<int>(std::lround(grass.stalks_per_m2 * grass.patch_m * grass.patch_m));
  // The mean width of a convex outline is its length over pi (Cauchy); here a triangle's.
  const double corner_m = kPi * grass.diameter_m / (3.0 * std::numbers::sqrt3);
  const double foot_share = 1.0 + kBelowGround_m / grass.height_m;
  for (int i = 0; i < stalks; ++i) {
    const Eigen::Vector3d foot(grass.patch_m * random.uniform(-0.5, 0.5),
                               grass.patch_m * random.uniform(-0.5, 0.5), 0.0);
    const double turn = random.uniform(0.0, 2.0 * kPi);
    const Eigen::Vector3d along =
        Eigen::Vector3d(grass.lean_rad * random.gaussian(), grass.lean_rad * random.gaussian(), 1.0)
            .normalized();
    const auto first = static_cast<std::uint32_t>(patch.vertices.size());
    for (int corner = 0; corner < 3; ++corner) {
      const double angle = turn + 2.0 * kPi * corner / 3.0;
      const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0.0);
      patch.vertices.push_back(
          (foot - kBelowGround_m * along + foot_share * corner_m * out).cast<float>());
    }
    patch.vertices.push_back((foot + grass.height_m * along).cast<float>());
    for (std::uint32_t corner = 0; corner < 3; ++corner) {
      patch.triangles.push_back({first + corner, first + (corner + 1) % 3, first + 3});
    }
  }
  return patch;
}

void add_grass(const GrassField& grass, const HeightField& ground, std::span<const ClearWay> ways,
               std::span<const KeepOut> keep_out, std::uint64_t seed, Scene& scene) {
  validate(grass);
  constexpr std::size_t kPatches = 4;
  RandomStream random(seed + grass.seed, "scene/grass");
  if (std::lround(grass.stalks_per_m2 * grass.patch_m * grass.patch_m) == 0) {
    return;
  }
  std::vector<Scene::MeshId> patches;
  for (std::size_t i = 0; i < kPatches; ++i) {
    patches.push_back(scene.add_mesh(make_grass_patch(grass, random)));
  }
  const auto count = [&](double half_length_m) {
    return std::max(1L, std::lround(2.0 * half_length_m / grass.patch_m));
  };
  const long columns = count(grass.half_lengths_m.x());
  const long rows = count(grass.half_lengths_m.y());
  std::size_t number = 0;
  for (long row = 0; row < rows; ++row) {
    for (long column = 0; column < columns; ++column) {
      const std::uint64_t bits = random.bits();
      const Eigen::Vector2d spot =
          grass.centre_m +
          grass.patch_m *
              Eigen::Vector2d(static_cast<double>(column) - 0.5 * static_cast<double>(columns - 1),
                              static_cast<double>(row) - 0.5 * static_cast<double>(rows - 1));
      const bool on_way = std::ranges::any_of(ways, [&](const ClearWay& way) {
        return way.line->nearest(spot).distance_m < way.half_width_m + grass.track_distance_m;
      });
      if (on_way || within_any(grass.keep_out, spot) || within_any(keep_out, spot)) {
        continue;
      }
      Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
      const double quarter = 0.5 * kPi * static_cast<double>((bits >> 8U) % 4U);
      X_WM.linear() = tilted_frame(ground, spot, 0.5 * grass.patch_m) *
                      Eigen::AngleAxisd(quarter, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      X_WM.translation() << spot, ground.height_m(spot.x(), spot.y());
      scene.add_object(patches[bits % kPatches], X_WM, 1.0, grass.material,
                       "grass " + std::to_string(number++));
    }
  }
}

}  // namespace rigwire::sim
