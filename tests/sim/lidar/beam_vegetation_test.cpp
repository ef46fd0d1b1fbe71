// Upright stalks, thrown at random: the share of beams that comes through falls off exponentially
// (Poisson), and sub-rays decide by which width.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "beam_head.h"
#include "sim/random.h"

namespace rigwire::sim {
namespace {

using namespace beam_test;

constexpr double kInner_m = 2.0;   // no stalks nearer: beams of one scene share none
constexpr double kOuter_m = 20.0;  // nor farther
constexpr double kWall_m = 26.0;
constexpr double kDensity_pm2 = 0.8;
constexpr double kRadius_m = 0.015;
constexpr int kSides = 12;
constexpr int kScenes = 16;
constexpr int kShots = 300;  // per scene, all round

TriangleMesh stalk() {
  TriangleMesh mesh;
  mesh.name = "stalk";
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kSides;
    for (const double z : {-2.0, 2.0}) {
      mesh.vertices.emplace_back(static_cast<float>(kRadius_m * std::cos(angle)),
                                 static_cast<float>(kRadius_m * std::sin(angle)),
                                 static_cast<float>(z));
    }
    const auto a = static_cast<std::uint32_t>(2 * i);
    const auto b = static_cast<std::uint32_t>(2 * ((i + 1) % kSides));
    mesh.triangles.push_back({a, b, b + 1});
    mesh.triangles.push_back({a, b + 1, a + 1});
  }
  return mesh;
}

/// Mean width of a stalk over all directions: a convex body's is its perimeter over pi (Cauchy).
double mean_width_m() {
  return kSides * 2.0 * kRadius_m * std::sin(std::numbers::pi / kSides) / std::numbers::pi;
}

/// A round field of stalks before four white walls.
void plant(Scene& scene, std::uint64_t seed) {
  RandomStream random(seed, "stalks");
  const auto mesh = scene.add_mesh(stalk());
  // A Poisson number of stalks, by exponential steps of area from the inner ring outwards.
  double area_m2 = std::numbers::pi * kInner_m * kInner_m;
  while (true) {
    area_m2 -= std::log(1.0 - random.uniform()) / kDensity_pm2;
    const double radius_m = std::sqrt(area_m2 / std::numbers::pi);
    if (radius_m > kOuter_m) {
      break;
    }
    const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
    scene.add_object(mesh, at(radius_m * std::cos(angle), radius_m * std::sin(angle), 0.0), 1.0,
                     paint(0.3));
  }
  const auto wall = scene.add_mesh(make_box("wall", {0.01, 60.0, 20.0}));
  for (int i = 0; i < 4; ++i) {
    const double yaw = 0.5 * std::numbers::pi * i;
    scene.add_object(wall, at(kWall_m * std::cos(yaw), kWall_m * std::sin(yaw), 0.0, yaw), 1.0,
                     paint(1.0));
  }
}

struct Penetration {
  double untouched = 0.0;  ///< Share of the beams that met no stalk at all.
  double energy = 0.0;     ///< Mean share of a beam that came through.
  double energy_sigma = 0.0;
  double shots = 0.0;
};

Penetration shoot_through(int sub_rays) {
  SpinningLidarParameters parameters = exact(sub_rays);
  parameters.compensates_incidence = true;  // the wall returns the share that reached it
  Penetration result;
  double squares = 0.0;
  for (int i = 0; i < kScenes; ++i) {
    Scene scene;
    plant(scene, static_cast<std::uint64_t>(i));
    const double rate_radps = 2.0 * std::numbers::pi / (kShots * to_seconds(kFiringPeriod));
    Shooter shooter(parameters, head(), rate_radps);
    for (const LidarFiring& firing : shooter.shoot(scene, kShots)) {
      const bool reached = firing.last[0].range_m > kOuter_m + 1.0;
      const bool untouched = reached && firing.second[0].range_m == 0.0F;
      const double share = reached ? static_cast<double>(firing.last[0].reflectivity) : 0.0;
      result.untouched += untouched ? 1.0 : 0.0;
      result.energy += share;
      squares += share * share;
      result.shots += 1.0;
    }
  }
  result.untouched /= result.shots;
  result.energy /= result.shots;
  result.energy_sigma =
      std::sqrt((squares / result.shots - result.energy * result.energy) / result.shots);
  return result;
}

/// Angle between the outermost sub-rays, seen from above. Between them none is farther from its
/// neighbour than a stalk is wide, as far as the stalks go.
double fan_rad(const LaserBeam& beam, int sub_rays) {
  double least = 0.0;
  double most = 0.0;
  for (const SubRay& ray : sample_beam(beam, sub_rays)) {
    least = std::min(least, ray.right_rad);
    most = std::max(most, ray.right_rad);
  }
  return most - least;
}

class StalksBySubRays : public testing::TestWithParam<int> {};

// A stalk is met by any of the sub-rays when its axis is within half a stalk of the strip between
// the outermost ones. That strip widens by the fan angle per metre, so that
//   P(untouched) = exp(-n integral (d + fan r) dr) from the inner to the outer ring.
// Each sub-ray alone is a line: the mean energy that comes through is exp(-n d L).
TEST_P(StalksBySubRays, PenetrationIsExponential) {
  const int sub_rays = GetParam();
  const Penetration found = shoot_through(sub_rays);
  const double fan = fan_rad(head().beam, sub_rays);
  const double depth_m = kOuter_m - kInner_m;
  const double swept_m2 =
      mean_width_m() * depth_m + 0.5 * fan * (kOuter_m * kOuter_m - kInner_m * kInner_m);
  const double untouched = std::exp(-kDensity_pm2 * swept_m2);
  const double sigma = std::sqrt(untouched * (1.0 - untouched) / found.shots);
  EXPECT_NEAR(found.untouched, untouched, 3.0 * sigma);
  const double energy = std::exp(-kDensity_pm2 * mean_width_m() * depth_m);
  EXPECT_NEAR(found.energy, energy, 3.0 * found.energy_sigma);
}

INSTANTIATE_TEST_SUITE_P(Beams, StalksBySubRays, testing::Values(1, 5, 19),
                         [](const auto& test) { return "sub_rays_" + std::to_string(test.param); });

}  // namespace
}  // namespace rigwire::sim
