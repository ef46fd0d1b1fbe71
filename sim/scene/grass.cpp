#include "sim/scene/grass.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "fields/check.h"
#include "fields/visitor.h"
#include "sim/scene/range_checks.h"

namespace rigwire::sim {

using fields::in;
using fields::IntegerRule;

namespace {

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

void visit(fields::Visitor& v, GrassField& p) {
  v.vector2("centre", p.centre_m, in("m").between(-8000, 8000), "[east, north] of the rectangle.");
  v.vector2("half_lengths", p.half_lengths_m, in("m").between(0.1, 4000),
            "[east, north] from the centre to the rectangle's edges.");
  v.integer("seed", p.seed, IntegerRule{0}, "Other grass at the same place.");
  v.number("stalks_per_m2", p.stalks_per_m2, in("1/m2").between(0, 20'000),
           "Stalks per area of the ground.");
  v.number("height", p.height_m, in("m").between(0.01, 10), "Height of the stalks.");
  v.number("diameter", p.diameter_m, in("mm").between(0.1, 500),
           "Diameter of a stalk at its foot; 0 at the tip.");
  v.number("lean", p.lean_rad, in("deg").between(0, 60), "Standard deviation of the stalks' lean.");
  v.number("patch", p.patch_m, in("m").between(0.2, 50),
           "Edge of the patches that are laid side by side.");
  v.number("track_distance", p.track_distance_m, in("m").between(0, 1000),
           "Least distance from a track's edge to a patch's middle.");
  v.list("keep_out", p.keep_out, "Discs without grass.");
  v.section("material", p.material, "Surface of the stalks.");
}

void validate(const GrassField& grass) {
  fields::check(grass);
  require_within(grass.stalks_per_m2 * grass.patch_m * grass.patch_m, 0.0, 200'000.0, "", "patch",
                 "stalks of a patch");
  require_within(4.0 * grass.half_lengths_m.prod() / (grass.patch_m * grass.patch_m), 0.0,
                 500'000.0, "", "patch", "patches of the field");
}

TriangleMesh make_grass_patch(const GrassField& grass, RandomStream& random) {
  TriangleMesh patch;
  patch.name = "grass";
  const auto stalks =
      static_cast<int>(std::lround(grass.stalks_per_m2 * grass.patch_m * grass.patch_m));
  // The mean width of a convex outline is its length over pi (Cauchy); here a triangle's.
  const double corner_m = std::numbers::pi * grass.diameter_m / (3.0 * std::numbers::sqrt3);
  const double foot_share = 1.0 + kBelowGround_m / grass.height_m;
  for (int i = 0; i < stalks; ++i) {
    const Eigen::Vector3d foot(grass.patch_m * random.uniform(-0.5, 0.5),
                               grass.patch_m * random.uniform(-0.5, 0.5), 0.0);
    const double turn = random.uniform(0.0, 2.0 * std::numbers::pi);
    const Eigen::Vector3d along =
        Eigen::Vector3d(grass.lean_rad * random.gaussian(), grass.lean_rad * random.gaussian(), 1.0)
            .normalized();
    const auto first = static_cast<std::uint32_t>(patch.vertices.size());
    for (int corner = 0; corner < 3; ++corner) {
      const double angle = turn + 2.0 * std::numbers::pi * corner / 3.0;
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
      const double quarter = 0.5 * std::numbers::pi * static_cast<double>((bits >> 8U) % 4U);
      X_WM.linear() = tilted_frame(ground, spot, 0.5 * grass.patch_m) *
                      Eigen::AngleAxisd(quarter, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      X_WM.translation() << spot, ground.height_m(spot.x(), spot.y());
      scene.add_object(patches[bits % kPatches], X_WM, 1.0, grass.material,
                       "grass " + std::to_string(number++));
    }
  }
}

}  // namespace rigwire::sim
